# SPDX-License-Identifier: GPL-3.0-or-later
"""The libraries of the core for Windows, by Debian's compiler."""

import shutil
from pathlib import Path

from .. import libraries
from ..tools import ROOT, PackageError

WORK = ROOT / "build" / "windows"
TOOLCHAIN = Path(__file__).parent / "toolchain.cmake"
# On Windows, Blosc defines thread functions with the same names as GCC's runtime. They get other
# names here. -mxsave: GCC requires it for a query that only processors with XSAVE run.
_BLOSC_THREADS = "create cond_init cond_destroy cond_wait cond_signal cond_broadcast".split()
_BLOSC_FLAGS = " ".join(
    ["-mxsave", *(f"-Dpthread_{name}=blosc_pthread_{name}" for name in _BLOSC_THREADS)]
)
TARGET = libraries.Target(
    "Windows", WORK, TOOLCHAIN, {"c-blosc": (f"CMAKE_C_FLAGS={_BLOSC_FLAGS}",)}
)


def build():
    if shutil.which("x86_64-w64-mingw32-g++-posix") is None:
        raise PackageError("Debian's compiler for Windows is missing; run scripts/setup --windows.")
    libraries.build(TARGET)
