# SPDX-License-Identifier: GPL-3.0-or-later
"""Binds a wheel to its copies of shared libraries, whatever the process has loaded already.

auditwheel renames the copies. That is not enough in Blender, whose program has oneTBB, OpenVDB and
Embree in the global scope. The dynamic linker looks there first. It would bind every symbol of ours
to Blender's library and leave the copies unused. So this renames all symbols that the copies and
the module define, too. (RTLD_DEEPBIND would bind malloc away from Blender's allocator, while
libc's own calls stay with it.)
"""

import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .tools import PackageError, run

SUFFIX = ".leaflight"
# Libraries of the system, one copy for each process. Their symbols keep their names.
SYSTEM = ("libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1", "libz.so.1")
# Symbols that the linker itself adds to each library.
_OF_THE_LINKER = {"_init", "_fini", "__bss_start", "_edata", "_end"}
# Names by which oneTBB finds an allocator, at first Blender's: these symbols, or a library of this
# name. Without them it uses malloc.
_ALLOCATOR = {f"scalable_{name}" for name in ("malloc", "free", "aligned_malloc", "aligned_free")}
_ALLOCATOR_LIBRARY, _NO_LIBRARY = b"\0libtbbmalloc.so.2\0", b"\0no-allocator-here\0"


def make_private(folder):
    """Renames the symbols of an unpacked wheel's libraries and modules."""
    files = [*folder.glob("leaflight.libs/*"), *folder.glob("leaflight/_core*.so")]
    defined = set().union(*(_symbols(path, "--defined-only") for path in files))
    needed = set().union(*(_symbols(path, "--undefined-only") for path in files))
    system = set().union(*(_symbols(_system_library(name), "--defined-only") for name in SYSTEM))
    renamed = {
        name
        for name in (defined | _ALLOCATOR) - (needed & system) - _OF_THE_LINKER
        if not name.startswith("PyInit_")
    }
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as names:
        names.writelines(f"{name} {name}{SUFFIX}\n" for name in sorted(renamed))
        names.flush()
        command = ("patchelf", "--rename-dynamic-symbols", names.name)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda path: run(*command, path), files))
    (tbb,) = folder.glob("leaflight.libs/libtbb-*")
    _without_allocator(tbb)


def _symbols(path, which):
    text = run("nm", "--dynamic", which, "--without-symbol-versions", "--format=posix", path)
    return {line.split()[0] for line in text.splitlines()}


def _system_library(name):
    """Returns the path of the library that programs on this machine load."""
    listed = subprocess.run(
        ["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=True
    ).stdout
    for line in listed.splitlines():
        if line.split()[:1] == [name] and "x86-64" in line:
            return Path(line.split("=>")[1].strip())
    raise PackageError(f"The system's {name} is not to be found; install it.")


def _without_allocator(tbb):
    data = tbb.read_bytes()
    if data.count(_ALLOCATOR_LIBRARY) != 1:
        raise PackageError(f"{tbb.name} names its allocator otherwise than expected; look into it.")
    tbb.write_bytes(data.replace(_ALLOCATOR_LIBRARY, _NO_LIBRARY))
