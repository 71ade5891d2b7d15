# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures that panels and menus draw as icons, in one collection."""

import bpy.utils.previews

_pictures = None


def pictures():
    """Returns the collection of pictures, by name, while the add-on is registered."""
    return _pictures


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()


def unregister():
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None
