# SPDX-License-Identifier: GPL-3.0-or-later
"""Wheels for systems that this machine does not run: those for Linux with another module."""

import shutil

from . import wheels
from .tools import OUT, ROOT, run

# Debian's packages of what is within every module, which have the licences.
LICENSES = (
    *("libtbb-dev", "libimath-dev", "libopenexr-dev", "liblz4-1", "libblosc-dev", "libopenvdb-dev"),
    *("libembree-dev", "libboost-dev", "libnanoflann-dev"),
)


def configure(folder, toolchain, headers, suffix, *more):
    """Has CMake configure a build in the folder. headers: of Python; suffix: of the module's name;
    more: options of CMake."""
    options = (
        *("CMAKE_BUILD_TYPE=Release", f"CMAKE_TOOLCHAIN_FILE={toolchain}"),
        f"Python_INCLUDE_DIR={headers}",
        # pybind11 has no interpreter of that system to ask.
        *(f"PYTHON_MODULE_EXTENSION={suffix}", "PYTHON_MODULE_DEBUG_POSTFIX=", "PYTHON_IS_DEBUG=0"),
        *more,
    )
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, *(f"-D{option}" for option in options))


def module(folder, suffix):
    """Builds the compiled module in a configured folder; returns its path."""
    run("cmake", "--build", folder, "--target", "_core")
    return folder / "python" / "leaflight" / f"_core{suffix}"


def wheel(built, module, tag, system, licenses):
    """Makes it of any that wheels.built() returns and of a module; returns its path.

    tag: of Python ("cp311"); system: its tag of a platform; licenses: paths of more of them, by
    name.
    """
    folder = wheels.unpack(built, wheels.WORK / f"{tag}-{system}")
    (of_linux,) = folder.glob("leaflight/_core*.so")
    of_linux.unlink()
    shutil.copyfile(module, folder / "leaflight" / module.name)
    (info,) = folder.glob("*.dist-info")
    for name, path in licenses.items():
        shutil.copyfile(path, info / "licenses" / f"{name}.txt")
    untagged = wheels.pack(folder, folder.parent)
    tags = ("--python-tag", tag, "--abi-tag", tag, "--platform-tag", system)
    name = run("wheel", "tags", *tags, untagged).splitlines()[-1]
    for old in OUT.glob(f"leaflight-*-{tag}-{tag}-{system}.whl"):
        old.unlink()
    return (folder.parent / name).replace(OUT / name)


def debian_licenses(*more):
    """Paths by name, of LICENSES and more packages."""
    return {name: f"/usr/share/doc/{name}/copyright" for name in (*LICENSES, *more)}
