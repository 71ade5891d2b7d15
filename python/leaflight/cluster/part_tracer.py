# SPDX-License-Identifier: GPL-3.0-or-later
"""The work in the processes of workers: parts of the latest bake.

A worker holds the data of one bake only, which bounds its memory.
"""

import threading
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import leaflight._core as _core

from .._core import LeaflightError, Progress
from ..arrays import Array
from ..scene.scene import SceneDescription, core_scene
from ..version import __version__
from ..volume.cuts import Cuts
from ..volume.volume import Volume


# Bytes, or the file on this machine with them.
Passed = bytes | str
# Fewer bytes are not worth a file.
LEAST_FILE_BYTES = 1 << 16


def passed(data: bytes, folder: str | None) -> Passed:
    """Returns bytes as they pass between processes: through a file of the folder, if there is one
    with space. Connections would encrypt and copy them several times.
    """
    if folder is None or len(data) < LEAST_FILE_BYTES:
        return data
    path = Path(folder) / uuid.uuid4().hex
    try:
        path.write_bytes(data)
    except OSError:
        path.unlink(missing_ok=True)
        return data
    return str(path)


def received(data: Passed, last: bool = False) -> bytes:
    """Returns the bytes that passed() has passed. last: Nobody else reads them."""
    if isinstance(data, bytes):
        return data
    path = Path(data)
    found = path.read_bytes()
    if last:
        path.unlink(missing_ok=True)
    return found


@dataclass(frozen=True, eq=False)
class Recipe:
    """The data of a bake that a worker needs.

    key: Unique key of the bake.
    arrays: Values of each volume, or the file (.npy) on this machine with them.
    smooth_normals, cuts: As in Volume, for each volume.
    settings: Settings of the core, by name.
    folder: A folder of this machine for passed(), or None.
    matrices, scene, isovalues: As in Volume and Bake.
    """

    key: str
    arrays: Sequence[Array | str]
    matrices: Sequence[Array]
    smooth_normals: Sequence[float]
    cuts: Sequence[Cuts | None]
    scene: SceneDescription
    isovalues: tuple[float, float]
    settings: dict[str, Any]
    folder: str | None
    version: str = __version__

    def scene_of_core(self) -> _core.Scene:
        volumes = [
            Volume(load(array), matrix, f"volume {k}", smooth_normals=smooth, cuts=cuts)
            for k, (array, matrix, smooth, cuts) in enumerate(
                zip(self.arrays, self.matrices, self.smooth_normals, self.cuts)
            )
        ]
        return core_scene(self.scene, [volume.field() for volume in volumes], self.isovalues)


class OtherVersion(LeaflightError):
    """A worker has another version of Leaflight."""


@dataclass(frozen=True, eq=False)
class Sent:
    """Data that parts of a bake look up. name: Unique name. kind: That of the core."""

    name: str
    kind: int
    data: Passed


def load(array: Array | str) -> Array:
    """Returns the values of a volume. All processes that read a file share its memory."""
    import numpy as np

    if not isinstance(array, str):
        return array
    values: Array = np.load(array, mmap_mode="r")
    return values


class _Tracer:
    """The tracer of one bake."""

    def __init__(self, recipe: Recipe, progress: Progress) -> None:
        if recipe.version != __version__:
            raise OtherVersion(
                f"A worker has Leaflight {__version__}, but this machine has {recipe.version}: "
                "install the same version on all machines."
            )
        self.key = recipe.key
        settings = _core.BakeSettings()
        for name, value in recipe.settings.items():
            setattr(settings, name, value)
        self._known: dict[int, str] = {}  # name of the data that it has read, by kind
        self._core = _core.PartTracer(recipe.scene_of_core(), settings, progress)

    def traced(self, sent: Sequence[Sent], part: bytes) -> bytes:
        for one in sent:
            if self._known.get(one.kind) != one.name:
                self._core.read(one.kind, received(one.data))
                self._known[one.kind] = one.name
        return self._core.traced(part)


_lock = threading.Lock()
_tracer: _Tracer | None = None
_progress: dict[str, Progress] = {}  # by the keys of bakes


def trace(recipe: Recipe, sent: Sequence[Sent], part: bytes) -> Passed:
    """Returns the passed() result of one part of a bake, bytes for _core.bake().

    sent: Data for the part. Raises LeaflightError, and Cancelled after end().
    """
    global _tracer
    progress = _progress.setdefault(recipe.key, Progress())
    # All parts share one tracer, and each part uses all allowed threads.
    with _lock:
        progress.check()
        if _tracer is None or _tracer.key != recipe.key:
            _tracer = None
            _tracer = _Tracer(recipe, progress)
        try:
            return passed(_tracer.traced(sent, part), recipe.folder)
        except BaseException:
            # A part that ended in the middle may have changed the light that others look up.
            _tracer = None
            raise


def end(key: str) -> None:
    """Ends the work of this worker for a bake, from another thread, and frees its data."""
    global _tracer
    _progress.setdefault(key, Progress()).cancel()
    with _lock:
        if _tracer is not None and _tracer.key == key:
            _tracer = None
