# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives Blender what modules have for it, and takes it back.

A module names its CLASSES; its PROPERTIES, each (type of Blender, name, property); its MENUS, each
(name of a menu, function that draws an entry). register() and unregister() do the rest, if any.
"""

import bpy


def register(modules):
    """In the order of the modules: what others draw and edit comes first."""
    for module in modules:
        for cls in getattr(module, "CLASSES", ()):
            bpy.utils.register_class(cls)
        for owner, name, prop in getattr(module, "PROPERTIES", ()):
            setattr(owner, name, prop)
        for menu, draw in getattr(module, "MENUS", ()):
            getattr(bpy.types, menu).append(draw)
        if hasattr(module, "register"):
            module.register()


def unregister(modules):
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
        for menu, draw in getattr(module, "MENUS", ()):
            getattr(bpy.types, menu).remove(draw)
        for owner, name, _ in getattr(module, "PROPERTIES", ()):
            delattr(owner, name)
        for cls in reversed(getattr(module, "CLASSES", ())):
            bpy.utils.unregister_class(cls)
