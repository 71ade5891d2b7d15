# SPDX-License-Identifier: GPL-3.0-or-later
"""A program like Blender's, made of the Python module bpy of PyPI, which has no program.

It supports the arguments that background work needs. It starts with factory settings, as the module
does (4.2.23 crashes when it reads preferences): name add-ons with --addons.
"""

import os
import runpy
import sys
import traceback

_SWITCHES = {"-b", "--background", "-noaudio", "--factory-startup"}


def main(arguments):
    # Set the arguments of the program first, because bpy parses sys.argv.
    sys.argv = ["blender", *arguments]
    given = iter(arguments[: arguments.index("--")] if "--" in arguments else arguments)
    import bpy

    import addon_utils  # a module of bpy

    status = 0
    for argument in given:
        if argument in _SWITCHES:
            continue
        if argument == "--python-exit-code":
            status = int(next(given))
        elif argument == "--addons":
            for name in next(given).split(","):
                addon_utils.enable(name, default_set=True)
        elif argument == "--python":
            _attempt(status, runpy.run_path, next(given), run_name="__main__")
        elif argument == "--python-expr":
            _attempt(status, exec, next(given), {"__name__": "__main__"})
        elif argument.startswith("-"):
            sys.exit(f"{argument}: an argument that this program does not know.")
        else:
            bpy.ops.wm.open_mainfile(filepath=argument)
    _leave(0)


def _attempt(status, call, *arguments, **options):
    """Runs a part of the command line; if a script fails, ends the program with this status, unless
    it is 0.
    """
    try:
        call(*arguments, **options)
    except SystemExit as end:
        _leave(end.code if isinstance(end.code, int) else int(end.code is not None))
    except Exception:
        traceback.print_exc()
        if status:
            _leave(status)


def _leave(status):
    """Ends the process at once, because the normal end of the module may crash."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    main(sys.argv[1:])
