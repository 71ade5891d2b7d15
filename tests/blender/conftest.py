# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender with the packed add-on installed, away from the user's own settings."""

import os
import subprocess
from pathlib import Path

import pytest

# These files run within Blender, started by test_addon.py.
collect_ignore = ["inside"]

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent

INSTALL = """
import bpy, sys
bpy.ops.preferences.addon_install(filepath=sys.argv[-1])
bpy.ops.preferences.addon_enable(module="leaflight_addon")
bpy.ops.wm.save_userpref()
"""


class Blender:
    """Runs Python in background Blender processes that share one set of preferences."""

    def __init__(self, folder):
        self.environment = {
            **os.environ,
            "BLENDER_USER_CONFIG": str(folder / "config"),
            "BLENDER_USER_SCRIPTS": str(folder / "scripts"),
            "BLENDER_USER_DATAFILES": str(folder / "datafiles"),
        }
        for name in ("config", "scripts", "datafiles"):
            (folder / name).mkdir()

    def run(self, *arguments, timeout):
        """The output of Blender; fails the test when its script fails or takes too long."""
        command = ["blender", "--background", "--python-exit-code", "1", *map(str, arguments)]
        result = subprocess.run(
            command,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=timeout,
        )
        if result.returncode != 0:
            pytest.fail(f"Blender exited with {result.returncode}:\n{result.stdout}", pytrace=False)
        return result.stdout


@pytest.fixture(scope="session")
def addon_zip():
    done = subprocess.run(
        [ROOT / "scripts" / "package", "--legacy"], stdout=subprocess.PIPE, text=True, check=True
    )
    return ROOT / done.stdout.splitlines()[-1]


@pytest.fixture(scope="session")
def blender(addon_zip, tmp_path_factory):
    blender = Blender(tmp_path_factory.mktemp("blender"))
    blender.run("--python-expr", INSTALL, "--", addon_zip, timeout=60)
    return blender
