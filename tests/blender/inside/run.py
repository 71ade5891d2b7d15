# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background --python run.py -- check_file.py: runs pytest within Blender."""

import sys
from pathlib import Path

import pytest

here = Path(__file__).resolve().parent
sys.path.insert(0, str(here))  # for tools.py
# The project's own settings would put the Python package in the place of the add-on.
status = pytest.main(
    [
        "-c",
        str(here / "pytest.ini"),
        f"--rootdir={here}",
        f"--confcutdir={here}",
        "-p",
        "no:cacheprovider",
        *sys.argv[sys.argv.index("--") + 1 :],
    ]
)
sys.exit(int(status))
