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
import gate
import hand
import heartbeat
import pressing
import rows
import scenes
import sidebar
import stepwise
from leaflight_addon.operators import jobs


FOLDER, WANTED = Path(sys.argv[-2]), json.loads(sys.argv[-1])


def main():
    hand.draw_quickly()
    space = hand.view().spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    names = [cls.bl_idname for cls in bpy.types.Operator.__subclasses__()]
    print(
        "OPERATORS", json.dumps(sorted(n for n in names if n.startswith("leaflight."))), flush=True
    )
    sidebar.show_all_panels()
    gate.install()
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
