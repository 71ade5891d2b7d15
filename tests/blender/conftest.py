# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for all tests: a Blender with the installed package, and results of its checks."""

import hashlib
import json
from pathlib import Path

import driver
import numpy as np
import pytest

# These files run inside Blender, started by test_addon.py.
collect_ignore = ["inside"]

HERE = Path(__file__).resolve().parent
RESULTS = driver.ROOT / "build" / "compatibility"


class Blender(driver.Blender):
    """A Blender that skips a test which needs a window, if there is none."""

    def show(self, *arguments, **options):
        if reason := self.no_window():
            pytest.skip(reason)
        return super().show(*arguments, **options)


@pytest.fixture(scope="session")
def legacy_zip():
    (path,) = driver.package_of("--legacy")
    return path


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    blender = Blender(tmp_path_factory.mktemp("blender"))
    package = blender.package()
    print(blender.install(package))
    blender.about["package"] = package.name
    known = hashlib.sha256()
    for path in (package, *sorted((HERE / "inside").glob("*.py"))):
        known.update(path.read_bytes())
    blender.about["digest"] = known.hexdigest()
    return blender


@pytest.fixture(scope="session")
def ball(tmp_path_factory):
    """Returns a file of values that decrease from 100 in the middle to 13.4 in the corners."""
    path = tmp_path_factory.mktemp("volume") / "ball.npy"
    z, y, x = np.mgrid[-1:1:40j, -1:1:40j, -1:1:40j]
    np.save(path, (100 - 50 * np.sqrt(x**2 + y**2 + z**2)).astype(np.float32))
    return path


@pytest.fixture(scope="session")
def results(blender):
    """Returns the folder of the results of this Blender's checks, for validation/run compatibility.

    It collects the results of several runs while the package and the checks stay the same.
    """
    about = blender.about
    system = "-windows" if about["windows"] else ""
    name = f"{about['blender'].split()[0]}-numpy{about['numpy'].split('.')[0]}{system}"
    folder = RESULTS / name
    folder.mkdir(parents=True, exist_ok=True)
    # List all checks, even if only some of them run.
    about["checks"] = sorted(path.stem for path in (HERE / "inside").glob("check_*.py"))
    about_file = folder / "about.json"
    if not about_file.exists() or json.loads(about_file.read_text()) != about:
        for old in folder.glob("*.json"):
            old.unlink()
        about_file.write_text(json.dumps(about, indent=2) + "\n")
    return folder
