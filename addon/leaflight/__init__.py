# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaflight: bakes the light on every isosurface of a volume at once; the isovalue is then free."""

import importlib
from types import ModuleType

from . import registration

# Installed a moment ago, the folder of the package is new to Python.
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
    """Why the package cannot do the add-on's work here, or None.

    Raises ImportError if Blender for Windows removed the package at its start, as it does after an
    extension was disabled and enabled again. It installs the packages of one that fails anew.
    """
    try:
        import leaflight
    except ImportError as refusal:
        return str(refusal)
    if getattr(leaflight, "__file__", None) is None:
        sentence = "Blender removed the package leaflight; restart Blender to install it."
        raise ImportError(sentence, name=__name__)
    own = ".".join(map(str, bl_info["version"]))
    if leaflight.__version__ != own:
        return (
            f"This add-on is of Leaflight {own}, but the package leaflight "
            f"{leaflight.__version__} is loaded from {leaflight.__path__[0]}; restart Blender, "
            "or remove that package."
        )
    return None


_sentence = _refusal()
_MODULES: tuple[ModuleType, ...]
if _sentence is not None:
    from . import refused

    refused.sentence = _sentence
    _MODULES = (refused,)
else:
    from . import translations
    from .bake import (
        bake,
        bake_flatland,
        bake_frames,
        continue_bake,
        estimate_bake,
        live,
        load_bake,
        photon_cloud,
        resume_bake,
        stopped,
        unused_bakes,
    )
    from .compare import render_comparison
    from .export import export_bake
    from .importing import import_image, import_volume
    from .operators import background, failures
    from .show import flat_properties, look_properties, properties
    from .stage import hidden, open_example, orientation, stage, stage_settings
    from .store import preferences
    from .ui import (
        add_isosurface,
        advanced_panel,
        animation,
        bake_panel,
        clip_outline,
        clip_panel,
        comparison_panel,
        data_panel,
        data_picture,
        flatland_panel,
        handlers,
        header,
        isosurface_look,
        label_panel,
        look_panel,
        pick_isovalue,
        slice_panel,
        smooth_volume,
        stage_panel,
        volume_panel,
    )

    # Of the sidebar, from top to bottom.
    PANELS = (
        volume_panel,
        data_panel,
        flatland_panel,
        stage_panel,
        bake_panel,
        advanced_panel,
        look_panel,
        clip_panel,
        slice_panel,
        animation,
        label_panel,
        comparison_panel,
    )
    # In the order of registration: the properties are what all others draw and edit.
    _MODULES = (
        translations,
        preferences,
        properties,
        look_properties,
        flat_properties,
        failures,
        background,
        import_volume,
        import_image,
        isosurface_look,
        add_isosurface,
        orientation,
        stage_settings,
        hidden,
        stage,
        open_example,
        bake,
        bake_frames,
        stopped,
        live,
        continue_bake,
        resume_bake,
        estimate_bake,
        bake_flatland,
        load_bake,
        unused_bakes,
        photon_cloud,
        render_comparison,
        export_bake,
        pick_isovalue,
        smooth_volume,
        data_picture,
        *PANELS,
        clip_outline,
        header,
        handlers,
    )


def register():
    registration.register(_MODULES)


def unregister():
    registration.unregister(_MODULES)
