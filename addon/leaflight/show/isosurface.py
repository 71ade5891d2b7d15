# SPDX-License-Identifier: GPL-3.0-or-later
"""An isosurface of an object's volume, with the radiance of its bake."""

from dataclasses import dataclass

import numpy as np
from leaflight import LeaflightError
from leaflight.volume import meshes
from leaflight.volume.exploded import explode_offsets

from ..store import cache, source_files
from ..store.reading import StillReading
from . import changed_data, display, exploded, preview, texture

# Color attributes: radiance that leaves the front of the surface, and the back if it is baked.
RADIANCE = "radiance"
RADIANCE_BACK = "radiance_back"
# Color attribute: factor of a texture on the albedo.
TEXTURE = "texture"

# Key of the offsets that move parts apart by the distance 1 (exploded.py).
OFFSETS = "offsets"

# Approximate number of voxels for an estimate of the size of an isosurface.
_COUNTED = 1 << 20


@dataclass(frozen=True, eq=False)
class Isosurface:
    """The inputs of one isosurface, in the object's coordinates.

    volume: A leaflight.Volume.
    grid: The radiance grid that lights it, or None.
    largest_step: As in Bake.
    halvings: Number of times that the resolution is halved. None is the full detail, to which light
        adds vertices.
    dust: Length below which connected parts are left out.
    colors: A VolumeTexture, or None.
    explode: Axis (3,) along which parts are moved apart, or None.
    """

    volume: object
    isovalue: float
    grid: object
    largest_step: float
    halvings: int = None
    dust: float = 0.0
    colors: object = None
    explode: np.ndarray | None = None

    def mesh(self):
        """Returns (vertices, normals, triangles), in any thread. Raises LeaflightError."""
        if self.is_coarse() or self.grid is None:
            vertices, normals, triangles = meshes.contour(self._field(), self.isovalue)
        else:
            vertices, normals, triangles = self._lit_contour(normals=True)[:3]
        vertices, triangles, normals = self._without_dust(vertices, triangles, normals)
        return vertices, normals, triangles

    def radiance(self, points):
        """Returns {name of an attribute: baked radiance, or color (n, 3)} at points (n, 3)."""
        found = self.texture(points)
        if self.grid is None:
            return found
        field = self.volume.field()
        found[RADIANCE] = self.grid.lookup(field, points)
        if self.grid.has_back:
            found[RADIANCE_BACK] = self.grid.lookup(field, points, back=True)
        return found

    def texture(self, points):
        """Returns {TEXTURE: color (n, 3)} at points (n, 3), or nothing without a texture."""
        return {} if self.colors is None else {TEXTURE: self.colors.at(points)}

    def made(self):
        """Returns (vertices, triangles, {name of an attribute: radiance}, count).

        With `explode` the dictionary has OFFSETS, too.
        count: approximate number of triangles at the full resolution of the volume. Works in any
        thread. Raises LeaflightError.
        """
        if self.is_coarse() or self.grid is None:
            is_projected = bool(self.grid is not None and self.halvings)
            vertices, normals, triangles = meshes.contour(
                self._field(), self.isovalue, is_projected
            )
            count = len(triangles) * 4 ** (self.halvings or 0)
            vertices, triangles, normals = self._without_dust(vertices, triangles, normals)
            offsets = self._offsets(vertices, triangles)
            if is_projected:
                # Move vertices to the isosurface of the light, on the same side of a thin shell.
                field, reach = self.volume.field(), 2.0 * 2**self.halvings
                vertices = meshes.project_along(field, vertices, normals, self.isovalue, reach)
            return vertices, triangles, self.radiance(vertices) | offsets, count
        vertices, _, triangles, *sides, count = self._lit_contour()
        vertices, triangles, *sides = self._without_dust(vertices, triangles, *sides)
        named = zip((RADIANCE, RADIANCE_BACK), sides)
        radiance = {name: side for name, side in named if side is not None}
        radiance |= self.texture(vertices) | self._offsets(vertices, triangles)
        return vertices, triangles, radiance, count

    def _offsets(self, vertices, triangles):
        if self.explode is None:
            return {}
        found = explode_offsets(self._volume(), self.isovalue, vertices, triangles, self.explode)
        return {OFFSETS: found}

    def is_coarse(self):
        """True if mesh() has less than the full detail."""
        return self.halvings is not None and (self.halvings > 0 or self.grid is not None)

    def _without_dust(self, vertices, triangles, *of_vertices):
        """Returns the arguments without small parts.

        of_vertices: arrays with a row per vertex, or None.
        """
        if self.dust <= 0:
            return vertices, triangles, *of_vertices
        kept, triangles = meshes.large_parts(vertices, triangles, self.dust)
        rest = (None if rows is None else rows[kept] for rows in of_vertices)
        return vertices[kept], triangles, *rest

    def _lit_contour(self, normals=False):
        return self.grid.lit_contour(
            self.volume.field(),
            self.isovalue,
            normals,
            back=self.grid.has_back,
            largest_step=self.largest_step,
        )

    def _field(self):
        return self._volume().field()

    def _volume(self):
        if not self.is_coarse():
            return self.volume
        volume = self.volume
        try:
            for _ in range(self.halvings or 0):
                volume = volume.coarser()
            volume.field()
            return volume
        except LeaflightError:
            # The coarser volume has no contrast left, so use the full one.
            return self.volume


def isosurface_of(obj, isovalue, halvings=None):
    """Returns an Isosurface, ready for mesh() in any thread. Raises LeaflightError, StillReading.

    An unreadable bake gives an unlit Isosurface and no error here. is_lit() raises it.
    """
    volume = volume_of(obj)
    low, high = volume.data_range()
    if not low < isovalue <= high:
        raise LeaflightError(
            f"Isovalue {isovalue:g} is outside the data, {low:g} to {high:g}: choose one inside."
        )
    try:
        lit = is_lit(obj, isovalue)
    except StillReading:
        raise
    except LeaflightError:
        lit = False
    shape = halvings, obj.leaflight_look.dust * _voxel_size(volume)
    looks = texture.local_texture(display.volume_object(obj)), exploded.axis_of(obj)
    if not lit:
        return Isosurface(volume, isovalue, None, np.inf, *shape, *looks)
    bake, index = lit_by(obj)
    # The texture may have changed since the bake, or be gone.
    shown = None if looks[0] is None else looks[0].core().on(volume.field())
    grid = bake.grids[index].with_texture(shown)
    return Isosurface(volume, isovalue, grid, bake.largest_step, *shape, *looks)


def estimate_triangles(volume, isovalue):
    """Returns the approximate number of triangles that an isosurface has between voxels.

    Vertices lie on the steps between voxels that cross the isosurface, counted in some planes.
    """
    planes = volume.values[:: 1 + volume.values.size // _COUNTED]
    is_above = planes >= isovalue
    crossed = sum(np.count_nonzero(np.diff(is_above, axis=axis)) for axis in (1, 2))
    # Assume two triangles per vertex, and as many steps along the third axis as along the others.
    return int(2 * 1.5 * crossed * len(volume.values) / len(planes))


def _voxel_size(volume):
    """Returns the side of a cube with the size of a voxel."""
    return float(np.cbrt(abs(np.linalg.det(volume.index_to_world[:3, :3]))))


def is_lit(obj, isovalue):
    """True if the bake holds the radiance of this isosurface. Raises LeaflightError."""
    settings = display.volume_object(obj).leaflight
    bake, index = lit_by(obj)
    if bake is None:
        return False
    baked = bake.scene.isosurfaces[index]
    # The radiance of a mirror or glass depends on the view, so no bake holds it.
    if baked.scattering != "diffuse" or baked.capped != settings.capped:
        return False
    # A bake in progress has the present values, and changed_data.py estimates light on cuts.
    if preview.of(display.volume_object(obj)) is None and source_files.values_changed(settings):
        if not source_files.regions_alone_changed(settings):
            return False
    low, high = (bake.isovalue_of(index, c) for c in bake.isovalues)
    rounding = 1e-6 * (high - low)
    return low - rounding <= isovalue <= high + rounding


def volume_of(obj):
    """Returns the volume that is shown: that of a pass in progress, or the object's own."""
    obj = display.volume_object(obj)
    shown = preview.of(obj)
    return cache.volume_of(obj) if shown is None else shown.volume


def lit_by(obj):
    """Returns (bake, index of the object's volume in it): the pass in progress or the last bake.

    The bake is None before the first, and may still lack its walls. Raises LeaflightError.
    """
    obj = display.volume_object(obj)
    shown = preview.of(obj)
    if shown is not None:
        return shown.bake, shown.index
    return changed_data.light_of(obj), obj.leaflight.bake_index
