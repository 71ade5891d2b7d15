# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaflight: bakes the light on every isosurface of a volume at once; the isovalue is then free."""

import importlib

# Installed a moment ago, the folder of the package is new to Python.
importlib.invalidate_caches()

from .bake import bake, bake_flatland, load_bake, photon_cloud, unused_bakes  # noqa: E402
from .compare import render_comparison  # noqa: E402
from .importing import import_image, import_volume  # noqa: E402
from .show import flat_properties, properties  # noqa: E402
from .stage import cornell_box  # noqa: E402
from .ui import handlers, leaf_look, panels  # noqa: E402

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
    load_bake,
    unused_bakes,
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
