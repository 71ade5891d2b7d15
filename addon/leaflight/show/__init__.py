# SPDX-License-Identifier: GPL-3.0-or-later
"""Showing isosurfaces: meshes, materials, isovalues, and the properties behind them."""
