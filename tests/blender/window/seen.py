# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that a user sees: an operator changes them, Esc does not, and undo restores them.

SEEN has a function for each; the folder is that of the open .blend.
"""

import json

import bpy
import numpy as np
from leaflight_addon.bake import estimate_bake, live, stopped
from leaflight_addon.operators import jobs
from leaflight_addon.show import display, surface_object
from leaflight_addon.stage import hidden
from leaflight_addon.store import frame_bakes, source_files


def volumes():
    return [obj for obj in bpy.context.scene.objects if obj.leaflight.is_volume]


def volume():
    return volumes()[0]


def displays(kind):
    return sorted(obj.name for obj in bpy.context.scene.objects if display.is_display(obj, kind))


def at_rest():
    """True if Live has nothing to do."""
    return live.at_work() is None and not live._has_changed


def surface():
    """Returns the state of the first volume's mesh: its isosurface, its light and what moved."""
    return json.loads(surface_object.label_of(volume().data))


def cut_is_shown():
    """True if the mesh shows the cut of the present place of the box."""
    (region,) = source_files.regions_of(volume().leaflight)
    place = [x for row in volume().leaflight_look.box.matrix_world for x in row]
    is_cut = np.allclose(region["place"][:16], place, atol=1e-5)
    return is_cut and volume().leaflight.regions in surface()["isosurface"]


def folder():
    return _folder[0]


def set_folder(path):
    _folder[:] = [path]


_folder = [None]


def _labels():
    return [displays(kind) for kind in ("scale bar", "letter", "orientation cube", "color bar")]


def _look():
    settings = volume().leaflight
    return [*settings.isosurface_albedo, volume().leaflight_look.gloss]


def _keyframes():
    moved = (obj for obj in bpy.context.scene.objects if obj.animation_data is not None)
    return sorted(obj.name for obj in moved if obj.animation_data.action is not None)


def _box():
    box = volume().leaflight_look.box
    return box is not None and box.name in bpy.context.scene.objects


def _stage():
    marked = (c for c in bpy.context.scene.collection.children if "leaflight_stage" in c)
    return sorted(collection.name for collection in marked)


def _numbers(matrix):
    return [round(x, 4) for row in matrix for x in row]


SEEN = {
    "volumes": lambda: [obj.name for obj in volumes()],
    # Bake that lights each volume's isosurface; empty without light.
    "lit": lambda: [
        obj.leaflight.bake_id if "radiance" in obj.data.attributes else "" for obj in volumes()
    ],
    "bake path": lambda: bpy.path.abspath(volume().leaflight.bake_path),
    "baked frames": lambda: frame_bakes.count_baked(volume().leaflight),
    "stage": _stage,
    "camera": lambda: _numbers(bpy.context.scene.camera.matrix_world),
    "hidden": lambda: [obj.name for obj in hidden.all_hidden(bpy.context.scene)],
    "stands": lambda: _numbers(volume().matrix_world),
    "at work": lambda: jobs.running() is not None,
    "waits": lambda: stopped.offered() is not None,
    "live": lambda: live.at_work() is not None,
    "estimate": lambda: estimate_bake.estimate_of(volume()) is not None,
    "files of bakes": lambda: sorted(path.name for path in folder().glob("leaflight/*.vdb")),
    "photons": lambda: displays("photons"),
    "comparison": lambda: volume().leaflight.comparison,
    "exported": lambda: sorted(path.name for path in folder().glob("*.[gh]*")),
    "clipboard": lambda: bpy.context.window_manager.clipboard,
    "isovalue": lambda: round(volume().leaflight.isovalue, 3),
    "smoothing": lambda: volume().leaflight.smooth,
    "regions": lambda: volume().leaflight.regions,
    "hidden labels": lambda: [obj.leaflight.hide for obj in volumes()],
    "names of labels": lambda: [label.name for obj in volumes() for label in obj.leaflight.labels],
    "look": _look,
    "stops": lambda: len(volume().leaflight.isosurface_stops),
    "isosurfaces": lambda: [obj.name for obj in display.added_to(volume())],
    "clip box": _box,
    "keyframes": _keyframes,
    "labels": _labels,
}
