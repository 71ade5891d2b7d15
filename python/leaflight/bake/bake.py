# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: the light of all isosurfaces of volumes at once."""

import contextlib
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import leaflight._core as _core
import numpy as np
from numpy.typing import ArrayLike

from .._core import LeaflightError
from ..io.scene_file import cornell_box, scene_to_json
from ..progress_bar import with_progress
from ..scene.facing import faced
from ..scene.scene import SceneDescription, core_scene, fit_scene, match_isosurfaces
from ..volume.other_arrays import as_volumes
from ..volume.volume import Volume
from .baked import Bake
from .both_sides import why_both_sides_of
from .checkpoint import Checkpoint
from .color_error import estimated_rms_percent
from .fit_memory import coarser_texels, fit_memory
from .settings import BakeOptions, BakeSettings, ChosenSetting, UnusedSetting, range_to_bake
from .provenance import Provenance, provenance_of
from .statistics import statistics_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Workers(Protocol):
    """Those of cluster.workers, as far as a bake needs them."""

    def tracing(
        self,
        volumes: Sequence[Volume],
        scene: SceneDescription,
        isovalues: tuple[float, float],
        settings: _core.BakeSettings,
        progress: _core.Progress,
    ) -> contextlib.AbstractContextManager[object]: ...


def placed(
    volumes: Any, scene: SceneDescription | None, isovalues: Sequence[float] | None
) -> tuple[list[Volume], SceneDescription, tuple[float, float]]:
    """What is lit, from the arguments of bake(): (volumes, SceneDescription, isovalue_range)."""
    volumes = as_volumes(volumes)
    for volume in volumes:
        if np.ndim(volume.values) != 3:
            raise LeaflightError(f"{volume.name}: this is no volume; light images with flatland.")
    # They share one world.
    unit = next((volume.unit for volume in volumes if volume.unit), "")
    volumes = [volume.in_unit(unit) for volume in volumes]
    description = match_isosurfaces(scene or cornell_box(), volumes)
    volumes = [
        volume.capped() if isosurfaces.capped else volume
        for volume, isosurfaces in zip(volumes, description.isosurfaces)
    ]
    description = fit_scene(faced(description, volumes), volumes)
    # Not what the result depends on: the volumes themselves are stored.
    isosurfaces = [replace(isosurfaces, source=None) for isosurfaces in description.isosurfaces]
    return (
        volumes,
        replace(description, isosurfaces=isosurfaces),
        range_to_bake(isovalues, volumes, isosurfaces),
    )


@dataclass(frozen=True, eq=False)
class Task:
    """A bake that is asked for: volumes and a scene that fit each other, as placed() leaves them.

    settings: of the core; provenance: that of the bake before its first pass. chosen: a sentence
    about a setting that was chosen by what the volumes hold, or "".
    """

    volumes: list[Volume]
    scene: SceneDescription
    isovalues: tuple[float, float]
    settings: _core.BakeSettings
    provenance: Provenance
    chosen: str = ""

    def core_scene(self) -> _core.Scene:
        fields = [volume.field() for volume in self.volumes]
        return core_scene(self.scene, fields, self.isovalues)


@with_progress("bake")
def bake(
    volumes: Any,
    scene: SceneDescription | None = None,
    *,
    spacing: ArrayLike | None = None,
    on_pass: Callable[[Bake], object] | None = None,
    progress: _core.Progress | None = None,
    checkpoint: Checkpoint | None = None,
    workers: Workers | None = None,
    **settings: "Unpack[BakeOptions]",
) -> Bake:
    """Computes the radiance of every isosurface of a volume or of several, within a range.

    The bake goes on in passes, each of which leaves a better result, until it reaches the error or
    the time asked for, or progress.stop() is called; statistics of the Bake tell how far it came.

    volumes: a Volume, or an array or image that as_volume() takes, or a list of them, which see
        each other (see scene.py). World coordinates are in the unit of the first that has one.
    spacing: the size of a voxel, one number or (x, y, z), of arrays that have none of their own.
    scene: SceneDescription, fitted around the volumes; None is the Cornell box.
    settings: BakeSettings by their names, as follow.
    isovalues: (lo, hi) of the common isovalue: in data units for one volume, where None takes that
        of the scene or else default_isovalue_range(volume); within 0..1 for several, where None is
        (0, 1).
    error: percent, of what compare() calls rms_percent; None is 1.5. time: seconds that the
        bake may take, None for no limit. Where they are few its texels are wider, and one coarse
        picture is made in any case.
    resolution: texels along the longest axis (the other axes in proportion of their nodes), or
        (nx, ny, nz); None is as fine as the volumes need and their size allows.
    seed: same seed, same result, whatever the threads; threads: 0 takes every core.
    both_sides: the back of each isosurface, too; None where the back is what is seen, as of level
        sets and of negative lobes. walls: the meshes around them, too.
    on_pass: called with a Bake after each pass but the last, in the thread that bakes; the
        statistics of that Bake lack estimated_rms_percent, which takes its time.
    progress: None shows a bar in terminals and notebooks, False nothing; a function is called with
        the fraction done and the stage; a Progress is polled, stopped or cancelled from another
        thread. Ctrl-C ends the bake, unless it is a Progress.
    checkpoint: Checkpoint, the file where a bake in passes leaves its state, at most half a minute
        apart; one that was interrupted goes on from it with the bits that it would have had.
    workers: cluster.workers.Workers, who trace the light of a bake in passes, with the same bits;
        None is this process alone.
    Returns a Bake. Raises LeaflightError for input that cannot be baked, Cancelled. Warns with
    UnusedSetting, before the first pass, of settings that have no effect in the scene, and with
    ChosenSetting where it takes both sides by itself.
    """
    task = task_of(as_volumes(volumes, spacing), scene, **settings)
    for sentence in unused_settings(task):
        warnings.warn(sentence, UnusedSetting, stacklevel=2)
    if task.chosen:
        warnings.warn(task.chosen, ChosenSetting, stacklevel=2)
    baked = lit(task, None, on_pass, progress, checkpoint, workers)
    skipped = coarser_texels(settings.get("resolution"), task.settings)
    skipped = baked.statistics.skipped_passes + skipped
    return replace(baked, statistics=replace(baked.statistics, skipped_passes=skipped))


def task_of(
    volumes: Any, scene: SceneDescription | None = None, **settings: "Unpack[BakeOptions]"
) -> Task:
    """The Task of the bake that bake() would make of these arguments. Raises LeaflightError."""
    asked, chosen = BakeSettings(**settings), ""
    volumes, description, isovalue_range = placed(volumes, scene, asked.isovalues)
    if asked.both_sides is None:
        chosen = why_both_sides_of(volumes, description.isosurfaces, isovalue_range)
        asked = replace(asked, both_sides=bool(chosen))
        if chosen:
            chosen += (
                ", so both sides are baked; both_sides=False (--no-both-sides) bakes fronts alone."
            )
    of_core = asked.core(_core.BakeSettings, volumes[0].field().dims, description.exposure)
    if len(volumes) == 1:
        fit_memory(volumes[0], description, isovalue_range, of_core)
    text = scene_to_json(description)
    provenance = provenance_of(volumes, description.isosurfaces, text, isovalue_range, of_core)
    return Task(volumes, description, isovalue_range, of_core, provenance, chosen)


def unused_settings(task: Task) -> list[str]:
    """A sentence about each setting that has no effect in the scene of a Task."""
    skipped = dict(_core.skipped_passes(task.core_scene(), task.settings))
    back, walls = skipped.get("radiance of the back"), skipped.get("radiance of the walls")
    if all(isosurfaces.scattering != "diffuse" for isosurfaces in task.scene.isosurfaces):
        back = "mirrors and glass store no light, since what they show depends on the view"
    sentences = []
    if task.settings.both_sides and back:
        sentences.append(f"No backs are baked: {back}.")
    if task.settings.walls and walls:
        sentences.append(f"No walls are baked: {walls}.")
    return sentences


def worker_memory(task: Task) -> int:
    """About how many bytes each of the workers of a bake would hold, its values included.

    Raises LeaflightError.
    """
    return _core.block_tracer_memory(task.core_scene(), task.settings)


def lit(
    task: Task,
    previous: Bake | None,
    on_pass: Callable[[Bake], object] | None,
    progress: _core.Progress | None,
    checkpoint: Checkpoint | None = None,
    workers: Workers | None = None,
) -> Bake:
    """The Bake of a Task.

    previous: the Bake in passes that this one goes on with, or None. on_pass, progress, checkpoint,
    workers: as of bake(). Raises LeaflightError, Cancelled.
    """
    volumes, scene, isovalues = task.volumes, task.scene, task.isovalues

    def whole(baked: _core.Baked) -> Bake:
        statistics = statistics_of(baked)
        grids, continued = baked.grids, ""
        # A first picture, of other texels, is not gone on with: the bake is a new one.
        if previous is not None and grids[0].resolution == previous.grid.resolution:
            continued = previous.id
            statistics = replace(
                statistics,
                seconds=statistics.seconds + previous.statistics.seconds,
                rays=statistics.rays + previous.statistics.rays,
            )
        known = task.provenance.after(grids, statistics.passes, statistics.blocks, continued)
        return Bake(volumes, scene, isovalues, grids, baked.walls, statistics, known)

    light = None
    if previous is not None:
        known = previous.provenance
        light = (previous.grids, known.passes, known.blocks)
    look = None if on_pass is None else lambda baked: on_pass(whole(baked))
    progress = progress or _core.Progress()
    rest = checkpoint.arguments(task.provenance) if checkpoint else {}
    with contextlib.ExitStack() as shared:
        if workers is not None:
            tracing = workers.tracing(volumes, scene, isovalues, task.settings, progress)
            rest["workers"] = shared.enter_context(tracing)
        baked = _core.bake(
            task.core_scene(), task.settings, progress, on_pass=look, previous=light, **rest
        )
    result = whole(baked)
    noise = estimated_rms_percent(result.grids, scene.exposure)
    return replace(result, statistics=replace(result.statistics, estimated_rms_percent=noise))
