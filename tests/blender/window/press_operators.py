# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python press_operators.py -- FOLDER JSON: presses operators as
a user does; JSON is a list of [number of the row in rows.py, way].

Prints a line ROW before each, and after it a line PRESSED and a JSON object with failures and the
longest freeze of the window. Exits with 3 after a failed row, so that it cannot affect the next.
First prints OPERATORS, a list of all operators of the add-on.
"""

import json
import os
import sys
from pathlib import Path

import bpy
from leaflight_addon.operators import jobs
from leaflight_addon.stage import viewport

sys.path.insert(0, os.path.dirname(__file__))
import gate  # noqa: E402
import hand  # noqa: E402
import heartbeat  # noqa: E402
import pressing  # noqa: E402
import rows  # noqa: E402
import scenes  # noqa: E402
import sidebar  # noqa: E402
import stepwise  # noqa: E402

FOLDER, WANTED = Path(sys.argv[-2]), json.loads(sys.argv[-1])


def main():
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.view.ui_scale = 1.0
    preferences.view.use_save_prompt = False
    # Switch this off, because it takes most of the time without a graphics card.
    preferences.system.viewport_aa = "OFF"
    space = hand.view().spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    # 5.2 crashes when a script presses the button of a browser in a separate window.
    preferences.view.filebrowser_display_type = "SCREEN"
    names = [cls.bl_idname for cls in bpy.types.Operator.__subclasses__()]
    print(
        "OPERATORS", json.dumps(sorted(n for n in names if n.startswith("leaflight."))), flush=True
    )
    sidebar.show_all_panels()
    gate.install()
    # Without a graphics card each first picture of materials takes many seconds.
    viewport._show_materials = lambda _shading: None
    stepwise.run(drive(), {})


def drive():
    yield from stepwise.wait(1.0)
    if not (yield from sidebar.is_drawn()):
        raise RuntimeError("The sidebar has no tab of Leaflight.")
    beat, made = heartbeat.Heartbeat(), scenes.Scenes(FOLDER)
    for number, way in WANTED:
        row = rows.ROWS[number]
        print("ROW", number, way, flush=True)
        press = pressing.Pressing(row, made, beat)
        yield from press.run(way)
        result = {
            "failures": press.failures,
            "seconds": beat.seconds,
            "where": beat.where,
            "row": number,
            "way": way,
        }
        print("PRESSED", json.dumps(result), flush=True)
        if press.failures:
            jobs.cancel_running()
            os._exit(3)


main()
