# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts of the data by clip boxes, which follow their boxes.

A cut stores the place and size of its box in the world ("place"). If the box differs from them, it
has moved, and the data are cut again. A volume that moves takes its cut along.
"""

import json

import bpy
import numpy as np
from leaflight.volume.regions import Box, record_of

from ..bake import live, stopped
from ..operators import jobs
from ..show import isovalues, look
from ..stage import staleness
from ..store import cache, source_files

# Relative rounding of the place of a box.
_ROUNDING = 1e-6


def region_by(obj, box, keep, cut):
    """Returns the region of a volume object that a box cuts now.

    keep: "INSIDE" or "OUTSIDE". cut: "capped" or "open".
    """
    to_file = np.linalg.inv(source_files.place_of_file(obj))
    low, high = np.array(look.bounds_of(box))
    in_file = to_file @ np.array(box.matrix_world, np.float64)
    region = record_of(Box.between(low, high, keep.lower(), cut).moved(in_file))
    return {**region, "object": box.name, "place": _place(box), "on": True}


def _place(box):
    """Returns the matrix and the corners of a box as numbers."""
    matrix = [x for row in box.matrix_world for x in row]
    return [*matrix, *(x for corner in look.bounds_of(box) for x in corner)]


def follow(scene):
    """Cuts data again whose boxes have moved.

    Does nothing during other work, or while the last cut is made: handlers call it at their ends.
    """
    if jobs.running() is not None or stopped.offered() is not None:
        return
    for obj in isovalues.volumes(scene):
        if obj.library is None and obj.override_library is None and obj.leaflight.source:
            _follow(obj)


def boxes(scene):
    """Returns the objects whose boxes cut data of a scene."""
    items = (i for obj in isovalues.volumes(scene) for i in source_files.regions_of(obj.leaflight))
    names = {item["object"] for item in items if item["on"] and source_files.is_box_cut(item)}
    return {bpy.data.objects.get((name, None)) for name in names}


def _follow(obj):
    settings = obj.leaflight
    items = source_files.regions_of(settings)
    now = [_present(obj, _renamed(obj, item)) for item in items]
    if now != items and cache.progress_of(obj) is None:
        settings.regions = json.dumps(now)
        isovalues.limit_all(obj)
        staleness.forget()
        live.changed(bpy.context.scene)


def _renamed(obj, item):
    """Returns a region with the present name of its clip box, which the user may have renamed."""
    box = obj.leaflight_look.box
    is_gone = "place" in item and bpy.data.objects.get((item["object"], None)) is None
    if is_gone and box is not None and box.users_scene and _stands(box, item):
        return {**item, "object": box.name}
    return item


def _stands(box, item):
    """True if a box has the place and size at which it last cut the data."""
    return np.allclose(_place(box), item["place"], rtol=_ROUNDING, atol=_ROUNDING)


def _present(obj, item):
    """Returns a region as it is now: that of a moved box, or itself."""
    if not (item["on"] and source_files.is_box_cut(item) and "place" in item):
        return item
    box, shown = bpy.data.objects.get((item["object"], None)), obj.leaflight_look
    if box is None or not box.users_scene or not look.is_in_data(obj, box):
        return item
    keep = shown.keep if shown.box == box else item["keep"].upper()
    if _stands(box, item) and keep.lower() == item["keep"]:
        return item
    return region_by(obj, box, keep, item["cut"])
