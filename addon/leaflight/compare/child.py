# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background FILE --addons ADDON --python child.py -- JSON: renders a comparison.

Blender runs it as a script outside the package. It prints messages for render_comparison.py.
"""

import json
import sys
from importlib import import_module

import bpy


def main():
    request = json.loads(sys.argv[-1])
    # The name of the package differs between an extension and an add-on.
    addon = sys.argv[sys.argv.index("--addons") + 1]
    comparison = import_module(f"{addon}.compare.render_comparison")

    def send(message):
        print(comparison.MARK + json.dumps(message), flush=True)

    def report(done, part, name):
        send({"done": done, "part": part, "name": name})

    bpy.context.window.scene = bpy.data.scenes[request["scene"]]
    isosurface = next(o for o in bpy.context.scene.objects if o.name_full == request["object"])
    bpy.context.view_layer.objects.active = isosurface
    bpy.context.view_layer.update()
    try:
        figures = comparison.rendered(bpy.context, isosurface, *request["arguments"], report)
    except comparison.LeaflightError as error:
        send({"error": str(error)})
    else:
        send(figures)


if __name__ == "__main__":
    main()
