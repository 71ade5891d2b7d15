# SPDX-License-Identifier: GPL-3.0-or-later
"""The work in the processes of workers: blocks of the latest bake.

A worker holds the data of one bake only, which bounds its memory.
"""

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import leaflight._core as _core

from .._core import LeaflightError, Progress
from ..arrays import Array
from ..scene.scene import SceneDescription, core_scene
from ..version import __version__
from ..volume.cuts import Cuts
from ..volume.volume import Volume


@dataclass(frozen=True, eq=False)
class Recipe:
    """The data of a bake that a worker needs.

    key: Unique key of the bake.
    arrays: Values of each volume, or the file (.npy) on this machine with them.
    smooth_normals, cuts: As in Volume, for each volume.
    settings: Settings of the core, by name.
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
    version: str = __version__

    def scene_of_core(self) -> _core.Scene:
        volumes = [
            Volume(load(array), matrix, f"volume {k}", smooth_normals=smooth, cuts=cuts)
            for k, (array, matrix, smooth, cuts) in enumerate(
                zip(self.arrays, self.matrices, self.smooth_normals, self.cuts)
            )
        ]
        return core_scene(self.scene, [volume.field() for volume in volumes], self.isovalues)


@dataclass(frozen=True, eq=False)
class LookedUp:
    """The light that lines look up. name: Unique name."""

    name: str
    state: bytes


def load(array: Array | str) -> Array:
    """Returns the values of a volume. All processes that read a file share its memory."""
    import numpy as np

    if not isinstance(array, str):
        return array
    values: Array = np.load(array, mmap_mode="r")
    return values


class _Tracer:
    """The tracer of one bake."""

    def __init__(self, recipe: Recipe) -> None:
        if recipe.version != __version__:
            raise LeaflightError(
                f"A worker has Leaflight {__version__}, but this machine has {recipe.version}: "
                "install the same version on all machines."
            )
        self.key, self.progress = recipe.key, Progress()
        settings = _core.BakeSettings()
        for name, value in recipe.settings.items():
            setattr(settings, name, value)
        self._known: str | None = None
        self._core = _core.BlockTracer(recipe.scene_of_core(), settings, self.progress)

    def look_up(self, looked_up: LookedUp) -> None:
        if looked_up.name != self._known:
            self._core.look_up(looked_up.state)  # type: ignore[arg-type]
            self._known = looked_up.name

    def trace(self, number: int) -> bytes:
        return self._core.trace(number)


_lock = threading.Lock()
_tracer: _Tracer | None = None


def trace(recipe: Recipe, looked_up: LookedUp, number: int) -> bytes:
    """Returns one block of indirect light of a bake, as bytes for _core.bake().

    looked_up: A LookedUp.
    Raises LeaflightError, and Cancelled after cancel().
    """
    global _tracer
    # All blocks share one tracer, and each block uses all allowed threads.
    with _lock:
        if _tracer is None or _tracer.key != recipe.key:
            _tracer = None
            _tracer = _Tracer(recipe)
        _tracer.look_up(looked_up)
        return _tracer.trace(number)


def cancel(key: str) -> None:
    """Ends the work of this worker for a bake, from another thread."""
    tracer = _tracer
    if tracer is not None and tracer.key == key:
        tracer.progress.cancel()


def forget(key: str) -> None:
    """Frees the data of a bake in this worker."""
    global _tracer
    with _lock:
        if _tracer is not None and _tracer.key == key:
            _tracer = None
