# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the installation during `import leaflight`, in a few milliseconds.

A module that misreads arrays, or a library of another version than at build time, would bake
wrong light that looks like a result. Each failure is an ImportError of one sentence. The import of
this module runs the check.
"""

import os
import platform
import sys
from collections.abc import Iterable, Mapping
from importlib import import_module
from types import ModuleType

try:
    resource: ModuleType | None = import_module("resource")
except ImportError:
    resource = None  # Windows has no limit on address space.

OLDEST_NUMPY = (1, 24)
# Features of x86-64-v2, the target of the module (CMakeLists.txt), by NumPy's names.
PROCESSOR_FEATURES = ("SSE42", "POPCNT")
# Bytes of address space that the libraries and the stack of each thread need. With less, they fail
# without a clear error: one reports version 0.0, another ends the process.
LEAST_MEMORY, MEMORY_OF_A_THREAD = 1 << 30, 16 << 20


def check() -> None:
    """Raises ImportError if Leaflight cannot work correctly."""
    check_memory(*memory_limit())
    numpy = _numpy()
    check_processor(_processor_features())
    core = _core()
    check_libraries(core.libraries())
    try:
        check_arrays(numpy, core)
        check_rays(numpy, core)
    except core.LeaflightError as error:
        # Raised for an array that arrives with another layout.
        raise ImportError(
            f"Leaflight's compiled module fails its self-test ({error}) with NumPy "
            f"{numpy.__version__}; install a Leaflight built for this NumPy."
        ) from None


def memory_limit() -> tuple[int | None, int | None]:
    """Returns (bytes of address space for this process, None for all; threads that it may run)."""
    if resource is None:
        return None, os.cpu_count()
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return None if limit == resource.RLIM_INFINITY else limit, threads


def check_memory(limit: int | None, threads: int | None) -> None:
    least = LEAST_MEMORY + (threads or 1) * MEMORY_OF_A_THREAD
    if limit is not None and limit < least:
        raise ImportError(
            f"Leaflight needs {_mebibytes(least)} of memory to start, but this process is limited "
            f"to {_mebibytes(limit)}; raise the limit (ulimit -v)."
        )


def _mebibytes(count: int) -> str:
    return f"{count >> 20} MiB"


def _numpy() -> ModuleType:
    try:
        import numpy
    except ImportError:
        raise ImportError(
            "Leaflight needs NumPy, which this Python does not have; install the package numpy."
        ) from None
    check_numpy(numpy.__version__)
    return numpy


def check_numpy(version: str) -> None:
    if tuple(int(part) for part in version.split(".")[:2]) < OLDEST_NUMPY:
        oldest = ".".join(map(str, OLDEST_NUMPY))
        raise ImportError(
            f"Leaflight needs NumPy {oldest} or newer, but NumPy {version} is installed; upgrade "
            "the package numpy."
        )


def _processor_features() -> Mapping[str, bool]:
    """Returns the features of an x86 processor that NumPy detected."""
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return {}
    for package in ("numpy._core", "numpy.core"):  # of NumPy 2 and 1
        try:
            features = import_module(f"{package}._multiarray_umath").__cpu_features__
        except (ImportError, AttributeError):
            continue
        return dict(features)
    return {}


def check_processor(features: Mapping[str, bool]) -> None:
    """Raises ImportError if the processor lacks instructions that the compiled module uses."""
    missing = [name for name in PROCESSOR_FEATURES if not features.get(name, True)]
    if missing:
        raise ImportError(
            f"This processor lacks {' and '.join(missing)}, which nearly all since 2009 have; use "
            "Leaflight on a newer machine."
        )


def _core() -> ModuleType:
    try:
        return import_module("._core", __package__)
    except ModuleNotFoundError:
        here = ".".join(map(str, sys.version_info[:2]))
        raise ImportError(
            f"This installation of Leaflight has no compiled module for Python {here}; install "
            "the package for this version of Python."
        ) from None
    except ImportError as error:
        raise ImportError(
            f"Leaflight's compiled module cannot be loaded ({error}); install Leaflight again."
        ) from None


def check_libraries(
    libraries: Iterable[tuple[str, tuple[int, int], tuple[int, int]]],
) -> None:
    """Raises ImportError unless each library equals its headers or has a newer minor version."""
    for name, built, loaded in libraries:
        if loaded[0] != built[0] or loaded < built:
            raise ImportError(
                f"Leaflight was built with {name} {built[0]}.{built[1]}, but {name} "
                f"{loaded[0]}.{loaded[1]} is loaded; install or build Leaflight again."
            )


def check_arrays(numpy: ModuleType, core: ModuleType) -> None:
    """Raises ImportError unless arrays of this NumPy pass through the module unchanged."""
    values = numpy.arange(24, dtype=numpy.float32).reshape(2, 3, 4)
    matrix = numpy.array([[2, 0, 0, 1], [0, 3, 0, 2], [0, 0, 4, 3], [0, 0, 0, 1]], dtype=float)
    field = core.Field(values, matrix)
    # World position of the last voxel, [z, y, x] = [1, 2, 3].
    sample = field.sample(numpy.array([[7.0, 8.0, 7.0]]))
    unchanged = (
        list(field.dims) == [4, 3, 2]
        and numpy.array_equal(field.values, values)
        and numpy.array_equal(field.index_to_world, matrix)
        and sample.tolist() == [23.0]
    )
    if not unchanged:
        raise ImportError(
            f"Leaflight's compiled module misreads arrays of NumPy {numpy.__version__}; install a "
            "Leaflight built for this NumPy."
        )


def check_rays(numpy: ModuleType, core: ModuleType) -> None:
    """Raises ImportError unless rays hit an isosurface and a mesh behind it correctly."""
    z = numpy.arange(3, dtype=numpy.float32)
    slope = numpy.broadcast_to(z[:, None, None], (3, 3, 3)).copy()
    volume = core.Volume("slope", core.Field(slope, numpy.eye(4)), [(0.0, (0.5, 0.5, 0.5))])
    corners = numpy.array([[-8, -8, 3], [8, -8, 3], [0, 8, 3]], dtype=float)
    ceiling = core.Mesh(
        "ceiling", corners, numpy.array([[0, 1, 2]], dtype=numpy.int32), (0.5, 0.5, 0.5)
    )
    sky = core.Environment("sky", (1.0, 1.0, 1.0))
    scene = core.Scene([volume], [ceiling], [], (0.0, 2.0), sky)
    for origin, kind, z in (((0.9, 1.2, -1.0), "isosurface", 1.25), ((0.9, 1.2, 1.5), "walls", 3)):
        hit, point = core.trace(scene, origin, (0.0, 0.0, 1.0), 1.25)
        if hit != kind or not numpy.allclose(point, (*origin[:2], z), rtol=0, atol=1e-5):
            raise ImportError(
                "Leaflight's compiled module traces rays wrongly on this machine; install or "
                "build Leaflight again."
            )


check()
