# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaflight: bakes the light on every isosurface of a volume at once; the isovalue is then free."""

from . import (
    bake,
    bake_flatland,
    cornell_box,
    flat_properties,
    handlers,
    import_image,
    import_volume,
    leaf_look,
    panels,
    photon_cloud,
    properties,
    render_comparison,
)

bl_info = {
    "name": "Leaflight",
    "author": "The Leaflight authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, and 3D Viewport > Sidebar > Leaflight",
    "description": "Global illumination for every isosurface of a volume, baked once",
    "category": "Render",
}

# In the order of registration: the properties are what all others draw and edit.
_MODULES = (
    properties,
    flat_properties,
    import_volume,
    import_image,
    leaf_look,
    cornell_box,
    bake,
    bake_flatland,
    photon_cloud,
    render_comparison,
    panels,
    handlers,
)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
