# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the options for colors by the values of another volume."""

import os
from argparse import Namespace
from collections.abc import Callable, Sequence

from .._core import LeaflightError
from ..io.sources import is_generated, open_volume
from ..scene.scene import SceneDescription, match_isosurfaces
from ..scene.volume_texture import VolumeTexture, label_texture, texture_of
from ..volume.derived import gradient_of, height_of
from ..volume.first_isovalue import default_isovalue_range
from ..volume.volume import Volume

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
