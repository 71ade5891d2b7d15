#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the Blender add-on and the built Python package into one zip.

    scripts/package_addon.py [--preset release]

writes build/<preset>/leaflight-addon.zip, which Blender installs through Preferences > Add-ons >
Install.
"""

import argparse
import os
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "addon" / "leaflight"


def package_addon(preset="release"):
    """Writes the zip and returns its path. Raises FileNotFoundError when nothing is built."""
    package = ROOT / "build" / preset / "python" / "leaflight"
    if not list(package.glob("_core*.so")):
        raise FileNotFoundError(
            f"{package}: the compiled module is not there; run scripts/setup first."
        )
    target = ROOT / "build" / preset / "leaflight-addon.zip"
    partial = target.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        _add_tree(archive, ADDON, "leaflight_addon")
        _add_tree(archive, package, "modules/leaflight")
        archive.write(ROOT / "LICENSE", "leaflight_addon/LICENSE")
    os.replace(partial, target)
    return target


def _add_tree(archive, folder, prefix):
    """Adds the files below a folder, links as the files they point to, in a fixed order."""
    for parent, folders, files in os.walk(folder, followlinks=True):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        for name in sorted(files):
            path = Path(parent) / name
            archive.write(path, f"{prefix}/{path.relative_to(folder).as_posix()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--preset", default="release", help="CMake preset whose build is packed")
    try:
        print(package_addon(parser.parse_args().preset))
    except FileNotFoundError as error:
        sys.exit(f"scripts/package_addon.py: {error}")


if __name__ == "__main__":
    main()
