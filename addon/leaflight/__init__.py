# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaflight: the add-on that bakes the light on every isosurface of a volume at once."""

import importlib
from types import ModuleType

from . import registration

# Make Python find the package if it was installed a moment ago.
importlib.invalidate_caches()

bl_info = {
    "name": "Leaflight",
    "author": "The Leaflight authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import, and 3D Viewport > Sidebar > Leaflight",
    "description": "Global illumination for every isosurface of a volume, baked once",
    "category": "Render",
}


def _refusal():
    """Returns why the package cannot do the add-on's work here, or None.

    Raises ImportError if Blender for Windows removed the package at its start. Blender does so
    after an extension was disabled and enabled again. After a failure it installs the packages.
    """
    try:
        import leaflight
    except ImportError as refusal:
        return str(refusal)
    if getattr(leaflight, "__file__", None) is None:
        sentence = "Blender removed the package leaflight; restart Blender to install it."
        raise ImportError(sentence, name=__name__)
    version = ".".join(map(str, bl_info["version"]))
    if leaflight.__version__ != version:
        return (
            f"This add-on has version {version}, but version {leaflight.__version__} of the "
            f"package leaflight is loaded from {leaflight.__path__[0]}; restart Blender, or remove "
            "that package."
        )
    return None


_sentence = _refusal()
_MODULES: tuple[ModuleType, ...]
if _sentence is not None:
    from . import refused

    refused.sentence = _sentence
    _MODULES = (refused,)
else:
    from . import icons, translations
    from .bake import bake, continue_bake, estimate_bake, live, load_bake, photon_cloud, stopped
    from .compare import render_comparison
    from .edit import add_isosurface, animation, data_picture, label_operators, labels, looks
    from .edit import pick_isovalue
    from .export import export_bake
    from .importing import import_volume, open_example, regions, smooth_volume
    from .operators import background, failures
    from .show import look_properties, properties
    from .stage import hidden, orientation, presets, stage
    from .store import preferences
    from .ui import bake_panel, clip_outline, handlers, label_panel, look_panel, stage_panel
    from .ui import volume_panel

    # Panels of the sidebar, from top to bottom.
    PANELS = (volume_panel, stage_panel, bake_panel, look_panel)
    # Modules in the order of registration. Properties come before the modules that use them.
    _MODULES = (
        translations,
        icons,
        preferences,
        properties,
        look_properties,
        orientation,
        presets,
        failures,
        background,
        import_volume,
        open_example,
        smooth_volume,
        regions,
        hidden,
        stage,
        bake,
        stopped,
        live,
        continue_bake,
        estimate_bake,
        load_bake,
        photon_cloud,
        render_comparison,
        export_bake,
        add_isosurface,
        looks,
        labels,
        label_operators,
        label_panel,
        animation,
        pick_isovalue,
        data_picture,
        *PANELS,
        clip_outline,
        handlers,
    )


def register():
    registration.register(_MODULES)


def unregister():
    registration.unregister(_MODULES)
