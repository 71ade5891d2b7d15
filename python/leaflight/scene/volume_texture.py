# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of isosurfaces: their color by the values of another volume at the point."""

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..color_maps import MAPS
from ..srgb import linear_from_srgb
from ..volume.volume import Volume
from ..volume.voxels import as_voxels

Color = tuple[float, float, float]
Stops = list[tuple[float, Color]]

# Width of the border between the colors of both signs, relative to the largest absolute value.
SIGN_WIDTH = 1e-3
# Largest label.
MOST_LABELS = 65535
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
) -> VolumeTexture:
    """Returns a VolumeTexture.

    channels: One Volume, or three for red, green and blue.
    colors: Key of color_maps.MAPS, or stops (value, color). None is VIRIDIS; for three channels it
        is black to white.
    value_range: Values (low, high) at the ends of the color map. None is the range of the data.
    nearest: As in VolumeTexture.
    Raises LeaflightError.
    """
    volumes = (channels,) if isinstance(channels, Volume) else tuple(channels)
    if isinstance(colors, list):
        return VolumeTexture(volumes, colors, nearest)
    if value_range is None:
        ranges = np.array([_range_of(volume) for volume in volumes])
        value_range = float(ranges[:, 0].min()), float(ranges[:, 1].max())
    low, high = value_range
    if not (low < high and np.isfinite(high - low)):
        raise LeaflightError(
            f"{volumes[0].name}: the range {low:g} to {high:g} of its colors is empty or infinite: "
            "give a lower and a higher value."
        )
    if colors is None and len(volumes) == 3:
        shares = RGB
    else:
        shares = color_map(colors or "VIRIDIS")
    return VolumeTexture(
        volumes, [(low + share * (high - low), color) for share, color in shares], nearest
    )


def sign_texture(volume: Volume, colors: str = "CET_D1") -> VolumeTexture:
    """Returns the texture that gives values below and above 0 the ends of a color map."""
    stops = color_map(colors)
    width = SIGN_WIDTH * max(map(abs, _range_of(volume)))
    return VolumeTexture((volume,), [(-width, stops[0][1]), (width, stops[-1][1])])


def label_texture(volume: Volume) -> VolumeTexture:
    """Returns the texture of labels. Raises LeaflightError.

    Each label extends to the next voxels without one, where isosurfaces of its boundary lie.
    """
    colors = label_colors(volume.values)
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


def label_colors(values: Array) -> Stops:
    """Returns stops for labels, in 0..65535: white for 0, and a separate color for each other.

    NaN is no label. Raises LeaflightError for other values.
    """
    values = np.nan_to_num(values)
    if not (values % 1 == 0).all():
        raise LeaflightError("The values are not labels, because they are not whole numbers.")
    if values.min() < 0 or values.max() > MOST_LABELS:
        raise LeaflightError(
            f"The labels {values.min():g} to {values.max():g} are outside 0 to {MOST_LABELS}."
        )
    labels = np.flatnonzero(np.bincount(values.ravel().astype(np.int64)))
    # Hues of the golden ratio, so that near numbers have different ones.
    return [
        (float(n), _linear(colorsys.hsv_to_rgb(n * 0.618034 % 1.0, 0.55 + 0.3 * (n % 2), 0.9)))
        if n
        else (0.0, (1.0, 1.0, 1.0))
        for n in labels.tolist()
    ]


def color_map(key: str) -> Stops:
    """Returns the stops (share in 0..1, linear color) of a color map. Raises LeaflightError."""
    if key not in MAPS:
        raise LeaflightError(f'There is no color map "{key}": choose one of {", ".join(MAPS)}.')
    colors = [_linear([byte / 255.0 for byte in bytes.fromhex(text)]) for text in MAPS[key][2]]
    return [(i / (len(colors) - 1), color) for i, color in enumerate(colors)]


def _linear(srgb: Sequence[float]) -> Color:
    return tuple(linear_from_srgb(np.array(srgb)).tolist())


def _range_of(volume: Volume) -> tuple[float, float]:
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
