# SPDX-License-Identifier: GPL-3.0-or-later
"""A scalar volume in memory."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from ..words import by, html_table
from .cuts import Cuts
from .distribution import Distribution
from .label_table import Label
from .memory import VOXEL_TYPES, as_voxels, new_voxels
from .setting_error import SettingError
from .smoothing import checked, smoothed
from .units import METERS, unit_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

T = TypeVar("T")

# Depth of the layer around a capped volume below the lowest value, in ranges of the data.
CAP_DEPTH = 2.0


class AxisAligned(TypedDict, total=False):
    spacing: ArrayLike | None
    origin: ArrayLike | None


class Given(AxisAligned, total=False):
    """The arguments of Volume that can only be given by name."""

    notes: Sequence[str]
    labels: Sequence[Label]
    cuts: Cuts | None


class _OfValues(cached_property[T]):
    """A cached_property of the values alone, which a volume has in common with placed() ones."""

    def __get__(self, volume: Any, owner: Any = None) -> Any:
        if volume is None or volume._elsewhere is None:
            return super().__get__(volume, owner)
        return getattr(volume._elsewhere, str(self.attrname))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Volume:
    """Samples of a scalar field at the nodes of a grid.

    values: Array (nz, ny, nx), x fastest, in data units. All VOXEL_TYPES give the same bake. NaN
        marks missing data. In flatland the shape is (ny, nx).
    index_to_world: Matrix from the node (i, j, k, 1) to world coordinates, float64 (4, 4). In
        flatland the shape is (3, 3).
    name: Short name for display.
    source: The file or the function that the values came from.
    unit: Unit of world coordinates, a key of METERS; "" if unknown.
    patient: True if world coordinates are those of a patient: towards right, front and up.
    smooth_normals: Standard deviation in voxels of a Gaussian on the values from which normals are
        computed; 0 is none. The isosurfaces do not change.
    notes: Sentences for the user about choices of the reader, such as a guessed type.
    labels: Names and colors of the labels in a label map, as far as its file has them.
    cuts: Capped cuts of the values, in index coordinates; or None. Values below the range of the
        data close isosurfaces there.

    Instead of index_to_world you can give spacing, the voxel size (one number or (x, y, z)), and
    origin, the position (x, y, z) of the first node. Their defaults are 1 and 0.
    """

    values: Array
    index_to_world: Array
    name: str
    source: str
    unit: str
    patient: bool
    smooth_normals: float
    notes: tuple[str, ...]
    labels: tuple[Label, ...]
    cuts: Cuts | None
    # The volume of which this one is placed(), and with which it shares its field.
    _elsewhere: "Volume | None" = field(init=False, default=None, repr=False, compare=False)

    def __init__(
        self,
        values: ArrayLike,
        index_to_world: Array | None = None,
        name: str = "volume",
        source: str = "",
        unit: str = "",
        patient: bool = False,
        smooth_normals: float = 0.0,
        **grid: "Unpack[Given]",
    ) -> None:
        if not isinstance(values, np.ndarray):
            values = np.asarray(values)
        notes, labels = tuple(grid.pop("notes", ())), tuple(grid.pop("labels", ()))
        cuts = grid.pop("cuts", None)
        axis_aligned = _axis_aligned(values.ndim, grid.get("spacing"), grid.get("origin"))
        if index_to_world is None:
            index_to_world = axis_aligned
        elif any(value is not None for value in grid.values()):
            raise SettingError(
                f"{name}: index_to_world and spacing or origin exclude each other: give one of "
                "them.",
                "spacing",
            )
        if unit and not unit_of(unit):
            raise SettingError(
                f"{name}: the unit {unit!r} is unknown: give one of {', '.join(METERS)}.", "unit"
            )
        fields = {"values": values, "index_to_world": index_to_world, "name": name}
        self.__dict__.update(fields, source=source, unit=unit_of(unit), patient=patient)
        self.__dict__.update(smooth_normals=checked(smooth_normals, "smooth_normals", name))
        self.__dict__.update(notes=notes, labels=labels, cuts=cuts)

    @cached_property
    def _field(self) -> _core.Field:
        if self._elsewhere:
            return self._placed(self._elsewhere._field)
        found = self._unsmoothed_field
        if self.smooth_normals > 0:
            found.shade_by(self._values_of_normals())
        return found

    def _values_of_normals(self) -> Array:
        smooth = smoothed(self.data(), self.smooth_normals, _core.Progress())
        if not self.layers:
            return smooth
        # Do not smooth the layer that capped() added.
        values = new_voxels(self.values.shape, np.float32)
        values[...] = self._unsmoothed_field.range[0]
        values[(slice(1, -1),) * values.ndim] = smooth
        return values

    @cached_property
    def _unsmoothed_field(self) -> _core.Field:
        """Returns the field; in flatland a Field2, which has the same methods."""
        if self._elsewhere:
            return self._placed(self._elsewhere._unsmoothed_field)
        kind: Any = _core.Field2 if np.ndim(self.values) == 2 else _core.Field
        with self._named_errors():
            found: _core.Field = kind(as_voxels(self.values), self._matrix())
        if self.cuts and self.cuts.cuts:
            found.cut_by(self.cuts.ramp(self.values.shape), self.cuts.high - self.cuts.low)
        return found

    def _placed(self, found: _core.Field) -> _core.Field:
        with self._named_errors():
            return found.placed(self._matrix())

    def _matrix(self) -> Array:
        return np.ascontiguousarray(self.index_to_world, dtype=np.float64)

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        try:
            yield
        except LeaflightError as error:
            raise LeaflightError(f"{self.source or self.name}: {error}") from None

    def placed(self, index_to_world: Array, **facts: Any) -> "Volume":
        """Returns the same values at another place. Both volumes share what their fields compute.

        facts: Other fields of a Volume to replace, except values, smooth_normals and cuts.
        """
        found = replace(self, index_to_world=index_to_world, **facts)
        found.__dict__.update(_elsewhere=self._elsewhere or self)
        return found

    def __repr__(self) -> str:
        return f"<Volume: {', '.join(f'{what} {text}' for what, text in self._facts())}>"

    def _repr_html_(self) -> str:
        return html_table("Volume", self._facts())

    def _facts(self) -> list[tuple[str, str]]:
        return [
            ("name", self.name),
            ("voxels", by(self.values.shape[::-1])),
            ("of", f"{by(self.spacing)} {self.unit or '(no unit)'}"),
            ("type", str(self.values.dtype)),
        ]

    def noted(self, *notes: str) -> "Volume":
        """Returns the same volume with more notes."""
        noted = copy(self)
        noted.__dict__.update(notes=(*self.notes, *notes))
        return noted

    @property
    def spacing(self) -> tuple[float, ...]:
        """The sizes (x, y, z) of a voxel, in the unit of the world."""
        axes = np.asarray(self.index_to_world, np.float64)[:-1, :-1]
        return tuple(np.linalg.norm(axes, axis=0).tolist())

    def field(self) -> _core.Field:
        """Returns the field of the core, which is made at the first call.

        Raises LeaflightError if no isosurface can exist: all values equal or NaN, infinite values,
            fewer than 2 nodes along an axis, a singular index_to_world.
        """
        return self._field

    def flat_field(self) -> _core.Field2:
        """Returns the field of an image in flatland."""
        field: object = self._field
        assert isinstance(field, _core.Field2)
        return field

    def capped(self) -> "Volume":
        """Returns the volume with one layer of voxels around it that closes every isosurface.

        The layer has one value below all others: low - 2 (high - low). Let h be the value of a
            voxel on the border. The cap of the isosurface c lies at (h - c) / (h - layer) of a
            voxel, at most 1/3. A deeper layer would make the caps flatter, but closer together than
            the samples of a texel. Caps of all isosurfaces share their texels, so baked light on a
            cap is a mean over the isovalue range. Data and voxels keep their values and positions.

        Voxels without data stay empty, and isosurfaces stay open next to them. A volume that is
        closed already is returned as it is: its border holds only its lowest value.
        """
        if self._closed:
            return self
        low, high = self._with_lowest(self.field().range)
        layer = low - CAP_DEPTH * (high - low)
        if layer < float(np.finfo(np.float32).min):
            raise LeaflightError(
                f"{self.source or self.name}: the values {low:g}..{high:g} are too large to be "
                "capped; scale them down."
            )
        values = as_voxels(self.values)
        kept = next(
            kept
            for kept in VOXEL_TYPES
            if np.can_cast(values.dtype, kept) and (kept is np.float32 or layer >= _least(kept))
        )
        padded = new_voxels([n + 2 for n in values.shape], kept)
        padded[0] = padded[-1] = layer
        for plane, inside in zip(padded[1:-1], values):
            plane[...] = np.pad(inside.astype(kept, copy=False), 1, constant_values=layer)
        values = padded
        index_to_world = np.array(self.index_to_world, dtype=np.float64)
        index_to_world[:-1, -1] -= index_to_world[:-1, :-1].sum(axis=1)
        capped = replace(self, values=values, index_to_world=index_to_world)
        return replace(capped, cuts=self._moved_cuts(np.ones(3)))

    def cropped(self, values: Array, first: Sequence[int]) -> "Volume":
        """Returns the volume with a part of its values.

        first: Index (x, y, z) of the first node of that part.
        """
        matrix = np.array(self.index_to_world, np.float64)
        matrix[:3, 3] += matrix[:3, :3] @ first
        cuts = self._moved_cuts(-np.asarray(first, np.float64))
        return replace(self, values=values, index_to_world=matrix, cuts=cuts)

    def _moved_cuts(self, offset: Array) -> Cuts | None:
        matrix = np.eye(4)
        matrix[:3, 3] = offset
        return self.cuts.moved(matrix) if self.cuts else None

    @_OfValues
    def _closed(self) -> bool:
        low, _ = self._unsmoothed_field.range
        return all(
            (self.values.take(end, axis=axis) == low).all()
            for axis in range(self.values.ndim)
            for end in (0, -1)
        )

    def in_unit(self, unit: str) -> "Volume":
        """Returns the volume in world coordinates of another unit; a volume without one gets it.

        unit: A key of METERS, or "", which changes nothing.
        """
        if not unit or unit == self.unit:
            return self
        scale = METERS[self.unit or unit] / METERS[unit]
        to_unit = np.diag([*[scale] * np.ndim(self.values), 1.0])
        return self.placed(to_unit @ self.index_to_world, unit=unit)

    def coarser(self) -> "Volume":
        """Returns the volume with n // 2 + 1 instead of n nodes along each axis, over the same
        domain.

        Each value is a mean over about two voxels along each axis, except on the border. The volume
        is made at the first call. It is for three dimensions only.
        """
        return self._coarser

    @cached_property
    def _coarser(self) -> "Volume":
        values = _core.coarser_values(self.field())
        steps = (np.array(self.values.shape) - 1) / (np.array(values.shape) - 1)
        from_coarser = np.diag([*steps[::-1], 1.0])
        return replace(
            self,
            values=values,
            index_to_world=self.index_to_world @ from_coarser,
            smooth_normals=0.5 * self.smooth_normals,
            cuts=self.cuts and replace(self.cuts, cuts=()),
        )

    @_OfValues
    def _within_layer(self) -> tuple[Array, tuple[float, float]] | None:
        """Returns the values within the layer of capped(), and their range; None without such a
        layer.
        """
        inside = self.values[(slice(1, -1),) * self.values.ndim]
        if not self._closed or not any(np.isfinite(plane).any() for plane in inside):
            return None
        low, high = float(np.nanmin(inside)), float(np.nanmax(inside))
        # Data never have a background that is a whole range below all other values.
        if not 0 < high - low < low - self._unsmoothed_field.range[0]:
            return None
        return inside, (low, high)

    @_OfValues
    def distribution(self) -> Distribution:
        """The Distribution of data()."""
        return Distribution(self.data(), self.data_range())

    @property
    def layers(self) -> int:
        """Number of layers of voxels that capped() added around data(): 1 or 0."""
        return 1 if self._within_layer else 0

    def data(self) -> Array:
        """Returns the values without the layer that capped() added, not as a copy."""
        return self._within_layer[0] if self._within_layer else self.values

    def data_range(self) -> tuple[float, float]:
        """Returns (lowest, highest) of data(), in data units, without values that close a cut."""
        return self._with_lowest(
            self._within_layer[1] if self._within_layer else self.field().range
        )

    def _with_lowest(self, found: tuple[float, float]) -> tuple[float, float]:
        return found if self.cuts is None else (self.cuts.low, found[1])


def _least(integer_type: DTypeLike) -> int:
    return int(np.iinfo(integer_type).min)


def _axis_aligned(
    axes: int, spacing: ArrayLike | None = None, origin: ArrayLike | None = None
) -> Array:
    """Returns the index_to_world of a voxel size and the position of the first node.

    Raises SettingError.
    """
    try:
        steps = np.broadcast_to(np.asarray(1.0 if spacing is None else spacing, np.float64), axes)
        place = np.broadcast_to(np.asarray(0.0 if origin is None else origin, np.float64), axes)
    except (TypeError, ValueError):
        steps, place = np.full(axes, np.nan), np.zeros(axes)
    if not (np.isfinite([steps, place]).all() and (steps > 0).all()):
        raise SettingError(
            f"The spacing {spacing!r} or the origin {origin!r} is invalid: give positive spacing "
            f"and any origin, {axes} numbers each, or one number for the spacing.",
            "spacing",
        )
    matrix = np.diag([*steps, 1.0])
    matrix[:-1, -1] = place
    return matrix


def bump_box(n: int = 100) -> Volume:
    """Returns the 3D bump box (thesis Eq. 2.1 and Table 2.1): n^3 nodes, values 0..255.

    The nodes lie on the unit cube.
    """
    return on_unit_cube(n, _core.bump_box, "bump_box", "bump_box")


def on_unit_cube(n: int, values: Callable[[int], Array], name: str, source: str) -> Volume:
    """Returns a generated Volume with n nodes per axis on the unit cube or square.

    values: Function from n to the array.
    """
    if n < 2:
        raise SettingError(
            f"{source}: the number of nodes per side is {n}: give at least 2.", "dims"
        )
    array = values(n)
    index_to_world = np.diag([1.0 / (n - 1)] * array.ndim + [1.0])
    return Volume(array, index_to_world, name, source)
