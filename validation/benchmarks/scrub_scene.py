# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background --python scrub_scene.py -- SETTINGS.json: blender_scrub.py says what for.

Imports the add-on from its source, beside the package from the folder that the settings name.
"""

import importlib.util
import json
import statistics
import sys
import time
from pathlib import Path

import bpy

settings = json.loads(Path(sys.argv[-1]).read_text())
sys.path.insert(0, settings["modules"])

# The share of the isovalue by which it changes from one picture to the next.
STEP = 1e-3


def addon():
    place = Path(settings["addon"])
    spec = importlib.util.spec_from_file_location(
        "leaflight_addon", place / "__init__.py", submodule_search_locations=[str(place)]
    )
    module = sys.modules["leaflight_addon"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.register()


def scrubbed(obj):
    """Returns (milliseconds, triangles), medians of the steps of a slider."""
    found = []
    # The first two show whatever was there before, and how large the surface is.
    for step in range(settings["repetitions"] + 2):
        obj.leaflight["isovalue"] = settings["isovalue"] * (1 + STEP * step)
        obj.update_tag()
        start = time.perf_counter()
        bpy.context.view_layer.update()
        found.append((1e3 * (time.perf_counter() - start), len(obj.data.polygons)))
    milliseconds, triangles = zip(*found[2:])
    return statistics.median(milliseconds), int(statistics.median(triangles))


def main():
    addon()
    from leaflight_addon.show import whole_detail

    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.leaflight.load_bake(filepath=settings["bake"])
    (obj,) = [obj for obj in bpy.data.objects if obj.leaflight.is_volume]
    whole, triangles = scrubbed(obj)
    # As in a window, which this Blender does not have.
    whole_detail.may_follow = lambda *_: True
    moving, moving_triangles = scrubbed(obj)
    answer = {
        "isovalue": settings["isovalue"],
        "triangles": triangles,
        "whole_ms": whole,
        "moving_ms": moving,
        "moving_triangles": moving_triangles,
        "blender": bpy.app.version_string,
    }
    Path(settings["answer"]).write_text(json.dumps(answer))


main()
