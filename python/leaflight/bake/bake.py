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
from ..scene.scene import (
    Isosurfaces,
    SceneDescription,
    core_scene,
    fit_scene,
    match_isosurfaces,
)
from ..scene.volume_texture import VolumeTexture, check_texture
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
    """The interface of cluster.workers.Workers that a bake uses."""

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
    """Returns (volumes, SceneDescription, isovalue_range) for the arguments of bake().

    All volumes get one unit, and the scene is in world coordinates. Raises LeaflightError.
    """
    volumes = as_volumes(volumes)
    for volume in volumes:
        if np.ndim(volume.values) != 3:
            raise LeaflightError(
                f"{volume.name}: this is an image, not a volume: light it with bake_flatland()."
            )
    # All volumes share one world and its unit.
    unit = next((volume.unit for volume in volumes if volume.unit), "")
    volumes = [volume.in_unit(unit) for volume in volumes]
    description = match_isosurfaces(scene or cornell_box(), volumes)
    volumes = [
        volume.capped() if isosurfaces.capped else volume
        for volume, isosurfaces in zip(volumes, description.isosurfaces)
    ]
    description = fit_scene(faced(description, volumes), volumes)
    # The light depends on the values, not on the name of their file.
    isosurfaces = [
        replace(isosurfaces, source=None, texture=_texture(isosurfaces, volume, unit))
        for isosurfaces, volume in zip(description.isosurfaces, volumes)
    ]
    return (
        volumes,
        replace(description, isosurfaces=isosurfaces),
        range_to_bake(isovalues, volumes, isosurfaces),
    )


def _texture(isosurfaces: Isosurfaces, volume: Volume, unit: str) -> VolumeTexture | None:
    """Returns the texture in the unit of the volume. Raises LeaflightError."""
    if isosurfaces.texture is None:
        return None
    texture = isosurfaces.texture.in_unit(unit)
    check_texture(texture, volume)
    return texture


@dataclass(frozen=True, eq=False)
class Task:
    """A bake to be computed: volumes and a scene that fit each other, as placed() returns them.

    settings: the settings of the core; provenance: of the bake before its first pass. chosen: a
    sentence about a setting that was chosen to suit the data, or "".
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
    """Computes the radiance of every isosurface of one or several volumes, within a range.

    Each pass improves the result. The bake ends at the target error, at the time limit, or after
    progress.stop(). The statistics of the Bake hold the error that it reached.

    volumes: A Volume, an array or image that as_volume() takes, or a list of them. Volumes of a
        list light each other (see scene.py). World coordinates use the first unit that one has.
    spacing: Voxel size of arrays without one: a number or (x, y, z).
    scene: A SceneDescription, fitted around the volumes. None is the Cornell box.
    settings: Fields of BakeSettings by name, as follows.
    isovalues: Range (lo, hi) of the common isovalue. For one volume it is in data units; None takes
        the range of the scene, else default_isovalue_range(volume). For several it lies within
        0..1; None is (0, 1).
    error: Target error in percent, as rms_percent of compare(). None is 1.5.
    time: Limit in seconds; None is no limit. A short limit makes the texels wider. At least one
        coarse result is computed.
    resolution: Texels along the longest axis, or (nx, ny, nz). One number gives the other axes
        texels in proportion to their nodes. None is as fine as the data need and the memory allows.
    seed: Seed of the random numbers. Equal seeds give equal results with any number of threads.
    threads: Number of threads; 0 uses every core.
    both_sides: True bakes the back of each isosurface, too. None does so where backs are visible,
        as in level sets and negative lobes.
    walls: True bakes the meshes around the volumes, too.
    on_pass: Function called with a Bake after each pass but the last, in the thread that bakes. The
        statistics of that Bake lack estimated_rms_percent, because it is slow to compute.
    progress: None shows a bar in terminals and notebooks; False shows nothing. A function is called
        with the fraction done and the stage. Another thread polls, stops or cancels a Progress.
        Ctrl-C ends the bake, unless progress is a Progress.
    checkpoint: A Checkpoint, the file in which a bake in passes saves its state, at most half a
        minute apart. An interrupted bake resumes from it and gives the same bits.
    workers: A cluster.workers.Workers, which computes parts of a bake in passes, with the same
        bits. None uses this process alone.
    Returns a Bake. Raises Cancelled, and LeaflightError for input that cannot be baked. Warns
    before the first pass: UnusedSetting for settings without an effect in the scene, ChosenSetting
    if None of both_sides bakes both sides.
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
    """Returns the Task that bake() would compute for these arguments. Raises LeaflightError."""
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
    """Returns a sentence about each setting that has no effect in the scene of a Task."""
    skipped = dict(_core.skipped_passes(task.core_scene(), task.settings))
    back, walls = skipped.get("radiance of the back"), skipped.get("radiance of the walls")
    if all(isosurfaces.scattering != "diffuse" for isosurfaces in task.scene.isosurfaces):
        back = "mirrors and glass store no light, because their appearance depends on the view"
    sentences = []
    if task.settings.both_sides and back:
        sentences.append(f"No backs are baked: {back}.")
    if task.settings.walls and walls:
        sentences.append(f"No walls are baked: {walls}.")
    return sentences


def worker_memory(task: Task) -> int:
    """Returns the approximate bytes that each worker of a bake needs, including the values.

    Raises LeaflightError.
    """
    return _core.part_tracer_memory(task.core_scene(), task.settings)


def lit(
    task: Task,
    previous: Bake | None,
    on_pass: Callable[[Bake], object] | None,
    progress: _core.Progress | None,
    checkpoint: Checkpoint | None = None,
    workers: Workers | None = None,
) -> Bake:
    """Returns the Bake of a Task.

    previous: the Bake in passes that this one resumes, or None. on_pass, progress, checkpoint,
    workers: as for bake(). Raises LeaflightError, Cancelled.
    """
    volumes, scene, isovalues = task.volumes, task.scene, task.isovalues

    def as_bake(baked: _core.Baked) -> Bake:
        statistics = statistics_of(baked)
        grids, continued = baked.grids, ""
        # A first coarse result is not continued.
        if previous is not None and baked.statistics.continued:
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
    on_core_pass = None if on_pass is None else lambda baked: on_pass(as_bake(baked))
    progress = progress or _core.Progress()
    rest = checkpoint.arguments(task.provenance) if checkpoint else {}
    with contextlib.ExitStack() as shared:
        if workers is not None:
            tracing = workers.tracing(volumes, scene, isovalues, task.settings, progress)
            rest["workers"] = shared.enter_context(tracing)
        baked = _core.bake(
            task.core_scene(), task.settings, progress, on_pass=on_core_pass, previous=light, **rest
        )
    result = as_bake(baked)
    noise = estimated_rms_percent(result.grids, scene.exposure)
    return replace(result, statistics=replace(result.statistics, estimated_rms_percent=noise))
