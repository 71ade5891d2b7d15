# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's scene, built and read: walls, lights, materials, and exported to the bake."""
