# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of the add-on's modules with Blender.

The classes of Blender that a module defines are registered. A module lists its PROPERTIES as
(Blender type, name, property), and its MENUS as (name of a menu, function that draws an entry). Its
register() and unregister(), if any, do the rest.
"""

import bpy


def register(modules):
    """Registers the modules in order. A module follows those whose properties it uses."""
    for module in modules:
        for cls in _classes(module):
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
        for cls in reversed(_classes(module)):
            bpy.utils.unregister_class(cls)


def _classes(module):
    """Returns the classes of Blender that a module defines, in the order of their definition."""
    types = [each for each in vars(module).values() if isinstance(each, type)]
    own = [cls for cls in types if cls.__module__ == module.__name__]
    return [cls for cls in own if issubclass(cls, bpy.types.bpy_struct)]
