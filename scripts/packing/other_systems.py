# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes wheels for systems that cannot run here: the wheel for Linux with another module."""

import shutil

from . import wheels
from .tools import OUT, ROOT, run

# Debian packages with the licenses of libraries in every module.
LICENSES = (
    *("libtbb-dev", "libimath-dev", "libopenexr-dev", "liblz4-1", "libblosc-dev", "libopenvdb-dev"),
    *("libembree-dev", "libboost-dev", "libnanoflann-dev"),
)


def configure(folder, toolchain, headers, suffix, *more):
    """Configures a build in the folder with CMake. headers: of Python; suffix: of the module's
    name; more: options of CMake.
    """
    options = (
        *("CMAKE_BUILD_TYPE=Release", f"CMAKE_TOOLCHAIN_FILE={toolchain}"),
        f"Python_INCLUDE_DIR={headers}",
        # pybind11 cannot run an interpreter of that system.
        *(f"PYTHON_MODULE_EXTENSION={suffix}", "PYTHON_MODULE_DEBUG_POSTFIX=", "PYTHON_IS_DEBUG=0"),
        *more,
    )
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, *(f"-D{option}" for option in options))


def module(folder, suffix):
    """Builds the compiled module in a configured folder; returns its path."""
    run("cmake", "--build", folder, "--target", "_core")
    return folder / "python" / "leaflight" / f"_core{suffix}"


def wheel(built, module, tag, system, licenses):
    """Makes a wheel from one that wheels.built() returns and a module; returns its path.

    tag: Tag of Python, such as "cp311".
    system: Tag of the platform.
    licenses: Paths of further licenses, by name.
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
    """Returns {name: path} of the licenses of LICENSES and further packages."""
    return {name: f"/usr/share/doc/{name}/copyright" for name in (*LICENSES, *more)}
