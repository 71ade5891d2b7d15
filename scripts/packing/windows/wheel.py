# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel for Windows x64: that for Linux with another compiled module."""

import shutil

from .. import wheels
from ..tools import OUT, ROOT, run
from . import libraries, python

BUILD = libraries.WORK / "leaflight"
TAG = f"cp{python.VERSION.replace('.', '')}"
PLATFORM = "win_amd64"
SUFFIX = f".{TAG}-{PLATFORM}.pyd"
# Debian's packages of what is within the module, which have the licences.
LICENSES = (
    *("libtbb-dev", "libimath-dev", "libopenexr-dev", "liblz4-1", "libblosc-dev", "libopenvdb-dev"),
    *("libembree-dev", "libboost-dev", "libnanoflann-dev", "libz-mingw-w64-dev"),
    *("gcc-mingw-w64-base", "mingw-w64-common"),
)


def wheel(built):
    """Makes it of the one that wheels.built() returns for the same Python; returns its path."""
    module = _module()
    folder = wheels.unpack(built, wheels.WORK / f"{TAG}-{PLATFORM}")
    (of_linux,) = folder.glob("leaflight/_core*.so")
    of_linux.unlink()
    run("x86_64-w64-mingw32-strip", "-o", folder / "leaflight" / module.name, module)
    (info,) = folder.glob("*.dist-info")
    _set_tag(info / "WHEEL")
    _add_licenses(info / "licenses")
    for old in OUT.glob(f"leaflight-*-{PLATFORM}.whl"):
        old.unlink()
    return wheels.pack(folder, OUT)


def _module():
    libraries.build()
    home = python.folder()
    options = (
        *("CMAKE_BUILD_TYPE=Release", f"CMAKE_TOOLCHAIN_FILE={libraries.TOOLCHAIN}"),
        f"Python_INCLUDE_DIR={home / 'include'}",
        f"Python_LIBRARY={home / 'libs' / f'python{TAG[2:]}.lib'}",
        # pybind11 has no interpreter of Windows to ask.
        *(f"PYTHON_MODULE_EXTENSION={SUFFIX}", "PYTHON_MODULE_DEBUG_POSTFIX=", "PYTHON_IS_DEBUG=0"),
    )
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", BUILD, *(f"-D{option}" for option in options))
    run("cmake", "--build", BUILD, "--target", "_core")
    return BUILD / "python" / "leaflight" / f"_core{SUFFIX}"


def _set_tag(path):
    lines = path.read_text().split("\n")
    kept = [line for line in lines if line and not line.startswith("Tag:")]
    path.write_text("\n".join([*kept, f"Tag: {TAG}-{TAG}-{PLATFORM}", ""]))


def _add_licenses(folder):
    for package in LICENSES:
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / f"{package}.txt")
