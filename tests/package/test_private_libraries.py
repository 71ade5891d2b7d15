# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that our module uses only its own libraries in Blender, which has other oneTBB, OpenVDB and
Embree.

The dynamic linker logs its bindings.
"""

import re
import shutil
import zipfile
from collections import Counter

import pytest

# Libraries that every process has, and Python's.
ALLOWED = re.compile(
    r"(libc|libm|libstdc\+\+|libgcc_s|ld-linux-x86-64|libz|libpython3[\d.]+)\.so|linux-vdso"
)
# Symbols of the program's own allocator, which serves the whole process.
ALLOCATION = re.compile(
    r"(malloc|calloc|realloc|free|memalign|posix_memalign|aligned_alloc|malloc_usable_size"
    r"|_Zn[wa].*|_Zd[la].*)$"
)
BINDING = re.compile(r"binding file (\S+) \[\d+\] to (\S+) \[\d+\]: \S+ symbol `([^']+)'")

BAKE = """
import sys
sys.path.insert(0, sys.argv[-1])
import leaflight
bake = leaflight.bake(leaflight.bump_box(12), error=20.0)
bake.save(sys.argv[-1] + "/bake.vdb")
assert leaflight.load_bake(sys.argv[-1] + "/bake.vdb").grid.texels == bake.grid.texels
print("done with", leaflight.__file__)
"""


def bindings(logs):
    """Yields (file, its library, symbol) for each binding in the linker's log."""
    for log in logs:
        with open(log, errors="replace") as lines:
            for line in lines:
                if found := BINDING.search(line):
                    yield found.groups()


@pytest.fixture(scope="module")
def in_blender(run, plain_environment, made, tmp_path_factory):
    """Returns all bindings in a Blender that bakes, saves and loads, and the folder of our
    libraries.
    """
    if shutil.which("blender") is None:
        pytest.fail("there is no program blender; run scripts/setup")
    folder = tmp_path_factory.mktemp("blender")
    packages = folder / "packages"
    with zipfile.ZipFile(made["wheel"]) as archive:
        archive.extractall(packages)
    environment = plain_environment(
        BLENDER_USER_CONFIG=str(folder),
        BLENDER_USER_SCRIPTS=str(folder),
        LD_DEBUG="bindings",
        LD_DEBUG_OUTPUT=str(folder / "bindings"),
        LD_BIND_NOW="1",
    )
    shown = run(
        *("blender", "--background", "--factory-startup", "--python-exit-code", "1"),
        *("--python-expr", BAKE, "--", packages),
        env=environment,
    )
    assert f"done with {packages}" in shown
    return list(bindings(folder.glob("bindings.*"))), str(packages)


def test_nothing_of_ours_is_bound_to_libraries_of_blender(in_blender):
    found, own = in_blender
    within, foreign = Counter(), set()
    for user, provider, symbol in found:
        if not user.startswith(own):
            continue
        library = provider.rpartition("/")[2]
        if provider.startswith(own):
            within[library.partition("-")[0]] += 1
        elif not (ALLOWED.match(library) or ALLOCATION.match(symbol) or symbol.startswith("Py")):
            foreign.add((user.rpartition("/")[2], library, symbol))
    assert not foreign
    # The log must contain all of our libraries.
    for library in ("libtbb", "libopenvdb", "libembree3", "libOpenEXR"):
        assert within[library] > 10


def test_nothing_of_blender_is_bound_to_libraries_of_ours(in_blender):
    found, own = in_blender
    assert not [b for b in found if b[1].startswith(own) and not b[0].startswith(own)]
    # Blender must have loaded its own libraries of the same names.
    others = {provider.rpartition("/")[2].partition(".")[0] for _, provider, _ in found}
    assert {"libtbb", "libopenvdb"} <= others
