# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for Windows: its headers and import library to build with, its program to test with.

It is the official build, compiled by Microsoft's compiler.
"""

from ..maven_python import Build, unpacked
from .libraries import WORK

_SYSTEM = "windows-x86_64"
# Builds by version of Python, those of Blender.
BUILDS = {
    "3.11": Build(
        "3.11.3-1.5.9",
        _SYSTEM,
        "3263a50b256447bb7b9e604d6587627e419891370fc33b94469e6a06ff4de834",
    ),
    "3.13": Build(
        "3.13.5-1.5.12",
        _SYSTEM,
        "cfe5502ffa7ea369be707b6d88bf68344732a7800450665080fb4267c01bfeae",
    ),
}


def tag(version):
    """Returns the tag of a Python in names of wheels, such as cp311."""
    return f"cp{version.replace('.', '')}"


def folder(version):
    """Holds python.exe, python311.dll, include/ and libs/python311.lib; fetched once."""
    return unpacked(BUILDS[version], WORK, f"python{version}")
