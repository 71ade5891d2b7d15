# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with the add-on, installed as a user installs it, with separate settings.

Tests and the programs of validation/ share it. The program is the command `blender`: Debian's, or
PyPI's module in a virtual environment (scripts/blender).
"""

import functools
import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

from waiting import HANG

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Arguments that let scripts import the add-on as leaflight_addon.
NAMED = ("--python", HERE / "name_the_addon.py")

ABOUT = """
import bpy, ctypes, json, numpy, platform, sys
windows = sys.platform == "win32"
if windows:
    wine = ctypes.windll.ntdll.wine_get_version
    wine.restype = ctypes.c_char_p
    system = f"Windows (Wine {wine().decode().split()[0]})"
else:
    system = platform.freedesktop_os_release()["PRETTY_NAME"]
print("ABOUT", json.dumps({
    "blender": bpy.app.version_string, "version": list(bpy.app.version),
    "python": platform.python_version(), "numpy": numpy.__version__,
    "module": not bpy.app.binary_path,
    "windows": windows,
    "system": f"{system} x86_64",
}))
"""


class BlenderFailed(AssertionError):
    """The error of a Blender whose script failed, or which hangs."""


class Blender:
    """A Blender that runs Python in several processes, which share an empty user folder."""

    hang = HANG

    def __init__(self, folder):
        self.environment = {**os.environ, "BLENDER_USER_RESOURCES": str(folder)}
        for name in ("config", "scripts", "datafiles", "extensions"):
            self.environment[f"BLENDER_USER_{name.upper()}"] = str(folder / name)
            (folder / name).mkdir()
        self._addons, self._named = [], ()
        output = self.run("--python-expr", ABOUT)
        line = next(line for line in output.splitlines() if line.startswith("ABOUT "))
        self.about = json.loads(line.removeprefix("ABOUT "))
        self.extends = self.about["version"] >= [4, 2]

    def install(self, package):
        """Installs the package and the add-on; returns one line for each installed part."""
        installed = self.run("--python", HERE / "install.py", "--", package)
        self._named = NAMED
        if self.about["module"]:
            # Name the add-on, because program.py starts without the saved preferences.
            self._addons = ["--addons", "bl_ext.user_default.leaflight"]
        return installed

    def package(self):
        """Returns the package for this Blender, which scripts/package makes."""
        if not self.extends:
            return package_of("--legacy")[0]
        python = ".".join(self.about["python"].split(".")[:2])
        options = [] if python == "3.13" else ["--quick"]
        if self.about["windows"]:
            options = ["--platform", "windows-x64"]
        elif python not in ("3.11", "3.13"):
            # This Python came with Blender (scripts/blender_with_window).
            options += ["--python", str(Path(shutil.which(f"python{python}")).resolve())]
        made = package_of(*options)
        (found,) = (path for path in made if path.suffix == ".zip" and "legacy" not in path.name)
        return found

    def start(self, *arguments, **options):
        """Returns the process of a background Blender; options: of Popen."""
        program = ["blender", "--background", *self._addons, "--python-exit-code", "1"]
        return subprocess.Popen(
            [*program, *map(str, arguments)],
            env=self.environment,
            stdout=subprocess.PIPE,
            text=True,
            errors="replace",
            **options,
        )

    def run(self, *arguments):
        """Returns the output of a background Blender. Raises BlenderFailed."""
        return self._finished(self.start(*arguments, stderr=subprocess.STDOUT))

    def in_window(self, script, *arguments, **how):
        """Runs a script that drives Blender in a window; returns the object of its line WINDOW.

        It takes the arguments of show().
        """
        status, said = self.show(script, *arguments, **how)
        lines = [line for line in said.splitlines() if line.startswith("WINDOW ")]
        assert lines and status == 0, said
        return json.loads(lines[0].removeprefix("WINDOW "))

    def no_window(self):
        """Returns the reason why no window is possible here, or None."""
        if self.about["module"]:
            return "This Blender is a Python module, which has no window."
        if shutil.which("xvfb-run") is None:
            return "There is no xvfb-run: install the Debian package xvfb."
        return None

    def show(self, script, *arguments, size=(1024, 640), by_hand=True):
        """Runs a script that drives Blender in a window; returns its exit status and its output.

        script: a file of window/, or a path. xvfb-run provides a screen. Ends the program and its
        screen when it hangs. size: the window and the screen, in pixels.
        by_hand: True if the script simulates keys and the mouse. Blender then does not sleep
        between events, and keeps a core busy.
        """
        width, height = size
        screen = ["xvfb-run", "--auto-servernum", f"--server-args=-screen 0 {width}x{height}x24"]
        program = ["blender", "-noaudio", "--window-geometry", "0", "0", width, height]
        program += ["--enable-event-simulate"] * by_hand + ["--python-exit-code", "1"]
        script = HERE / "window" / script
        process = subprocess.Popen(
            list(map(str, [*screen, *program, *self._named, "--python", script, "--", *arguments])),
            env={**self.environment, "LIBGL_ALWAYS_SOFTWARE": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
        try:
            said = process.communicate(timeout=HANG)[0]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            said = process.communicate()[0]
            raise BlenderFailed(f"Blender's window hangs:\n{said}") from None
        return process.returncode, said

    def check(self, results, *arguments, **variables):
        """Runs inside/run.py, which writes the result of each check to a file.

        arguments: of pytest; variables: of the environment.
        """
        environment = self.environment
        self.environment = {**environment, "LEAFLIGHT_RESULTS": str(results), **variables}
        try:
            return self.run("--python", HERE / "inside" / "run.py", "--", *arguments)
        finally:
            self.environment = environment

    def _finished(self, process):
        with process:
            try:
                said = process.communicate(timeout=HANG)[0]
            except subprocess.TimeoutExpired:
                process.kill()
                raise BlenderFailed(f"Blender hangs:\n{process.communicate()[0]}") from None
        if process.returncode != 0:
            raise BlenderFailed(f"Blender exited with {process.returncode}:\n{said}")
        return said


@functools.cache
def package_of(*options):
    """Returns the paths of the packages that scripts/package makes."""
    done = subprocess.run(
        [ROOT / "scripts" / "package", *options], stdout=subprocess.PIPE, text=True, check=True
    )
    return [ROOT / path for path in done.stdout.splitlines()[-1].split()]


def with_addon(folder):
    """Returns a Blender with the add-on, whose settings are in a new folder."""
    folder.mkdir()
    blender = Blender(folder)
    blender.install(blender.package())
    return blender
