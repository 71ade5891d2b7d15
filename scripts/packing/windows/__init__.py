# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages for Windows x64, built on Debian by its GCC for Windows (MinGW-w64)."""
