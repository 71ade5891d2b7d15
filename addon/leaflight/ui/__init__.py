# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, lists, and what follows Blender's events."""
