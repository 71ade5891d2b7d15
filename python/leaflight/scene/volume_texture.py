# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of isosurfaces: their color by the values of another volume at the point."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from ..color_maps import CATEGORICAL, MAPS, colors_of
from ..srgb import linear_from_srgb
from ..volume.label_table import Label, labels_of
from ..volume.memory import as_voxels
from ..volume.volume import Volume

Color = tuple[float, float, float]
Stops = list[tuple[float, Color]]

# Width of the border between the colors of both signs, relative to the largest absolute value.
SIGN_WIDTH = 1e-3
# Width of the border between two steps of a color map, relative to a step.
STEP_WIDTH = 1e-3
# Largest number of steps.
MOST_STEPS = 256
# Colors of red, green and blue channels: a value of 0 is dark, 1 is bright.
RGB: Stops = [(0.0, (0.0, 0.0, 0.0)), (1.0, (1.0, 1.0, 1.0))]


@dataclass(frozen=True, eq=False)
class VolumeTexture:
    """The color of isosurfaces by the values of another volume. It multiplies their albedo.

    channels: One Volume, or three with equal nodes for red, green and blue, in the world
        coordinates of the lit volume.
    colors: Stops (value, color) in ascending values, each color linear in 0..1. It is linear
        between stops and constant beyond. Each of three channels takes its component.
    nearest: True takes the value of the nearest node, as for labels. False interpolates.
    Where there is no value the color is that of the albedo: outside the volume and next to NaN.
    Infinite values have the colors of the ends.
    """

    channels: tuple[Volume, ...]
    colors: Stops
    nearest: bool = False

    @property
    def name(self) -> str:
        return self.channels[0].name

    def in_unit(self, unit: str) -> "VolumeTexture":
        """Returns the texture in world coordinates of another unit, as Volume.in_unit()."""
        return replace(self, channels=tuple(channel.in_unit(unit) for channel in self.channels))

    def core(self) -> _core.VolumeTexture:
        """Returns the texture for the core. Raises LeaflightError."""
        try:
            return _core.VolumeTexture(
                [as_voxels(channel.values) for channel in self.channels],
                np.asarray(self.channels[0].index_to_world, np.float64),
                self.colors,
                self.nearest,
            )
        except LeaflightError as error:
            raise LeaflightError(f"{self.name}: {error}") from None

    def colors_of_nodes(self, fineness: int = 1) -> Array:
        """Returns the colors at the nodes, float32 (nz, ny, nx, 3), or at 1 / fineness of them."""
        matrix = np.asarray(self.channels[0].index_to_world, np.float64)
        matrix = matrix @ np.diag([1.0 / fineness] * 3 + [1.0])
        nz, ny, nx = (fineness * (n - 1) + 1 for n in self.channels[0].values.shape)
        core, planes = self.core(), []
        for z in range(nz):
            y, x = np.mgrid[:ny, :nx]
            nodes = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], axis=-1)
            planes.append(core.at((nodes.reshape(-1, 4) @ matrix.T)[:, :3]).reshape(ny, nx, 3))
        return np.stack(planes)

    def at(self, points: Array) -> Array:
        """Returns the colors, float32 (n, 3), at world points (n, 3)."""
        return self.core().at(points)


def texture_of(
    channels: Volume | Sequence[Volume],
    colors: str | Stops | None = None,
    value_range: tuple[float, float] | None = None,
    nearest: bool = False,
    *,
    reverse: bool = False,
    symmetric: bool = False,
    steps: int = 0,
) -> VolumeTexture:
    """Returns a VolumeTexture.

    channels: One Volume, or three for red, green and blue.
    colors: Key of color_maps.MAPS or CATEGORICAL, or stops (value, color), to which only `nearest`
        applies. None is VIRIDIS; for three channels it is black to white.
    value_range: Values (low, high) at the ends of the color map. None is the range of the data.
    nearest: As in VolumeTexture.
    reverse: True exchanges the ends of the color map.
    symmetric: True extends the range to be symmetric about 0.
    steps: Number of colors of equal width; 0 is smooth. Categorical maps always have steps.
    Raises LeaflightError.
    """
    volumes = (channels,) if isinstance(channels, Volume) else tuple(channels)
    if isinstance(colors, list):
        return VolumeTexture(volumes, colors, nearest)
    if value_range is None:
        ranges = np.array([range_of(volume) for volume in volumes])
        value_range = float(ranges[:, 0].min()), float(ranges[:, 1].max())
    low, high = value_range
    if symmetric:
        high = max(abs(low), abs(high))
        low = -high
    if not (low < high and np.isfinite(high - low)):
        raise LeaflightError(
            f"{volumes[0].name}: the range {low:g} to {high:g} of its colors is empty or infinite: "
            "give a lower and a higher value."
        )
    if colors is None and len(volumes) == 3:
        shares = RGB
    else:
        shares = color_map(colors or "VIRIDIS", reverse, steps)
    return VolumeTexture(
        volumes, [(low + share * (high - low), color) for share, color in shares], nearest
    )


def picture_stops(low: float, high: float) -> Stops:
    """Returns the stops of red, green and blue of a picture, whose values are sRGB.

    low, high: Values of black and white.
    """
    shares = np.linspace(0.0, 1.0, 256)
    linear = linear_from_srgb(shares).tolist()
    values = (low + shares * (high - low)).tolist()
    return [(value, (part, part, part)) for value, part in zip(values, linear)]


def sign_texture(volume: Volume, colors: str = "CET_D1") -> VolumeTexture:
    """Returns the texture that gives values below and above 0 the ends of a color map."""
    stops = color_map(colors)
    width = SIGN_WIDTH * max(map(abs, range_of(volume)))
    return VolumeTexture((volume,), [(-width, stops[0][1]), (width, stops[-1][1])])


def label_texture(volume: Volume) -> VolumeTexture:
    """Returns the texture of a label map, in the colors of its labels. Raises LeaflightError.

    Each label extends to the next voxels without one, where isosurfaces of its boundary lie.
    """
    colors = label_colors(labels_of(volume.values, volume.labels))
    return VolumeTexture((replace(volume, values=_extended(volume.values)),), colors, nearest=True)


def _extended(labels: Array) -> Array:
    """Returns labels in which voxels without a label have that of a neighbor."""
    extended = labels.copy()
    for axis in range(3):
        before, after = (np.moveaxis(each, axis, 0) for each in (extended.copy(), extended))
        for to, source in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
            free = ~(after[to] > 0)
            after[to][free] = before[source][free]
    return extended


def label_colors(labels: Sequence[Label]) -> Stops:
    """Returns stops for labels: white for 0, and the color of each label."""
    white: Stops = [(0.0, (1.0, 1.0, 1.0))]
    return white + [(float(label.number), _linear(label.color)) for label in labels]


def color_map(key: str, reverse: bool = False, steps: int = 0) -> Stops:
    """Returns the stops (share in 0..1, linear color) of a color map. Raises LeaflightError.

    reverse, steps: As for texture_of().
    """
    if key not in MAPS and key not in CATEGORICAL:
        keys = ", ".join((*MAPS, *CATEGORICAL))
        raise LeaflightError(f'There is no color map "{key}": choose one of {keys}.')
    if not 0 <= steps <= MOST_STEPS:
        raise LeaflightError(
            f"The number of steps of the colors is {steps}: choose 0 to {MOST_STEPS}."
        )
    colors = [_linear([byte / 255.0 for byte in bytes.fromhex(text)]) for text in colors_of(key)]
    if reverse:
        colors.reverse()
    if key in CATEGORICAL:
        count = steps or len(colors)
        return _in_steps([colors[i % len(colors)] for i in range(count)])
    shares = np.linspace(0.0, 1.0, len(colors))
    if not steps:
        return list(zip(shares.tolist(), colors))
    # The ends of a cyclic map are equal, so that the last step is before its end.
    is_cyclic = np.allclose(colors[0], colors[-1], atol=0.02)
    places = np.linspace(0.0, 1.0, steps, endpoint=not is_cyclic)
    channels = [np.interp(places, shares, channel) for channel in np.transpose(colors)]
    return _in_steps([(r, g, b) for r, g, b in np.transpose(channels).tolist()])


def _in_steps(colors: list[Color]) -> Stops:
    """Returns stops of colors that each have an equal part of 0..1."""
    count = len(colors)
    ends = [(i + STEP_WIDTH, i + 1 - STEP_WIDTH) for i in range(count)]
    places = [place / count for pair in ends for place in pair]
    places[0], places[-1] = 0.0, 1.0
    return [(place, colors[k // 2]) for k, place in enumerate(places)]


def _linear(srgb: Sequence[float]) -> Color:
    return tuple(linear_from_srgb(np.array(srgb)).tolist())


def range_of(volume: Volume) -> tuple[float, float]:
    """Returns the lowest and the highest finite value. Raises LeaflightError without any."""
    _check_values(volume)
    values, is_finite = volume.values, np.isfinite(volume.values)
    values = values if is_finite.all() else values[is_finite]
    return float(values.min()), float(values.max())


def _check_values(volume: Volume) -> None:
    """Raises LeaflightError unless some value is a finite number."""
    kind = volume.values.dtype.kind
    if kind not in "buif" or not np.isfinite(volume.values).any():
        raise LeaflightError(
            f"{volume.name}: its values are not finite numbers: choose another volume to color by."
        )


def check_texture(texture: VolumeTexture, volume: Volume) -> None:
    """Raises LeaflightError if a texture has no values, or none within the volume it colors."""
    for channel in texture.channels:
        _check_values(channel)
    check_overlap(texture, volume)


def check_overlap(texture: VolumeTexture, volume: Volume) -> None:
    """Raises LeaflightError if a texture lies outside the volume that it colors."""
    low, high = volume.field().bounds
    own_low, own_high = _bounds(texture.channels[0])
    if (own_low > high).any() or (own_high < low).any():
        raise LeaflightError(
            f"{texture.name}: it does not overlap {volume.name}, which it colors: give a volume in "
            "the same coordinates."
        )


def _bounds(volume: Volume) -> tuple[Array, Array]:
    ends = np.array(volume.values.shape[::-1]) - 1.0
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) * ends
    matrix = np.asarray(volume.index_to_world, np.float64)
    world = corners @ matrix[:3, :3].T + matrix[:3, 3]
    return world.min(axis=0), world.max(axis=0)


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
