# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of the volumes that color isosurfaces, at points, for other programs."""

import re
from collections.abc import Iterable
from itertools import product

import numpy as np

from ..arrays import Array
from .volume_texture import VolumeTexture


def named_values(texture: VolumeTexture | None, points: Array) -> dict[str, Array]:
    """Returns {name of a channel: its values, float32 (n,)} at world points (n, 3).

    A name is that of the volume, with a number if another channel has it. A value is NaN where the
    texture has none.
    """
    if texture is None:
        return {}
    names = _different(channel.name for channel in texture.channels)
    return dict(zip(names, _values_at(texture, points)))


def identifiers(values: dict[str, Array], taken: Iterable[str]) -> dict[str, Array]:
    """Returns named values under names of ASCII letters, digits and "_", none of them in `taken`.

    Letters of `taken` are lower case. Names differ in more than their case.
    """
    stems = [re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") for name in values]
    stems = [stem if re.match("[A-Za-z]", stem) else f"value_{stem}".rstrip("_") for stem in stems]
    return dict(zip(_different(stems, taken), values.values()))


def _different(names: Iterable[str], taken: Iterable[str] = ()) -> list[str]:
    used, found = set(taken), []
    for name in names:
        other, number = name, 2
        while other.lower() in used:
            other, number = f"{name}_{number}", number + 1
        used.add(other.lower())
        found.append(other)
    return found


def _values_at(texture: VolumeTexture, points: Array) -> Array:
    """Returns float32 (channels, n), as the core interpolates them (scene/volume_texture.cpp)."""
    to_index = np.linalg.inv(np.asarray(texture.channels[0].index_to_world, np.float64))
    dims = np.array(texture.channels[0].values.shape[::-1])
    index = np.asarray(points, np.float64) @ to_index[:3, :3].T + to_index[:3, 3]
    is_outside = ((index < -0.5) | (index > dims - 0.5)).any(axis=1)
    index = np.clip(index, 0, dims - 1)
    if texture.nearest:
        index = np.floor(index + 0.5)
    low = index.astype(np.intp)
    high, shares = np.minimum(low + 1, dims - 1), index - low
    found = np.zeros((len(texture.channels), len(index)))
    for corner in product((False, True), repeat=3):
        weight = np.where(corner, shares, 1.0 - shares).prod(axis=1)
        x, y, z = np.where(corner, high, low).T
        for number, channel in enumerate(texture.channels):
            # NaN and infinity count only with a weight.
            found[number] += np.multiply(
                weight, channel.values[z, y, x], out=np.zeros_like(weight), where=weight > 0
            )
    found[:, is_outside] = np.nan
    return found.astype(np.float32)
