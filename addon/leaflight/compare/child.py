# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background FILE --addons ADDON --python child.py -- JSON: renders a comparison.

Runs outside the package, as Blender runs scripts; prints what process.py reads.
"""

import json
import sys
from importlib import import_module

import bpy


def main():
    asked = json.loads(sys.argv[-1])
    # By another name in an extension than in an add-on.
    addon = sys.argv[sys.argv.index("--addons") + 1]
    process = import_module(f"{addon}.compare.process")
    operator = import_module(f"{addon}.compare.render_comparison")

    def say(told):
        print(process.MARK + json.dumps(told), flush=True)

    def tell(done, part, name):
        say({"done": done, "part": part, "name": name})

    bpy.context.window.scene = bpy.data.scenes[asked["scene"]]
    isosurface = next(o for o in bpy.context.scene.objects if o.name_full == asked["object"])
    bpy.context.view_layer.objects.active = isosurface
    bpy.context.view_layer.update()
    try:
        figures = operator.rendered(
            bpy.context,
            isosurface,
            asked["folder"],
            asked["samples"],
            asked["baked_samples"],
            asked["share"],
            tell,
        )
    except operator.LeaflightError as error:
        say({"error": str(error)})
    else:
        say(figures)


if __name__ == "__main__":
    main()
