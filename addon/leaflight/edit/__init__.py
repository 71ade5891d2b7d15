# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that change the display: isosurfaces, looks, labels, isovalues, animations."""
