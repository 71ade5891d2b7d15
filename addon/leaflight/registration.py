# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of the add-on's modules with Blender.

A module lists its CLASSES, its PROPERTIES as (Blender type, name, property), and its MENUS as (name
of a menu, function that draws an entry). Its register() and unregister(), if any, do the rest.
"""

import bpy


def register(modules):
    """Registers the modules in order. A module follows those whose properties it uses."""
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
