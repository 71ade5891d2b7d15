# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages for macOS: compiled on Debian by Zig's Clang, linked by LLVM's linker."""
