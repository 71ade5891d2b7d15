# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the options of commands: volumes to light, scene, colors, bake and workers."""

import contextlib
import os
from argparse import Namespace
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from .._core import LeaflightError, Progress
from ..bake.baked import Bake
from ..bake.load_bake import load_bake
from ..io.output import check_writable
from ..io.readers.reading import OPTIONS
from ..io.scene_file import cornell_box, load_scene
from ..io.sources import is_generated, open_volume
from ..scene.scene import SceneDescription, match_isosurfaces
from ..scene.volume_texture import VolumeTexture, label_texture, texture_of
from ..stills.first_view import default_isovalue_of
from ..volume.derived import gradient_of, height_of, slices_of
from ..volume.first_isovalue import default_isovalue_range
from ..volume.memory import limit_memory
from ..volume.regions import without_cuts
from ..volume.volume import Volume
from .output import print_error

if TYPE_CHECKING:
    from ..cluster.workers import Workers


def to_light(options: Namespace, suffix: str) -> tuple[list[Volume], SceneDescription]:
    """Returns the volumes and the scene of a command that lights them and writes a file."""
    scene = load_scene(options.scene) if options.scene else cornell_box()
    readings: list[tuple[str | None, dict[str, Any]]]
    readings = [(source, {}) for source in options.volumes] or [
        (isosurfaces.source, isosurfaces.reading or {}) for isosurfaces in scene.isosurfaces
    ]
    sources = [source for source, _ in readings if source is not None]
    if len(sources) < len(readings):
        raise LeaflightError(
            "Nothing to light: name a VOLUME, or give --scene a file whose volumes have a source."
        )
    if options.out is not None:
        check_writable(options.out, suffix, *sources)
    # Set the limit again for each bake of a batch.
    folder = None if options.out is None else os.path.dirname(os.path.abspath(options.out))
    limit_memory(getattr(options, "memory", None), folder)
    volumes = [
        open_with(source, options, reading) for source, (_, reading) in zip(sources, readings)
    ]
    for volume in volumes:
        for note in volume.notes:
            print_error(note)
    if options.capped:
        scene = replace(
            scene,
            isosurfaces=[replace(isosurfaces, capped=True) for isosurfaces in scene.isosurfaces],
        )

    def slices(number: int) -> Volume:
        reading = _merged(options, readings[number][1])
        regions = reading.pop("regions", None)
        whole = open_volume(sources[number], **reading, regions=without_cuts(regions))
        return slices_of(whole, regions or ())

    return volumes, colored(scene, volumes, options, slices)


def bake_options(options: Namespace) -> dict[str, Any]:
    """Returns the arguments that bake and bake_flatland have in common."""
    return given_options(options, ("isovalues", "error", "time", "resolution", "seed", "threads"))


def given_options(options: Namespace, names: Container[str]) -> dict[str, Any]:
    """Returns those of the options that were given, by their names."""
    return {
        name: value for name, value in vars(options).items() if name in names and value is not None
    }


def open_with(source: str, options: Namespace, reading: Mapping[str, Any] | None = None) -> Volume:
    """Opens a volume. reading: Options in a scene file; options of the command override them."""
    return open_volume(source, **_merged(options, reading or {}))


def _merged(options: Namespace, reading: Mapping[str, Any]) -> dict[str, Any]:
    return {**reading, **given_options(options, OPTIONS)}


def opened(options: Namespace) -> Bake:
    """Returns the bake of a command, and chooses an isovalue if none is given."""
    baked = load_bake(options.bake)
    if options.isovalue is None:
        options.isovalue = default_isovalue_of(baked, getattr(options, "volume", 0))
    return baked


# Functions from a volume to one that colors it, by the name of the option.
DERIVED = {"gradient": gradient_of, "height": height_of}
# Name of the option for the slices on the faces of cuts, which need the volume before its cuts.
SLICES = "slices"
_OF_MAP = ("color_map", "color_range", "color_steps", "color_reverse", "color_symmetric")
# Names of all options.
COLOR_OPTIONS = ("color_by", *_OF_MAP)


def colored(
    scene: SceneDescription,
    volumes: Sequence[Volume],
    options: Namespace,
    slices: Callable[[int], Volume],
) -> SceneDescription:
    """Returns the scene with the colors that the options name. Raises LeaflightError.

    slices: Function from the number of a volume to its slices_of().
    """
    if options.color_by is None:
        given = [name for name in _OF_MAP if getattr(options, name)]
        if given:
            raise LeaflightError(
                f"--{given[0].replace('_', '-')} needs volumes with colors: give --color-by, too."
            )
        return scene
    scene = match_isosurfaces(scene, volumes)
    kind = options.color_by
    other = None if kind == SLICES or kind in DERIVED else open_volume(kind)
    for number, volume in enumerate(volumes):
        if kind == SLICES:
            found = default_isovalue_range(volume)
            texture = _texture(slices(number), options, "cet-l1", found)
        else:
            texture = _texture(DERIVED[kind](volume) if other is None else other, options)
        scene = scene.colored_by(texture, number)
    return scene


def source_anywhere(source: str | None) -> str | None:
    """Returns a name of --color-by that is valid in any folder."""
    if source is None or source == SLICES or source in DERIVED or is_generated(source):
        return source
    return os.path.abspath(source)


def _texture(
    source: Volume,
    options: Namespace,
    color_map: str = "viridis",
    value_range: tuple[float, float] | None = None,
) -> VolumeTexture:
    """Returns the texture of the options. color_map, value_range: Where they name none."""
    key = (options.color_map or color_map).upper().replace("-", "_")
    if key == "LABELS":
        return label_texture(source)
    return texture_of(
        source,
        key,
        options.color_range or value_range,
        reverse=options.color_reverse,
        symmetric=options.color_symmetric,
        steps=options.color_steps or 0,
    )


@contextlib.contextmanager
def workers_of(
    options: Namespace, progress: Progress, least: int = 0
) -> Iterator["Workers | None"]:
    """Yields the workers; None without either option.

    least: Number of processes on this machine without either option; 0 gives None.
    """
    count = options.workers
    if options.scheduler is None and count is None:
        if least == 0:
            yield None
            return
        count = least
    # Import Dask only here: it may not be installed, and it takes a second to load.
    from ..cluster.workers import Workers

    progress.begin("Starting workers")
    with Workers(count, options.scheduler) as workers:
        yield workers
