# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels for macOS: those for Linux with another compiled module."""

import shutil

from .. import wheels
from ..tools import OUT, ROOT, run
from . import python, targets

# Debian's packages of what is within the module, which have the licences.
LICENSES = (
    *("libtbb-dev", "libimath-dev", "libopenexr-dev", "liblz4-1", "libblosc-dev", "libopenvdb-dev"),
    *("libembree-dev", "libboost-dev", "libnanoflann-dev", "zlib1g-dev"),
)


def wheel(built, platform, version):
    """Makes it for a version of Python, of any that wheels.built() returns; returns its path.

    platform: a name of targets.TARGETS.
    """
    target = targets.TARGETS[platform]
    tag = f"cp{version.replace('.', '')}"
    system = f"macosx_{targets.VERSION.replace('.', '_')}_{target.work.name}"
    module = _module(target, version)
    folder = wheels.unpack(built, wheels.WORK / f"{tag}-{system}")
    (of_linux,) = folder.glob("leaflight/_core*.so")
    of_linux.unlink()
    shutil.copyfile(module, folder / "leaflight" / module.name)
    (info,) = folder.glob("*.dist-info")
    for package in LICENSES:
        path = info / "licenses" / f"{package}.txt"
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", path)
    shutil.copyfile(target.work / "runtime" / "libcxx.txt", info / "licenses" / "libcxx.txt")
    untagged = wheels.pack(folder, folder.parent)
    tags = ("--python-tag", tag, "--abi-tag", tag, "--platform-tag", system)
    name = run("wheel", "tags", *tags, untagged).splitlines()[-1]
    for old in OUT.glob(f"leaflight-*-{tag}-{tag}-{system}.whl"):
        old.unlink()
    return (folder.parent / name).replace(OUT / name)


def _module(target, version):
    targets.build(target)
    headers = python.folder(version) / "include" / f"python{version}"
    suffix = f".cpython-{version.replace('.', '')}-darwin.so"
    build = target.work / f"leaflight-{version}"
    options = (
        *("CMAKE_BUILD_TYPE=Release", f"CMAKE_TOOLCHAIN_FILE={target.toolchain}"),
        f"Python_INCLUDE_DIR={headers}",
        # pybind11 has no interpreter of macOS to ask.
        *(f"PYTHON_MODULE_EXTENSION={suffix}", "PYTHON_MODULE_DEBUG_POSTFIX=", "PYTHON_IS_DEBUG=0"),
    )
    run("cmake", "-G", "Ninja", "-S", ROOT, "-B", build, *(f"-D{option}" for option in options))
    run("cmake", "--build", build, "--target", "_core")
    return build / "python" / "leaflight" / f"_core{suffix}"
