# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels for macOS."""

from .. import other_systems
from . import python, targets


def wheel(built, platform, version):
    """Makes a wheel for macOS, for the Python of a wheel from wheels.built(); returns its path.

    platform: a name of targets.TARGETS.
    """
    target = targets.TARGETS[platform]
    digits = version.replace(".", "")
    suffix = f".cpython-{digits}-darwin.so"
    targets.build(target)
    headers = python.folder(version) / "include" / f"python{version}"
    folder = target.work / f"leaflight-{version}"
    other_systems.configure(folder, target.toolchain, headers, suffix)
    module = other_systems.module(folder, suffix)
    system = f"macosx_{targets.VERSION.replace('.', '_')}_{target.work.name}"
    licenses = other_systems.debian_licenses("zlib1g-dev")
    licenses["libcxx"] = target.work / "runtime" / "libcxx.txt"
    return other_systems.wheel(built, module, f"cp{digits}", system, licenses)
