# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, lists, and handlers of Blender's events."""
