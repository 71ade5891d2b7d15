# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: the light of all isosurfaces of volumes at once."""

import contextlib
from dataclasses import replace

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..io.scene_file import cornell_box
from ..progress_bar import with_progress
from ..scene.facing import faced
from ..scene.scene import core_scene, fit_scene, match_leaves
from ..volume.other_arrays import as_volumes
from .baked import Bake
from .color_error import estimated_rms_percent
from .fit_memory import coarser_texels, fit_memory
from .settings import bake_settings, leaf_window
from .stamps import stamp, stamp_after


def placed(volumes, scene, isovalues):
    """What is lit, from the arguments of bake(): (volumes, SceneDescription, window)."""
    volumes = as_volumes(volumes)
    for volume in volumes:
        if np.ndim(volume.values) != 3:
            raise LeaflightError(f"{volume.name}: this is no volume; light images with flatland.")
    # They share one world.
    unit = next((volume.unit for volume in volumes if volume.unit), "")
    volumes = [volume.in_unit(unit) for volume in volumes]
    description = match_leaves(scene or cornell_box(), volumes)
    volumes = [
        volume.capped() if leaves.capped else volume
        for volume, leaves in zip(volumes, description.leaves)
    ]
    description = fit_scene(faced(description, volumes), volumes)
    # Not what the result depends on: the volumes themselves are stored.
    leaves = [replace(leaves, source=None) for leaves in description.leaves]
    return volumes, replace(description, leaves=leaves), leaf_window(isovalues, volumes, leaves)


@with_progress("bake")
def bake(
    volumes,
    scene=None,
    *,
    spacing=None,
    isovalues=None,
    error=None,
    time=None,
    resolution=None,
    seed=0,
    threads=0,
    both_sides=False,
    surroundings=False,
    on_round=None,
    progress=None,
    checkpoint=None,
    workers=None,
):
    """Computes the radiance of every isosurface, within a window, of a volume or of several.

    The bake goes on in rounds, each of which leaves a better result, until it reaches the error or
    the time asked for, or progress.stop() is called; statistics of the Bake tell how far it came.

    volumes: a Volume, or an array or image that as_volume() takes, or a list of them, which see
        each other (see scene.py). World coordinates are in the unit of the first that has one.
    spacing: the size of a voxel, one number or (x, y, z), of arrays that have none of their own.
    scene: SceneDescription, fitted around the volumes; None is the Cornell box.
    isovalues: (lo, hi) of the leaf coordinate: in data units for one volume, where None takes that
        of the scene or else default_window(volume); within 0..1 for several, where None is (0, 1).
    error: percent, of what compare() calls rms_percent; None is 1.5. time: seconds after which the
        bake ends with the round in progress, None for no limit.
    resolution: texels along the longest axis (the other axes in proportion of their nodes), or
        (nx, ny, nz); None is as fine as the volumes need and their size allows.
    seed: same seed, same result, whatever the threads; threads: 0 takes every core.
    both_sides: the inner side of each isosurface, too; surroundings: the meshes around them, too.
    on_round: called with a Bake after each round but the last, in the thread that bakes; the
        statistics of that Bake lack estimated_rms_percent, which takes its time.
    progress: None shows a bar in terminals and notebooks, False nothing; a function is called with
        the fraction done and the stage; a Progress is polled, stopped or cancelled from another
        thread. Ctrl-C ends the bake, unless it is a Progress.
    checkpoint: Checkpoint, the file where a bake in rounds leaves its state, at most half a minute
        apart; one that was interrupted goes on from it with the bits that it would have had.
    workers: cluster.workers.Workers, who sweep the light of a bake in rounds, with the same bits;
        None is this process alone.
    Returns a Bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    asked = _asked(
        as_volumes(volumes, spacing),
        scene,
        isovalues=isovalues,
        error=error,
        time=time,
        resolution=resolution,
        seed=seed,
        threads=threads,
        both_sides=both_sides,
        surroundings=surroundings,
    )
    baked = lit(*asked, None, on_round, progress, checkpoint, workers)
    baked.statistics["skipped_passes"] += coarser_texels(resolution, asked[3])
    return baked


def stamp_of(volumes, scene=None, **settings):
    """The metadata of the bake that bake() would make of the same arguments, before its rounds."""
    return _asked(volumes, scene, **settings)[-1]


def worker_memory(volumes, scene=None, **settings):
    """About how many bytes each of the workers of bake() would hold, its values included.

    Raises LeaflightError.
    """
    volumes, description, window, settings, _ = _asked(volumes, scene, **settings)
    core = core_scene(description, [volume.field() for volume in volumes], window)
    return _core.sweeper_memory(core, settings)


def _asked(volumes, scene=None, *, isovalues=None, **settings):
    """Of the arguments of bake(): volumes, scene, window, the core's settings and the metadata."""
    volumes, description, window = placed(volumes, scene, isovalues)
    dims, exposure = volumes[0].field().dims, description.exposure
    settings = bake_settings(_core.BakeSettings, dims, exposure=exposure, **settings)
    if len(volumes) == 1:
        fit_memory(volumes[0], description, window, settings)
    return volumes, description, window, settings, stamp(volumes, description, window, settings)


def lit(
    volumes,
    description,
    window,
    settings,
    metadata,
    kept,
    on_round,
    progress,
    checkpoint=None,
    workers=None,
):
    """The Bake of volumes and a scene that fit each other, as placed() leaves them.

    settings: _core.BakeSettings. metadata: of stamp(). kept: the Bake in rounds that this one goes
    on with, or None. on_round, progress, checkpoint, workers: as of bake().
    Raises LeaflightError, Cancelled.
    """

    def whole(baked):
        statistics = dict(baked.statistics)
        blocks = statistics.pop("blocks")
        grids, continued = baked.grids, ""
        # A first picture, of other texels, is not gone on with: the bake is a new one.
        if kept is not None and grids[0].resolution == kept.grid.resolution:
            continued = kept.id
            for name in ("seconds", "rays"):
                statistics[name] += kept.statistics[name]
        statistics["rays_per_second"] = statistics["rays"] / max(statistics["seconds"], 1e-9)
        known = stamp_after(metadata, grids, statistics["rounds"], blocks, continued)
        surroundings = baked.surroundings
        return Bake(volumes, description, window, grids, surroundings, statistics, known)

    light = None
    if kept is not None:
        light = (kept.grids, int(kept.metadata["rounds"]), int(kept.metadata["blocks"]))
    core = core_scene(description, [volume.field() for volume in volumes], window)
    look = None if on_round is None else lambda baked: on_round(whole(baked))
    progress = progress or _core.Progress()
    rest = checkpoint.arguments(metadata) if checkpoint else {}
    with contextlib.ExitStack() as shared:
        if workers is not None:
            sweeping = workers.sweeping(volumes, description, window, settings, progress)
            rest["workers"] = shared.enter_context(sweeping)
        baked = _core.bake(core, settings, progress, on_round=look, kept=light, **rest)
    result = whole(baked)
    noise = estimated_rms_percent(result.grids, description.exposure)
    result.statistics["estimated_rms_percent"] = noise
    return result
