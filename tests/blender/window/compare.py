# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python compare.py -- FOLDER: makes a comparison by its dialog.

Prints a line WINDOW and a JSON object.
"""

import sys
import time
from pathlib import Path

import bpy
import hand
import leaflight
import stepwise
from leaflight import blender
from leaflight_addon.compare import render_comparison
from leaflight_addon.operators import jobs

FOLDER = Path(sys.argv[-1])

found = {}
# Times at which the viewport was drawn, and all status texts of the comparison.
drawn, statuses = [], []


def main():
    render_comparison.ComparisonJob._status = property(
        lambda self: statuses[-1], lambda self, text: statuses.append(text)
    )
    bpy.types.SpaceView3D.draw_handler_add(
        lambda: drawn.append(time.perf_counter()), (), "WINDOW", "POST_PIXEL"
    )
    hand.clear_scene()
    raw = FOLDER / "bumps.raw"
    leaflight._core.bump_box(24).astype("<f4").tofile(raw)
    obj = blender.import_volume(raw, dims=(24, 24, 24), value_type="float32")
    blender.stage(obj)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 256
    settings = obj.leaflight
    settings.error, settings.resolution = 20.0, 24
    blender.bake(obj, (40, 60), bake_folder=str(FOLDER / "bakes"))
    blender.show(obj, 47.0)
    bpy.context.view_layer.objects.active = obj
    stepwise.run(compare(obj), found)


def compare(obj):
    images = FOLDER / "images"
    yield from viewport_rests()
    with hand.in_view():
        bpy.ops.leaflight.render_comparison(
            "INVOKE_DEFAULT", samples=64, baked_samples=96, share=50.0, folder=str(images)
        )
    yield from viewport_rests()
    yield from hand.key("RET")
    asked = time.perf_counter()
    yield from stepwise.until(lambda: jobs.running() is not None)
    start, last, gaps = time.perf_counter(), None, []
    while jobs.running() is not None:
        now = time.perf_counter()
        gaps += [] if last is None else [now - last]
        last = now
        # The user moves the isovalue during the comparison.
        blender.show(obj, 45.0 + len(gaps) % 5)
        yield 0.05
    yield 0.5
    found["compare"] = {
        "begun": start - asked,
        "gap": max(gaps),
        "seconds": time.perf_counter() - start,
        "statuses": list(statuses),
        "sentence": obj.leaflight.comparison,
        "files": sorted(path.name for path in images.iterdir()),
    }


def viewport_rests():
    """Waits until the viewport is drawn; its shaders take seconds."""
    drawn.clear()
    hand.view().tag_redraw()
    yield from stepwise.until(lambda: drawn and time.perf_counter() > drawn[-1] + 2.0)


main()
