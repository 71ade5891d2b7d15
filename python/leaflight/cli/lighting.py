# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the options of commands that light volumes."""

import os
from argparse import Namespace
from collections.abc import Container, Mapping
from dataclasses import replace
from typing import Any

from .._core import LeaflightError
from ..io.output import check_writable
from ..io.readers.reading import OPTIONS
from ..io.scene_file import cornell_box, load_scene
from ..io.sources import open_volume
from ..scene.scene import SceneDescription
from ..volume.derived import slices_of
from ..volume.memory import limit_memory
from ..volume.regions import without_cuts
from ..volume.volume import Volume
from .coloring import colored
from .output import print_error


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
