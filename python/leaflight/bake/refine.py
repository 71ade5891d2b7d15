# SPDX-License-Identifier: GPL-3.0-or-later
"""Refines a bake in passes that was stopped or needs a smaller error."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypedDict

import leaflight._core as _core

from .._core import LeaflightError
from ..progress_bar import with_progress
from ..version import __version__
from ..volume.setting_error import SettingError
from .bake import Task, Workers, lit
from .baked import Bake
from .checkpoint import Checkpoint
from .settings import BakeSettings

if TYPE_CHECKING:
    from typing_extensions import Unpack


class RefineOptions(TypedDict, total=False):
    """The settings that may differ between a bake and the bake that refines it."""

    error: float | None
    time: float | None
    walls: bool | None
    threads: int


@with_progress("refine")
def refine(
    previous: Bake,
    *,
    on_pass: Callable[[Bake], object] | None = None,
    progress: _core.Progress | None = None,
    checkpoint: Checkpoint | None = None,
    workers: Workers | None = None,
    **settings: "Unpack[RefineOptions]",
) -> Bake:
    """Continues a bake with its volumes, its scene and its settings, and returns the new Bake.

    The light of the previous bake is averaged with the light of further passes. The statistics of
    the new bake count the passes, the seconds and the rays of both. A bake with only its first,
    coarse result starts again. So does one whose time limit made its texels coarser.

    previous: A Bake in passes, or one that load_bake() read.
    error: Target in percent, as for bake(). None is the target of the previous bake.
    time: Limit on the added seconds. None is no limit.
    walls: True lights the meshes, too, again from the start. None is as before.
    threads, on_pass, progress, checkpoint, workers: As for bake().
    Raises Cancelled, and LeaflightError if the bake cannot be refined.
    """
    if previous.original is not None:
        raise LeaflightError(
            "A bake with changed lamps or in another scene cannot be continued: continue its "
            "original."
        )
    if not previous.provenance.blocks:
        raise LeaflightError(
            "This bake did a fixed amount of work, so it cannot be continued: bake the volume "
            "again."
        )
    task = _task(previous, **settings)
    reached = previous.statistics.estimated_error_percent
    assert reached is not None
    if reached <= task.settings.error:
        raise SettingError(
            f"The bake already has an error of {reached:.2g} %, and the target is "
            f"{task.settings.error:g} %: give a smaller target to continue it.",
            "error",
        )
    return lit(task, previous, on_pass, progress, checkpoint, workers)


def _task(
    previous: Bake,
    error: float | None = None,
    time: float | None = None,
    walls: bool | None = None,
    threads: int = 0,
) -> Task:
    """Returns the Task of the previous bake with the settings of refine()."""
    known, scene = previous.provenance, previous.scene
    asked = BakeSettings(
        error=known.error if error is None else error,
        time=time,
        resolution=known.asked_resolution if any(known.asked_resolution) else None,
        seed=known.seed,
        threads=threads,
        both_sides=known.both_sides,
        walls=known.walls if walls is None else walls,
    )
    settings = asked.core(_core.BakeSettings, previous.volume.field().dims, scene.exposure)
    provenance = replace(
        known, leaflight_version=__version__, error=settings.error, walls=settings.walls
    )
    return Task(previous.volumes, scene, previous.isovalues, settings, provenance)
