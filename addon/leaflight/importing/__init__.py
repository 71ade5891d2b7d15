# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators that import volumes and images."""
