# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background --python run.py -- check_file.py: runs pytest within Blender.

Checks that judge the machine (marker machine) are left out unless LEAFLIGHT_MACHINE=1 is set. The
file named by LEAFLIGHT_RESULTS receives the result of each check and the values it recorded.
"""

import json
import os
import runpy
import sys
from pathlib import Path

import bpy
import pytest

here = Path(__file__).resolve().parent


class Results:
    def __init__(self):
        self.found = {}

    def pytest_runtest_logreport(self, report):
        if report.when == "call" or report.outcome != "passed":
            self.found[report.nodeid.split("/")[-1]] = {
                "outcome": report.outcome,
                **dict(report.user_properties),
            }

    def pytest_sessionfinish(self):
        if "LEAFLIGHT_RESULTS" in os.environ:
            text = json.dumps(self.found, indent=2)
            Path(os.environ["LEAFLIGHT_RESULTS"]).write_text(text + "\n")


runpy.run_path(str(here.parent / "name_the_addon.py"))
print(f"Blender {bpy.app.version_string}, {sys.modules['leaflight_addon'].__name__}")
sys.path.insert(0, str(here))  # for tools.py
chosen = [] if os.environ.get("LEAFLIGHT_MACHINE") == "1" else ["-m", "not machine"]
# The project's own settings would replace the installed package by the built one.
status = pytest.main(
    [
        "-c",
        str(here / "pytest.ini"),
        f"--rootdir={here}",
        f"--confcutdir={here}",
        "-p",
        "no:cacheprovider",
        *chosen,
        *sys.argv[sys.argv.index("--") + 1 :],
    ],
    plugins=[Results()],
)
sys.exit(int(status))
