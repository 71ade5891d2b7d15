# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with the package installed as its user does it, away from the user's own settings.

It is the program called blender on the search path: Debian's, or that of a module of PyPI's in a
virtual environment (scripts/blender).
"""

import hashlib
import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest
from waiting import HANG

# These files run within Blender, started by test_addon.py.
collect_ignore = ["inside"]

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
RESULTS = ROOT / "build" / "compatibility"

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


class Blender:
    """Runs Python in background Blender processes that share one folder of the user's."""

    hang = HANG

    def __init__(self, folder):
        self.environment = {**os.environ, "BLENDER_USER_RESOURCES": str(folder)}
        for name in ("config", "scripts", "datafiles", "extensions"):
            self.environment[f"BLENDER_USER_{name.upper()}"] = str(folder / name)
            (folder / name).mkdir()
        self._addons = []
        output = self.run("--python-expr", ABOUT)
        line = next(line for line in output.splitlines() if line.startswith("ABOUT "))
        self.about = json.loads(line.removeprefix("ABOUT "))
        self.extends = self.about["version"] >= [4, 2]

    def install(self, package):
        print(self.run("--python", HERE / "install.py", "--", package))
        if self.about["module"]:
            # It starts without the preferences that have just been saved (program.py).
            self._addons = ["--addons", "bl_ext.user_default.leaflight"]

    def run(self, *arguments):
        """Returns the output of Blender; fails the test when its script fails or hangs."""
        options = ["--background", *self._addons, "--python-exit-code", "1"]
        result = subprocess.run(
            ["blender", *options, *map(str, arguments)],
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=HANG,
        )
        if result.returncode != 0:
            pytest.fail(f"Blender exited with {result.returncode}:\n{result.stdout}", pytrace=False)
        return result.stdout

    def in_window(self, script, *arguments, size=(1024, 640)):
        """Runs a script that drives Blender in a window; returns the object of its line WINDOW.

        It takes the arguments of show().
        """
        status, said = self.show(script, *arguments, size=size)
        lines = [line for line in said.splitlines() if line.startswith("WINDOW ")]
        assert lines and status == 0, said
        return json.loads(lines[0].removeprefix("WINDOW "))

    def show(self, script, *arguments, size=(1024, 640)):
        """Runs a script that drives Blender in a window; returns its exit status and its output.

        Skips the test without a window, or without xvfb-run, which provides a screen. Ends the
        program and its screen when it hangs. size: the window and the screen, in pixels.
        """
        if self.about["module"]:
            pytest.skip("This Blender is a Python module, which has no window.")
        if shutil.which("xvfb-run") is None:
            pytest.skip("There is no xvfb-run: install the Debian package xvfb.")
        width, height = size
        screen = ["xvfb-run", "--auto-servernum", f"--server-args=-screen 0 {width}x{height}x24"]
        program = ["blender", "-noaudio", "--window-geometry", "0", "0", width, height]
        program += ["--enable-event-simulate", "--python-exit-code", "1"]
        program += ["--python", HERE / "name_the_addon.py", "--python", script, "--"]
        process = subprocess.Popen(
            list(map(str, [*screen, *program, *arguments])),
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
            pytest.fail(f"Blender's window hangs:\n{said}", pytrace=False)
        return process.returncode, said

    def check(self, results, *arguments, **variables):
        """Runs inside/run.py, which writes what came of each check to a file of results.

        arguments: of pytest; variables: of the environment.
        """
        environment = self.environment
        self.environment = {**environment, "LEAFLIGHT_RESULTS": str(results), **variables}
        try:
            return self.run("--python", HERE / "inside" / "run.py", "--", *arguments)
        finally:
            self.environment = environment


def package_of(*options):
    """Returns the paths of the packages that scripts/package makes."""
    done = subprocess.run(
        [ROOT / "scripts" / "package", *options], stdout=subprocess.PIPE, text=True, check=True
    )
    return [ROOT / path for path in done.stdout.splitlines()[-1].split()]


@pytest.fixture(scope="session")
def legacy_zip():
    (path,) = package_of("--legacy")
    return path


@pytest.fixture(scope="session")
def blender(request, tmp_path_factory):
    blender = Blender(tmp_path_factory.mktemp("blender"))
    if not blender.extends:
        package = request.getfixturevalue("legacy_zip")
    else:
        python = ".".join(blender.about["python"].split(".")[:2])
        options = [] if python == "3.13" else ["--quick"]
        if blender.about["windows"]:
            options = ["--platform", "windows-x64"]
        elif python not in ("3.11", "3.13"):
            # It came with this Blender (scripts/blender_with_window).
            options += ["--python", Path(shutil.which(f"python{python}")).resolve()]
        (package,) = (
            path
            for path in package_of(*options)
            if path.suffix == ".zip" and "legacy" not in path.name
        )
    blender.install(package)
    blender.about["package"] = package.name
    known = hashlib.sha256()
    for path in (package, *sorted((HERE / "inside").glob("*.py"))):
        known.update(path.read_bytes())
    blender.about["digest"] = known.hexdigest()
    return blender


@pytest.fixture(scope="session")
def ball(tmp_path_factory):
    """Returns a file of values that fall from 100 in the middle to 13.4 in the corners."""
    path = tmp_path_factory.mktemp("volume") / "ball.npy"
    z, y, x = np.mgrid[-1:1:40j, -1:1:40j, -1:1:40j]
    np.save(path, (100 - 50 * np.sqrt(x**2 + y**2 + z**2)).astype(np.float32))
    return path


@pytest.fixture(scope="session")
def results(blender):
    """Returns the folder of the results of this Blender's checks, for validation/compatibility.

    It collects the results of several runs while the package and the checks stay the same.
    """
    about = blender.about
    system = "-windows" if about["windows"] else ""
    name = f"{about['blender'].split()[0]}-numpy{about['numpy'].split('.')[0]}{system}"
    folder = RESULTS / name
    folder.mkdir(parents=True, exist_ok=True)
    # The whole set, wherever only some of it runs.
    about["checks"] = sorted(path.stem for path in (HERE / "inside").glob("check_*.py"))
    about_file = folder / "about.json"
    if not about_file.exists() or json.loads(about_file.read_text()) != about:
        for old in folder.glob("*.json"):
            old.unlink()
        about_file.write_text(json.dumps(about, indent=2) + "\n")
    return folder
