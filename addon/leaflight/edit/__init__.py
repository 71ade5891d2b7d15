# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that change what is shown: isosurfaces, looks, labels, isovalues, animations."""
