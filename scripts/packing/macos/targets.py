# SPDX-License-Identifier: GPL-3.0-or-later
"""The two processors of macOS, and the compiler and the libraries for each."""

import shutil
from pathlib import Path

from .. import libraries
from ..tools import ROOT, PackageError, run

HERE = Path(__file__).parent
WORK = ROOT / "build" / "macos"
REQUIREMENTS = HERE / "requirements.txt"
VERSION = "11.0"
# Zig's name of each of Apple's processors.
PROCESSORS = {"arm64": "aarch64", "x86_64": "x86_64"}
PROGRAM = """#!/bin/sh
# Keep Zig's results in these folders.
export ZIG_GLOBAL_CACHE_DIR={cache} ZIG_LOCAL_CACHE_DIR={cache}
exec {zig} {command} "$@"
"""


def _target(processor, toolchain, **options):
    headers = ("zlib.h", "zconf.h")
    return libraries.Target(
        f"macOS {processor}", WORK / processor, HERE / toolchain, options, headers
    )


# Targets by Blender's name.
TARGETS = {
    "macos-arm64": _target(
        "arm64", "arm64.cmake", embree=("EMBREE_ISA_NEON=ON", "EMBREE_ISA_SSE2=OFF")
    ),
    "macos-x64": _target("x86_64", "x64.cmake"),
}


def build(target):
    """Prepares the compiler and builds the libraries."""
    if shutil.which("ld64.lld-19") is None:
        raise PackageError("LLVM's linker for macOS is missing; run scripts/setup --macos.")
    _compiler(target)
    libraries.build(target)


def _zig():
    """Returns the folder of the compiler, fetched once."""
    venv = WORK / "venv"
    stamp = venv / "requirements.txt"
    if not stamp.exists() or stamp.read_text() != REQUIREMENTS.read_text():
        run("/usr/bin/python3", "-m", "venv", "--clear", venv)
        run(venv / "bin" / "python", "-m", "pip", "install", "--quiet", "-r", REQUIREMENTS)
        shutil.copyfile(REQUIREMENTS, stamp)
    (folder,) = venv.glob("lib/python*/site-packages/ziglang")
    return folder


def _compiler(target):
    """Makes bin/ of the compiler's programs and runtime/ of its libraries, once."""
    stamp = target.work / "compiler.stamp"
    wanted = f"{REQUIREMENTS.read_text()}{VERSION}\n{PROGRAM}"
    if stamp.exists() and stamp.read_text() == wanted:
        return
    zig = _zig()
    processor = target.work.name
    flags = f"-target {PROCESSORS[processor]}-macos.{VERSION}"
    programs = {"cc": f"cc {flags}", "c++": f"c++ {flags}", "ar": "ar", "ranlib": "ranlib"}
    cache = target.work / "cache"
    shutil.rmtree(cache, ignore_errors=True)
    for folder in (target.work / "bin", target.work / "runtime"):
        folder.mkdir(parents=True, exist_ok=True)
    for name, command in programs.items():
        path = target.work / "bin" / name
        path.write_text(PROGRAM.format(cache=cache, zig=zig / "zig", command=command))
        path.chmod(0o755)
    # Zig compiles the runtime of C++ as it links for the first time.
    source = target.work / "empty.cpp"
    source.write_text("")
    run(target.work / "bin" / "c++", "-shared", "-o", target.work / "empty.so", source)
    runtime = (*cache.glob("o/*/libc++.a"), *cache.glob("o/*/libc++abi.a"))
    for path in runtime:
        shutil.copyfile(path, target.work / "runtime" / path.name)
    # libm is a part of libSystem, but libraries link to it by name.
    names = {"libc/darwin/libSystem.11.tbd": "libm.tbd", "libcxx/LICENSE.TXT": "libcxx.txt"}
    for source, name in names.items():
        shutil.copyfile(zig / "lib" / source, target.work / "runtime" / name)
    stamp.write_text(wanted)
