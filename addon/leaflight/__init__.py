# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaflight: the add-on that bakes the light on every isosurface of a volume at once."""

import importlib

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


# Panels of the sidebar, from top to bottom.
_PANELS = ("ui.volume_panel", "ui.stage_panel", "ui.bake_panel", "ui.look_panel")
# Modules in the order of registration. Properties come before the modules that use them.
_NAMES = (
    *("translations", "icons", "store.preferences"),
    *("show.label_list", "show.properties", "show.look_properties"),
    *("stage.orientation", "stage.presets"),
    *("operators.failures", "operators.background"),
    *("importing.import_volume", "importing.open_example", "importing.read_again"),
    *("importing.regions", "stage.hidden", "stage.stage"),
    *("bake.bake", "bake.stopped", "bake.live", "bake.continue_bake", "bake.estimate_bake"),
    *("bake.load_bake", "bake.photon_cloud", "compare.render_comparison", "export.export_bake"),
    *("edit.add_isosurface", "edit.looks", "edit.labels", "edit.label_operators"),
    *("edit.animation", "edit.pick_isovalue", "edit.data_picture"),
    *_PANELS,
    *("ui.clip_outline", "ui.handlers"),
)


def _imported(names):
    return [importlib.import_module(f".{name}", __package__) for name in names]


_sentence = _refusal()
_MODULES = _imported(_NAMES if _sentence is None else ("refused",))
if _sentence is None:
    PANELS = _imported(_PANELS)
else:
    _MODULES[0].sentence = _sentence


def register():
    registration.register(_MODULES)


def unregister():
    registration.unregister(_MODULES)
