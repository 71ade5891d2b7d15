# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels for Windows x64."""

from .. import other_systems
from ..tools import run
from . import libraries, python

PLATFORM = "win_amd64"


def wheel(built, version):
    """Makes a wheel for Windows x64, for the Python of a wheel from wheels.built(); returns
    its path.
    """
    folder = build_folder(version)
    module = other_systems.module(folder, _suffix(version))
    stripped = folder / module.name
    run("x86_64-w64-mingw32-strip", "-o", stripped, module)
    licenses = other_systems.debian_licenses(
        "libz-mingw-w64-dev", "gcc-mingw-w64-base", "mingw-w64-common"
    )
    return other_systems.wheel(built, stripped, python.tag(version), PLATFORM, licenses)


def build_folder(version, *more):
    """Configures the build for a version of Python; returns its folder. more: options of CMake."""
    libraries.build()
    home = python.folder(version)
    tag = python.tag(version)
    folder = libraries.WORK / tag
    library = f"Python_LIBRARY={home / 'libs' / f'python{tag[2:]}.lib'}"
    suffix = _suffix(version)
    other_systems.configure(folder, libraries.TOOLCHAIN, home / "include", suffix, library, *more)
    return folder


def _suffix(version):
    return f".{python.tag(version)}-{PLATFORM}.pyd"
