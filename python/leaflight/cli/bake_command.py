# SPDX-License-Identifier: GPL-3.0-or-later
"""The command bake: new bakes, resumed bakes, and estimates of their cost."""

import os
from argparse import Namespace
from collections.abc import Callable, Collection
from dataclasses import asdict
from functools import partial
from typing import Any

from .._core import Cancelled, LeaflightError, Progress
from ..bake.bake import bake, task_of, worker_memory
from ..bake.baked import Bake
from ..bake.checkpoint import Checkpoint, checkpoint_for, read_recipe
from ..bake.estimate import Estimate, estimate
from ..bake.load_bake import load_bake
from ..bake.refine import refine
from ..bake.statistics import NO_ROOM, outcome
from ..io.output import check_writable
from ..io.sources import is_generated
from ..progress_bar import run_with_progress
from ..scene.scene import SceneDescription
from ..volume.volume import Volume
from ..words import figures
from .lighting import COLOR_OPTIONS, bake_options, source_anywhere, to_light, workers_of
from .output import Output, picked

# Options allowed for any bake, because they do not change its result.
_WHO_WORKS = {"threads", "workers", "scheduler"}
_AT_WILL = {"command", "json", "verbose", *_WHO_WORKS}
# Options of a resumed bake; it takes all others from the previous bake.
_OF_CONTINUED = {"previous", "out", "error", "time", "walls"}
# Options that the result depends on. They start the same bake again.
_RECIPE = {
    *("volumes", "scene", "previous", "capped", "isovalues", "both_sides", "walls", "seed"),
    *("error", "time", "resolution", "dims", "type", "endian", "skip", "spacing", "grid", "frame"),
    *("channel", "level", "dataset", "downsample", "smooth", "smooth_normals", "field"),
    *("hide", "label_table", "regions"),
    "memory",
    *COLOR_OPTIONS,
}


def run_bake(options: Namespace) -> Output:
    if options.resume is not None:
        return run_bake(_interrupted(options))
    light: Callable[..., Bake]
    if options.previous is not None:
        light = _continuing(options)
    else:
        volumes, scene = to_light(options, ".vdb")
        settings = bake_settings(options)
        if options.estimate:
            return _estimate(volumes, scene, settings, options)
        light = partial(bake, volumes, scene, **settings)

    def work(progress: Progress) -> Bake:
        checkpoint = checkpoint_of(options, resumed=getattr(options, "resumed", False))
        with workers_of(options, progress) as workers:
            baked = light(progress=progress, checkpoint=checkpoint, workers=workers)
        baked.save(options.out, progress)
        checkpoint.remove()
        return baked

    return _output(_worked(work, options), options)


def bake_settings(options: Namespace) -> dict[str, Any]:
    """Returns the settings for bake()."""
    return {**bake_options(options), **picked(options, "both_sides walls")}


def _continuing(options: Namespace) -> Callable[..., Bake]:
    """Returns the function that continues a bake."""
    given = _given(options, _OF_CONTINUED | _AT_WILL)
    if given:
        raise LeaflightError(
            f"{options.previous}: only the error and the time of a continued bake can change: "
            f"leave out {', '.join(given)}."
        )
    check_writable(options.out, ".vdb")
    how = picked(options, "error time threads")
    return partial(refine, load_bake(options.previous), walls=options.walls or None, **how)


def _interrupted(options: Namespace) -> Namespace:
    """Returns the options of the bake that left a checkpoint."""
    given = _given(options, {"resume"} | _AT_WILL)
    if given:
        raise LeaflightError(
            f"{options.resume}: a resumed bake keeps its settings: leave out {', '.join(given)}."
        )
    path = checkpoint_for(options.resume)
    if not path.is_file():
        raise LeaflightError(
            f"{path}: there is no checkpoint: the bake to {options.resume} is complete, ended "
            "within half a minute, or never began; start it again."
        )
    recipe = read_recipe(path)
    if not _RECIPE <= recipe.keys():
        raise LeaflightError(f"{path}: Blender wrote this checkpoint: resume the bake there.")
    kept = {name: getattr(options, name) for name in ("json", "verbose", *_WHO_WORKS)}
    recipe.update(out=options.resume, **kept)
    return Namespace(**{**vars(options), **recipe, "resume": None, "resumed": True})


def checkpoint_of(options: Namespace, resumed: bool) -> Checkpoint:
    """Returns the Checkpoint of a bake. Its recipe is the options, with absolute paths."""
    recipe = {name: value for name, value in vars(options).items() if name in _RECIPE}
    recipe["volumes"] = [path_anywhere(volume) for volume in options.volumes]
    recipe["color_by"] = source_anywhere(options.color_by)
    for name in ("scene", "previous", "label_table"):
        recipe[name] = recipe[name] and os.path.abspath(recipe[name])
    return Checkpoint(checkpoint_for(options.out), recipe, resumed)


def path_anywhere(volume: str) -> str:
    """Returns a name of the volume that is valid in any folder."""
    return volume if is_generated(volume) else os.path.abspath(volume)


def _worked(work: Callable[[Progress], Bake], options: Namespace) -> Bake:
    before = _checkpoint_time(options)
    goes_on = f"leaflight bake --resume {options.out} continues it."
    try:
        return run_with_progress(work, "bake", writes=True)
    except Cancelled:
        if _checkpoint_time(options) is not None:
            raise Cancelled(f"cancelled; {goes_on}") from None
        raise
    except LeaflightError as error:
        # A checkpoint from before this bake may belong to another bake.
        if _checkpoint_time(options) != before:
            raise LeaflightError(f"{str(error).rstrip('.')}; afterwards, {goes_on}") from None
        raise


def _checkpoint_time(options: Namespace) -> int | None:
    """Returns the time at which a checkpoint of the output was written; None if there is none."""
    try:
        return os.stat(checkpoint_for(options.out)).st_mtime_ns
    except (OSError, ValueError):
        return None


def _given(options: Namespace, ignored: Collection[str]) -> list[str]:
    """Returns the flags that were given, without the command's own."""
    return [
        "VOLUME" if name == "volumes" else f"--{name.replace('_', '-')}"
        for name, value in vars(options).items()
        if name not in ignored and _is_given(name, value)
    ]


def _is_given(name: str, value: Any) -> bool:
    if value is False:
        return name == "both_sides"  # its default is None
    return value not in (None, []) and (name, value) != ("seed", 0)


def _output(baked: Bake, options: Namespace) -> Output:
    result = {
        "out": options.out,
        "scene": baked.scene.name,
        "isovalues": list(baked.isovalues),
        "both_sides": baked.provenance.both_sides,
        "volumes": [
            {"name": isosurfaces.name, "isovalues": list(isosurfaces.isovalues or baked.isovalues)}
            for isosurfaces in baked.scene.isosurfaces
        ],
        "resolution": list(baked.grid.resolution),
        **baked.statistics.record(),
    }
    lo, hi = figures(*baked.isovalues)
    end = outcome(baked, why=f"another pass would not end within {options.time or 0:g} s")
    return result, [
        f"{options.out}: isovalues {lo}..{hi} in {baked.scene.name}, "
        f"{result['texels']} texels, {result['seconds']:.1f} s, "
        f"{result['rays_per_second'] / 1e6:.2f} million rays/s, "
        f"{result['peak_memory_bytes'] / 2**20:.0f} MiB, "
        f"noise about {result['estimated_rms_percent']:.2f} %",
        *([end] if end else []),
        *_isosurface_map(baked),
        # The outcome already reports work skipped for lack of memory or time.
        *(
            f"skipped: {name} ({reason})"
            for name, reason in result["skipped_passes"]
            if options.verbose and name not in NO_ROOM
        ),
    ]


def _estimate(
    volumes: list[Volume], scene: SceneDescription, settings: dict[str, Any], options: Namespace
) -> Output:
    def work(progress: Progress) -> Estimate:
        return estimate(volumes, scene, progress=progress, **settings)

    cost = run_with_progress(work, "estimate")
    return asdict(cost), [
        f"a bake takes about {cost.seconds:.0f} s and {cost.memory_bytes / 2**20:.0f} MiB, to an "
        f"error of {cost.error:.2g} %; this estimate ran {cost.pilot_passes} of its {cost.passes} "
        f"passes in {cost.pilot_seconds:.1f} s",
        *_worker_estimate(volumes, scene, settings, options),
    ]


def _worker_estimate(
    volumes: list[Volume], scene: SceneDescription, settings: dict[str, Any], options: Namespace
) -> list[str]:
    if options.workers is None and options.scheduler is None:
        return []
    mebibytes = worker_memory(task_of(volumes, scene, **settings)) / 2**20
    return [f"each worker needs about {mebibytes:.0f} MiB for light and values"]


def _isosurface_map(baked: Bake) -> list[str]:
    """Returns the isovalues of several volumes at the common isovalues 0..1, as sentences."""
    if len(baked.volumes) == 1:
        return []
    return [
        f"--isovalue 0..1 shows volume {k} ({isosurfaces.name}) at {lo:g}..{hi:g}"
        for k, isosurfaces in enumerate(baked.scene.isosurfaces)
        for lo, hi in [isosurfaces.isovalues or baked.isovalues]
    ]
