# SPDX-License-Identifier: GPL-3.0-or-later
"""An isosurface of an object's volume with the radiance that its bake gives it."""

from dataclasses import dataclass

import leaflight
import leaflight._core as _core

from ..store import cache
from . import added, preview

LeaflightError = leaflight.LeaflightError

# Colour attributes: what leaves the outer side of the surface, and the inner one where it is baked.
RADIANCE = "radiance"
RADIANCE_BACK = "radiance_back"

# Texels narrower than this, in voxels, have vertices of their own (RadianceGrid.contour()).
_NARROW = 0.75


@dataclass(frozen=True, eq=False)
class Isosurface:
    """What it takes to make one, in the object's coordinates.

    volume: a leaflight.Volume; grid: the radiance grid that lights it, or None.
    halvings: of the volume's fineness, None for the whole detail, which finer texels add to.
    """

    volume: object
    isovalue: float
    grid: object
    halvings: int = None

    def mesh(self):
        """(vertices, normals, triangles). Raises LeaflightError, in any thread."""
        if self._is_cut():
            return self.grid.contour(self.volume.field(), self.isovalue)
        return _core.contour(self._field(), self.isovalue)

    def radiance(self, points):
        """Baked radiance (n, 3) at points (n, 3), by the name of its attribute."""
        if self.grid is None:
            return {}
        field = self.volume.field()
        radiance = {RADIANCE: self.grid.lookup(field, points)}
        if self.grid.has_back:
            radiance[RADIANCE_BACK] = self.grid.lookup(field, points, back=True)
        return radiance

    def made(self):
        """(vertices, triangles, radiance by the name of its attribute), as mesh() does."""
        if not self._is_cut():
            vertices, _, triangles = _core.contour(self._field(), self.isovalue, normals=False)
            return vertices, triangles, self.radiance(vertices)
        vertices, _, triangles, *sides = self.grid.lit_contour(
            self.volume.field(), self.isovalue, back=self.grid.has_back
        )
        named = zip((RADIANCE, RADIANCE_BACK), sides)
        return vertices, triangles, {name: side for name, side in named if side is not None}

    def is_coarse(self):
        """Whether mesh() has less than the whole detail."""
        if self.halvings is None:
            return False
        refined = self.grid is not None and self.grid.levels > 1
        return self.halvings > 0 or self._cuts() > 0 or refined

    def triangles_between_nodes(self, count):
        """Of a mesh() with so many triangles: about how many the volume's own nodes give."""
        if self.halvings is not None:
            return count * 4**self.halvings
        return count // 4 ** self._cuts()

    def _is_cut(self):
        """Whether the mesh is as fine as the texels are."""
        return self.halvings is None and self.grid is not None

    def _field(self):
        volume = self.volume
        try:
            for _ in range(self.halvings or 0):
                volume = volume.coarser()
            return volume.field()
        except LeaflightError:
            # Too little of it is left.
            return self.volume.field()

    def _cuts(self):
        """How often mesh() cuts all edges in two."""
        if self.grid is None:
            return 0
        cuts, width = 0, (self.volume.values.shape[-1] - 1) / (self.grid.resolution[0] - 1)
        while width < _NARROW:
            cuts, width = cuts + 1, 2 * width
        return cuts


def isosurface_of(obj, isovalue, halvings=None):
    """An Isosurface, ready for mesh() in any thread. Raises LeaflightError.

    A bake that cannot be read lights nothing, and does not raise here (is_lit() does).
    """
    volume = volume_of(obj)
    low, high = volume.data_range()
    if not low < isovalue <= high:
        raise LeaflightError(
            f"Isovalue {isovalue:g} lies outside the data, whose values are {low:g} to {high:g}: "
            "choose one inside."
        )
    try:
        lit = is_lit(obj, isovalue)
    except LeaflightError:
        lit = False
    return Isosurface(volume, isovalue, _grid(obj) if lit else None, halvings)


def is_lit(obj, isovalue):
    """Whether the bake holds the radiance of this isosurface. Raises LeaflightError."""
    settings = added.volume_object(obj).leaflight
    bake, index = lit_by(obj)
    if bake is None:
        return False
    baked = bake.scene.leaves[index]
    # What a mirror or glass shows depends on where it is seen from.
    if baked.scattering != "diffuse" or baked.capped != settings.capped:
        return False
    low, high = (bake.isovalue_of(index, c) for c in bake.isovalues)
    rounding = 1e-6 * (high - low)
    return low - rounding <= isovalue <= high + rounding


def volume_of(obj):
    """The volume that is shown: that of a round in progress, or the object's own."""
    obj = added.volume_object(obj)
    shown = preview.of(obj)
    return cache.volume_of(obj) if shown is None else shown.volume


def lit_by(obj):
    """(bake, which of its volumes the object is): a round of one in progress, or the last one.

    The bake is None before the first. Raises LeaflightError.
    """
    obj = added.volume_object(obj)
    shown = preview.of(obj)
    if shown is not None:
        return shown.bake, shown.index
    return cache.bake_of(obj), obj.leaflight.bake_index


def _grid(obj):
    bake, index = lit_by(obj)
    return bake.grids[index]
