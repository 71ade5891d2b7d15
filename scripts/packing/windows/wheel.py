# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel for Windows x64: that for Linux with another compiled module."""

import shutil

from .. import wheels
from ..tools import OUT, ROOT, run
from . import libraries, python

PLATFORM = "win_amd64"
# Debian's packages of what is within the module, which have the licences.
LICENSES = (
    *("libtbb-dev", "libimath-dev", "libopenexr-dev", "liblz4-1", "libblosc-dev", "libopenvdb-dev"),
    *("libembree-dev", "libboost-dev", "libnanoflann-dev", "libz-mingw-w64-dev"),
    *("gcc-mingw-w64-base", "mingw-w64-common"),
)


def wheel(built, version):
    """Makes it for a version of Python, of any that wheels.built() returns; returns its path."""
    tag = python.tag(version)
    module = _module(version)
    folder = wheels.unpack(built, wheels.WORK / f"{tag}-{PLATFORM}")
    (of_linux,) = folder.glob("leaflight/_core*.so")
    of_linux.unlink()
    run("x86_64-w64-mingw32-strip", "-o", folder / "leaflight" / module.name, module)
    (info,) = folder.glob("*.dist-info")
    _set_tag(info / "WHEEL", tag)
    _add_licenses(info / "licenses")
    for old in OUT.glob(f"leaflight-*-{tag}-{PLATFORM}.whl"):
        old.unlink()
    return wheels.pack(folder, OUT)


def build_folder(version, *more):
    """Where CMake builds for a version of Python, configured; more: options of CMake."""
    libraries.build()
    home = python.folder(version)
    tag = python.tag(version)
    folder = libraries.WORK / tag
    options = (
        *("CMAKE_BUILD_TYPE=Release", f"CMAKE_TOOLCHAIN_FILE={libraries.TOOLCHAIN}"),
        f"Python_INCLUDE_DIR={home / 'include'}",
        f"Python_LIBRARY={home / 'libs' / f'python{tag[2:]}.lib'}",
        # pybind11 has no interpreter of Windows to ask.
        f"PYTHON_MODULE_EXTENSION=.{tag}-{PLATFORM}.pyd",
        *("PYTHON_MODULE_DEBUG_POSTFIX=", "PYTHON_IS_DEBUG=0", *more),
    )
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, *(f"-D{option}" for option in options))
    return folder


def _module(version):
    folder = build_folder(version)
    run("cmake", "--build", folder, "--target", "_core")
    return folder / "python" / "leaflight" / f"_core.{python.tag(version)}-{PLATFORM}.pyd"


def _set_tag(path, tag):
    lines = path.read_text().split("\n")
    kept = [line for line in lines if line and not line.startswith("Tag:")]
    path.write_text("\n".join([*kept, f"Tag: {tag}-{tag}-{PLATFORM}", ""]))


def _add_licenses(folder):
    for package in LICENSES:
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / f"{package}.txt")
