# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for macOS: its headers to build with, its library to check symbols by."""

from ..maven_python import Build, unpacked
from .targets import WORK

# Builds by version of Python, those of Blender. The headers for both processors differ only in
# lines of pyconfig.h that no other header reads.
BUILDS = {
    "3.11": Build(
        "3.11.3-1.5.9",
        "macosx-x86_64",
        "223aed1538351b9df68781f60afa865c5ca6cc640353cb5d46b4706049cec5e4",
    ),
    "3.13": Build(
        "3.13.0-1.5.11",
        "macosx-arm64",
        "7ad951d158fcb50d5fc3d485712c700c248ce1c747a64148c7dfda5ec140cf0b",
    ),
}


def folder(version):
    """Holds include/pythonVERSION and libpythonVERSION.dylib; fetched once."""
    wanted = ("include/", f"libpython{version}.dylib")
    return unpacked(BUILDS[version], WORK, f"python{version}", wanted)
