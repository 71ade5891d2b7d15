# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures changes of the isovalue of a bake inside Blender, for scrub.py. Argument: JSON."""

import json
import statistics
import sys
import time
from pathlib import Path

import bpy
from leaflight_addon.show import whole_detail

WORK = json.loads(sys.argv[-1])
# Relative change of the isovalue from one picture to the next.
STEP = 1e-3


def scrubbed(obj, isovalue):
    """Returns (triangles, milliseconds), medians over the steps of a slider."""
    found = []
    # Skip the first two steps, which still depend on the previous mesh.
    for step in range(WORK["repetitions"] + 2):
        obj.leaflight["isovalue"] = isovalue * (1 + STEP * step)
        obj.update_tag()
        start = time.perf_counter()
        bpy.context.view_layer.update()
        found.append((len(obj.data.polygons), 1e3 * (time.perf_counter() - start)))
    triangles, milliseconds = zip(*found[2:])
    return int(statistics.median(triangles)), statistics.median(milliseconds)


def main():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    bpy.ops.leaflight.load_bake(filepath=WORK["bake"])
    (obj,) = [obj for obj in bpy.data.objects if obj.leaflight.is_volume]
    may_follow = whole_detail.may_follow
    rows = []
    for isovalue in WORK["isovalues"]:
        whole_detail.may_follow = may_follow
        triangles, milliseconds = scrubbed(obj, isovalue)
        # Simulate a window.
        whole_detail.may_follow = lambda *_: True
        moving, moving_milliseconds = scrubbed(obj, isovalue)
        rows.append(
            {
                "isovalue": f"{isovalue:g}",
                "triangles": f"{triangles:,}",
                "ms": f"{milliseconds:.0f}",
                "triangles while it moves": f"{moving:,}",
                "ms while it moves": f"{moving_milliseconds:.0f}",
            }
        )
    Path(WORK["rows"]).write_text(json.dumps(rows))


main()
