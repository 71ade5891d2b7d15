# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as plain data: isosurfaces, walls and lamps."""
