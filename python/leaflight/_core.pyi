"""
Leaflight's compiled core. Arrays are indexed [z, y, x]; points are (x, y, z).
"""
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import os
import pathlib
import typing
__all__: list[str] = ['AreaLight', 'AreaLight2', 'BakeSettings', 'BakeSettings2', 'BakeStatistics', 'Baked', 'Baked2', 'Cancelled', 'DirectLight', 'Environment', 'Environment2', 'Field', 'Field2', 'IndirectShares', 'LeaflightError', 'Mesh', 'Mesh2', 'PartTracer', 'PointLight', 'PointLight2', 'PolygonEdges', 'Progress', 'RadianceGrid', 'RadianceGrid2', 'ReplacedFiles', 'Scene', 'Scene2', 'SunLight', 'SunLight2', 'Texture', 'Volume', 'Volume2', 'VolumeTexture', 'WallRadiance', 'WallRadiance2', 'attach_walls', 'bake', 'bake2', 'bump_box', 'bump_box2', 'coarser_values', 'components', 'connected_parts', 'contour', 'contour2', 'fitting_resolution', 'has_seal', 'isosurface_hits', 'large_array', 'large_memory', 'large_parts', 'libraries', 'light_memory', 'limit_large_memory', 'machine_memory', 'map_resolution', 'mesh_hits', 'noise_to_reach', 'normals', 'part_tracer_memory', 'photon_balance', 'photon_balance2', 'photon_points', 'photon_points2', 'project_along', 'project_to_isosurface', 'read_bake', 'read_bake_header', 'read_checkpoint', 'read_exr', 'read_exr_comments', 'read_vdb_volume', 'reference', 'reference2', 'reference_walls', 'reference_walls2', 'seen_from_outside', 'skipped_passes', 'skipped_passes2', 'trace', 'write_bake', 'write_exr']
class LeaflightError(Exception):
    pass
class Cancelled(Exception):
    pass
class Progress:
    """
    The progress of work such as a bake or the reading of a file, shared with observers
    in other threads.
    """
    def __init__(self) -> None:
        ...
    def advance(self, work: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Adds finished work, in the unit of expect().
        """
    def begin(self, stage: str) -> None:
        """
        Sets the name of the current stage.
        """
    def cancel(self) -> None:
        """
        Makes the bake raise Cancelled within half a second.
        """
    def check(self) -> None:
        """
        Raises Cancelled after cancel().
        """
    def expect(self, total: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Sets the total work, in any unit.
        """
    def stop(self) -> None:
        """
        Makes a bake in passes end after the current pass, with its light.
        """
    @property
    def cancelled(self) -> bool:
        ...
    @property
    def fraction(self) -> float:
        """
        Finished share of the work, 0..1.
        """
    @property
    def stage(self) -> str:
        """
        Name of the current stage, for the user.
        """
    @property
    def stopped(self) -> bool:
        ...
class Field:
    """
    A scalar volume with its transform to the world, checked and prepared for ray
    tracing.
    """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.float32], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.uint8], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.int16], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.uint16], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    def cut_by(self, ramp: numpy.typing.NDArray[numpy.float32], step: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Makes normals and meshes flat at cuts. ramp: float32 [z, y, x], linear in the
        distance from the cut, at least the values of the field. step: Its difference a
        voxel. Call it before the field is part of a scene.
        """
    def placed(self, index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> Field:
        """
        Returns the field at another place. Both share their values and what was computed
        from them. Raises LeaflightError for a transform that cannot be inverted.
        """
    def sample(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns interpolated values (n,) at world points (n, D); NaN outside and in masked
        cells.
        """
    def shade_by(self, values: numpy.typing.NDArray[numpy.float32]) -> None:
        """
        Uses other values, float32 [z, y, x], for the normals of isosurfaces, such as
        smoothed ones. They must be NaN at the same voxels. Call it before the field is part
        of a scene.
        """
    @property
    def bounds(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        World box of the voxels, (2, D).
        """
    @property
    def dims(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Voxels along x, y, z.
        """
    @property
    def index_to_world(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @property
    def is_cut(self) -> bool:
        """
        True after cut_by().
        """
    @property
    def masked(self) -> bool:
        """
        True if some voxels are NaN.
        """
    @property
    def range(self) -> tuple[float, float]:
        """
        Least and greatest value, in data units.
        """
    @property
    def values(self) -> numpy.ndarray:
        ...
class Field2:
    """
    A scalar field in 2D.
    """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.float32], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.uint8], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.int16], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    @typing.overload
    def __init__(self, values: numpy.typing.NDArray[numpy.uint16], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;
        NaN marks missing data.
        index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.
        In the plane [y, x] and 3 x 3.
        Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels
        along an axis, or a transform that cannot be inverted.
        """
    def cut_by(self, ramp: numpy.typing.NDArray[numpy.float32], step: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Makes normals and meshes flat at cuts. ramp: float32 [z, y, x], linear in the
        distance from the cut, at least the values of the field. step: Its difference a
        voxel. Call it before the field is part of a scene.
        """
    def placed(self, index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> Field2:
        """
        Returns the field at another place. Both share their values and what was computed
        from them. Raises LeaflightError for a transform that cannot be inverted.
        """
    def sample(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns interpolated values (n,) at world points (n, D); NaN outside and in masked
        cells.
        """
    def shade_by(self, values: numpy.typing.NDArray[numpy.float32]) -> None:
        """
        Uses other values, float32 [z, y, x], for the normals of isosurfaces, such as
        smoothed ones. They must be NaN at the same voxels. Call it before the field is part
        of a scene.
        """
    @property
    def bounds(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        World box of the voxels, (2, D).
        """
    @property
    def dims(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        """
        Voxels along x, y, z.
        """
    @property
    def index_to_world(self) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @property
    def is_cut(self) -> bool:
        """
        True after cut_by().
        """
    @property
    def masked(self) -> bool:
        """
        True if some voxels are NaN.
        """
    @property
    def range(self) -> tuple[float, float]:
        """
        Least and greatest value, in data units.
        """
    @property
    def values(self) -> numpy.ndarray:
        ...
class Texture:
    """
    An image over (u, v).
    """
    def __init__(self, pixels: typing.Annotated[numpy.typing.ArrayLike, numpy.float32]) -> None:
        """
        pixels: float32 [row, column, RGB], linear, bottom row first.
        """
class VolumeTexture:
    """
    Colors over the domain of a volume.
    """
    def __init__(self, channels: collections.abc.Sequence[numpy.ndarray], index_to_world: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], colors: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]], nearest: bool = False) -> None:
        """
        channels: one array [z, y, x], C-contiguous, kept by reference, or three of one shape
        for red, green and blue; float32, uint8, int16 or uint16. index_to_world: 4 x 4.
        colors: [(value, linear RGB in 0..1), ...] in ascending values; each of three channels
        takes its component. nearest: takes the value of the nearest voxel, as for labels.
        It is white where there is no value.
        """
    def at(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the colors, float32 (n, 3), at world points (n, 3).
        """
    def on(self, field: Field) -> VolumeTexture:
        """
        Returns the texture over index positions of a field, for RadianceGrid.with_texture.
        """
class AreaLight:
    """
    A rectangle, or the ellipse in it, that emits towards edge_u x edge_v. It neither
    blocks nor reflects light.
    """
    def __init__(self, name: str, corner: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], edge_u: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], edge_v: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], radiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], ellipse: bool = False) -> None:
        """
        Positions: world; radiance: linear RGB, W/(m^2 sr).
        """
    @property
    def name(self) -> str:
        ...
class PointLight:
    """
    A sphere that emits equally in all directions, or within a cone.
    """
    def __init__(self, name: str, position: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], radius: typing.SupportsFloat | typing.SupportsIndex, intensity: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], axis: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"] | None = None, angle: typing.SupportsFloat | typing.SupportsIndex = 0.0, blend: typing.SupportsFloat | typing.SupportsIndex = 0.0, cosine_falloff: bool = False) -> None:
        """
        position: world; intensity: linear RGB, W/sr; axis: unit, of a spot's cone; angle: its
        opening in radians; blend: the soft part of the cone, 0..1.
        """
    @property
    def name(self) -> str:
        ...
class SunLight:
    """
    Parallel light.
    """
    def __init__(self, name: str, direction: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], irradiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], angle: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> None:
        """
        direction: unit, in which light travels; irradiance: linear RGB, W/m^2 on a surface that
        faces it; angle: diameter of its disc in radians.
        """
    @property
    def name(self) -> str:
        ...
class Environment:
    """
    The environment light.
    """
    def __init__(self, name: str, radiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], image: Texture = None, world_to_image: typing.Annotated[collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], "FixedSize(3)"] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) -> None:
        """
        radiance: linear RGB, W/(m^2 sr), multiplies the image, a latitude-longitude
        Texture; world_to_image: 3 x 3.
        """
    @property
    def name(self) -> str:
        ...
class Mesh:
    """
    A mesh of the walls, with the same material on both sides.
    """
    def __init__(self, name: str, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], albedo: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], scattering: str = 'diffuse', ior: typing.SupportsFloat | typing.SupportsIndex = 1.5, emission: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"] = [0.0, 0.0, 0.0], texture: Texture | None = None, uv: typing.Annotated[numpy.typing.ArrayLike, numpy.float32] | None = None) -> None:
        """
        vertices: (n, D) world; triangles or segments: (m, D) indices; albedo: linear RGB in
        0..1; scattering: diffuse, mirror or glass; emission: linear RGB, W/(m^2 sr); texture:
        Texture that multiplies the albedo; uv: (m, D, 2), per corner.
        """
    @property
    def name(self) -> str:
        ...
class Volume:
    """
    A field and the material of its isosurfaces.
    """
    def __init__(self, name: str, field: Field, albedo: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]], emission: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]] = [(0.0, [0.0, 0.0, 0.0])], scattering: str = 'diffuse', ior: typing.SupportsFloat | typing.SupportsIndex = 1.5, offset: typing.SupportsFloat | typing.SupportsIndex = 0.0, scale: typing.SupportsFloat | typing.SupportsIndex = 1.0) -> None:
        """
        albedo, emission: [(common isovalue, linear RGB), ...] in ascending order; the isosurface
        coordinate c shows the isovalue offset + scale c.
        """
    def set_texture(self, texture: VolumeTexture) -> None:
        """
        Sets the VolumeTexture that multiplies the albedo.
        """
    @property
    def name(self) -> str:
        ...
class Scene:
    """
    Volumes, the objects around them, and the range of common isovalues to light.
    """
    def __init__(self, volumes: collections.abc.Sequence[Volume], meshes: collections.abc.Sequence[Mesh], lights: collections.abc.Sequence[AreaLight | PointLight | SunLight], isovalues: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex], environment: Environment | None = None) -> None:
        """
        isovalues: (low, high) of the common isovalue. Raises LeaflightError with the name
        of the invalid object.
        """
class AreaLight2:
    """
    A segment that emits to the left of its edge. It neither blocks nor reflects light.
    """
    def __init__(self, name: str, corner: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], edge: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], radiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        """
        Positions: world; radiance: linear RGB, W/(m^2 sr).
        """
    @property
    def name(self) -> str:
        ...
class PointLight2:
    """
    A sphere that emits equally in all directions, or within a cone.
    """
    def __init__(self, name: str, position: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], radius: typing.SupportsFloat | typing.SupportsIndex, intensity: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], axis: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"] | None = None, angle: typing.SupportsFloat | typing.SupportsIndex = 0.0, blend: typing.SupportsFloat | typing.SupportsIndex = 0.0, cosine_falloff: bool = False) -> None:
        """
        position: world; intensity: linear RGB, W/sr; axis: unit, of a spot's cone; angle: its
        opening in radians; blend: the soft part of the cone, 0..1.
        """
    @property
    def name(self) -> str:
        ...
class SunLight2:
    """
    Parallel light.
    """
    def __init__(self, name: str, direction: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], irradiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], angle: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> None:
        """
        direction: unit, in which light travels; irradiance: linear RGB, W/m^2 on a surface that
        faces it; angle: diameter of its disc in radians.
        """
    @property
    def name(self) -> str:
        ...
class Environment2:
    """
    The environment light.
    """
    def __init__(self, name: str, radiance: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        """
        radiance: linear RGB, W/(m rad).
        """
    @property
    def name(self) -> str:
        ...
class Mesh2:
    """
    A mesh of the walls, with the same material on both sides.
    """
    def __init__(self, name: str, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], segments: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], albedo: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], scattering: str = 'diffuse', ior: typing.SupportsFloat | typing.SupportsIndex = 1.5, emission: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"] = [0.0, 0.0, 0.0], texture: Texture | None = None, uv: typing.Annotated[numpy.typing.ArrayLike, numpy.float32] | None = None) -> None:
        """
        vertices: (n, D) world; triangles or segments: (m, D) indices; albedo: linear RGB in
        0..1; scattering: diffuse, mirror or glass; emission: linear RGB, W/(m^2 sr); texture:
        Texture that multiplies the albedo; uv: (m, D, 2), per corner.
        """
    @property
    def name(self) -> str:
        ...
class Volume2:
    """
    A field and the material of its isosurfaces.
    """
    def __init__(self, name: str, field: Field2, albedo: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]], emission: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]] = [(0.0, [0.0, 0.0, 0.0])], scattering: str = 'diffuse', ior: typing.SupportsFloat | typing.SupportsIndex = 1.5, offset: typing.SupportsFloat | typing.SupportsIndex = 0.0, scale: typing.SupportsFloat | typing.SupportsIndex = 1.0) -> None:
        """
        albedo, emission: [(common isovalue, linear RGB), ...] in ascending order; the isosurface
        coordinate c shows the isovalue offset + scale c.
        """
    @property
    def name(self) -> str:
        ...
class Scene2:
    """
    Volumes, the objects around them, and the range of common isovalues to light.
    """
    def __init__(self, volumes: collections.abc.Sequence[Volume2], meshes: collections.abc.Sequence[Mesh2], lights: collections.abc.Sequence[AreaLight2 | PointLight2 | SunLight2], isovalues: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex], environment: Environment2 | None = None) -> None:
        """
        isovalues: (low, high) of the common isovalue. Raises LeaflightError with the name
        of the invalid object.
        """
class DirectLight:
    """
    Direct light of every isosurface of one volume, from visibility maps. For each texel
    of a lattice and each light point they hold the greatest value between the two, as a
    byte.
    """
    def __init__(self, scene: Scene, volume: typing.SupportsInt | typing.SupportsIndex, resolution: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"], back: bool, progress: Progress, spacing: typing.SupportsFloat | typing.SupportsIndex = 1.0, earlier: DirectLight = None) -> None:
        """
        Computes the maps of a scene's volume. resolution: texels of the maps along x, y, z;
        back: includes the backs; spacing: upper bound on the voxels between the lines that
        find shadows; earlier: direct light of the same scene under other lights, whose maps
        are reused for points that have not moved. Raises Cancelled.
        """
    def codes(self, point: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.uint8]:
        """
        Returns the codes of the active texels for a light point, uint8 (n,), in the order
        of mask(). An isosurface h is lit at a texel if its own code is greater: 1 + 252 (h
        - lo) / (hi - lo) within code_range (lo, hi). 255 is behind a mesh. back: codes of
        backs, which begin at hi.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    @property
    def code_range(self) -> tuple[float, float]:
        """
        (lo, hi): the values that codes can distinguish, slightly more than the isovalue
        range.
        """
    @property
    def has_back(self) -> bool:
        """
        True if backs have maps.
        """
    @property
    def index_to_frame(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        float64 (4, 4): from indices to the frame, which is the world, moved and scaled
        uniformly.
        """
    @property
    def light_points(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        float64 (n, 4, 4), four rows for each point. Row 0: position in the frame and 1, or
        direction to a light at infinity and 0. Row 1: normal and 1, or 2 if it emits on
        both sides, or 0 if it has none. Row 2: linear RGB irradiance [W/m^2] of a surface
        that faces it at distance 1 in the frame, and width of the soft edge of its cone, in
        cosines. Row 3: axis of the cone, and cosine at its end or -2 without a cone.
        """
    @property
    def lights(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        int32 (n,): number of each point's light in the scene, or -1.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Texels along x, y, z, evenly spaced from the first voxel to the last.
        """
class IndirectShares:
    """
    The share of each light of a scene in the indirect light.
    """
    def __init__(self, scene: Scene) -> None:
        ...
    def factor(self, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]) -> tuple[float, float, float]:
        """
        Returns the growth of indirect light, (r, g, b), if each light of the scene is
        scaled by factors (r, g, b).
        """
    @property
    def total(self) -> tuple[float, float, float]:
        """
        Sum of all shares, (r, g, b).
        """
class RadianceGrid:
    """
    The radiance [W/(m^2 sr)] of every isosurface of one volume within an isovalue range.
    """
    def add_direct(self, field: Field, direct: DirectLight) -> None:
        """
        Gives a grid from a file the DirectLight that its bake had, and the lit field.
        """
    def atlas(self, back: bool = False) -> tuple:
        """
        Returns (pixels float32 [row, column, RGBA] bottom row first, columns, rows). Slice
        k is the tile in column k % columns and row k // columns, without padding.
        """
    def dense(self, name: str, layer: typing.SupportsInt | typing.SupportsIndex = -1) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the grid of this name. radiance, radiance_indirect (without the lights'
        direct light), radiance_back and radiance_back_indirect: float32 [z, y, x, 3].
        radiance_error, the standard error of the mean over the channels: float32 [z, y, x].
        Inactive texels are zero. layer: one of cap_layers, which only texels on a cap have.
        """
    def estimated(self, before: Field, now: Field, resolution: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"], isovalues: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], direct: bool) -> RadianceGrid:
        """
        Returns a grid without visibility maps for changed values of the volume. Near
        changes it has the mean light of the isosurfaces that lights reach, by their
        normals. before, now: the baked and the changed field, at one place. resolution:
        that of the result. isovalues: the baked range, in values of the field. direct:
        False leaves out direct light, which is faster; moved() adds it.
        """
    def lit_contour(self, field: Field, isovalue: typing.SupportsFloat | typing.SupportsIndex, normals: bool = False, front: bool = True, back: bool = False, largest_step: typing.SupportsFloat | typing.SupportsIndex = ...) -> tuple:
        """
        Returns (vertices, normals, triangles, radiance, radiance of the back, number of
        triangles before edges were split): contour(), and lookup() at its vertices. Arrays
        are float32 (n, 3) and int32 (m, 3), or None if not requested. Edges are split as
        often as texels are narrower than voxels, so that vertices show them. Small meshes
        also split edges whose ends differ by more than largest_step in radiance, at most
        twice. It is fastest if all arrays of the previous call are released.
        """
    def lookup(self, field: Field, points: typing.Any, back: bool = False, indirect: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the radiance (n, 3) of the isosurfaces through world points (n, D);
        indirect: only the part in radiance_indirect.
        """
    def lookup_error(self, field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the standard error (n,) of the front's radiance at world points (n, D),
        averaged over the channels, for independent errors of texels.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    def moved(self, field: Field, direct: DirectLight, indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid:
        """
        Returns the grid with the direct light of another scene. Other light, except
        emission, is scaled by (r, g, b). field: the volume at its current position. Shares
        the texels.
        """
    def relit(self, field: Field, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid:
        """
        Returns the grid of the lit field with other strengths of the scene's lights:
        factors (r, g, b) for each, relative to the bake. `indirect`: factor on other light,
        except emission. Shares the texels. Requires can_be_relit.
        """
    def some_texels(self, most: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Returns the front's (radiance float32 (n, 3), radiance_error (n,)) of at most `most`
        active texels, evenly spread over all.
        """
    def stored_direct(self, scene: Scene, volume: typing.SupportsInt | typing.SupportsIndex) -> DirectLight:
        """
        Takes the maps of the scene's volume from a grid of read_bake(), and returns its
        DirectLight. Raises LeaflightError.
        """
    def with_texture(self, texture: VolumeTexture | None) -> RadianceGrid:
        """
        Returns the grid with another texture, VolumeTexture.on() its field, by which lookups
        multiply the light; None: no texture. A grid from a file has none. Shares the texels.
        """
    @property
    def can_be_relit(self) -> bool:
        """
        True if the direct light of all sides is exact.
        """
    @property
    def cap_layers(self) -> typing.Any:
        """
        (number, value in the middle of the first, step) of the layers of isovalues that texels
        on the cap of a cut have; None without such texels.
        """
    @property
    def direct(self) -> DirectLight:
        """
        DirectLight that lookups add; None: texels contain all light. A bake in passes has
        it.
        """
    @property
    def has_back(self) -> bool:
        """
        True if the back was baked.
        """
    @property
    def map_resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"] | None:
        """
        Resolution of the visibility maps from which lookups compute direct light; None:
        texels contain all light.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        ...
    @property
    def texels(self) -> int:
        """
        Number of active texels.
        """
class RadianceGrid2:
    """
    The radiance [W/(m^2 sr)] of every isosurface of one volume within an isovalue range.
    """
    def dense(self, name: str, layer: typing.SupportsInt | typing.SupportsIndex = -1) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the grid of this name. radiance, radiance_indirect (without the lights'
        direct light), radiance_back and radiance_back_indirect: float32 [z, y, x, 3].
        radiance_error, the standard error of the mean over the channels: float32 [z, y, x].
        Inactive texels are zero. layer: one of cap_layers, which only texels on a cap have.
        """
    def lookup(self, field: Field2, points: typing.Any, back: bool = False, indirect: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the radiance (n, 3) of the isosurfaces through world points (n, D);
        indirect: only the part in radiance_indirect.
        """
    def lookup_error(self, field: Field2, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the standard error (n,) of the front's radiance at world points (n, D),
        averaged over the channels, for independent errors of texels.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    def relit(self, field: Field2, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid2:
        """
        Returns the grid of the lit field with other strengths of the scene's lights:
        factors (r, g, b) for each, relative to the bake. `indirect`: factor on other light,
        except emission. Shares the texels. Requires can_be_relit.
        """
    def some_texels(self, most: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Returns the front's (radiance float32 (n, 3), radiance_error (n,)) of at most `most`
        active texels, evenly spread over all.
        """
    @property
    def can_be_relit(self) -> bool:
        """
        True if the direct light of all sides is exact.
        """
    @property
    def cap_layers(self) -> typing.Any:
        """
        (number, value in the middle of the first, step) of the layers of isovalues that texels
        on the cap of a cut have; None without such texels.
        """
    @property
    def has_back(self) -> bool:
        """
        True if the back was baked.
        """
    @property
    def map_resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"] | None:
        """
        Resolution of the visibility maps from which lookups compute direct light; None:
        texels contain all light.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        ...
    @property
    def texels(self) -> int:
        """
        Number of active texels.
        """
class WallRadiance:
    """
    The radiance of the walls over the common isovalue, at the vertices of fine meshes.
    """
    def between(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.uint32]:
        """
        Returns uint32 (n, 2): for each vertex, the two vertices of the coarse mesh that it
        lies halfway between.
        """
    def direct_ways(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Returns the shadow rays of a fine mesh, as five arrays. Each vertex has one of
        several sets of light points: its number, uint8 (n,). For each point, isosurfaces
        between the least and the greatest common isovalue block the ray, float32 (n,
        points) each; the least is None if isosurfaces are closed, and the greatest is
        infinite behind a mesh. Then the unshadowed irradiance over the amount of the point,
        negative on the back, float32 (n, points). Then, for front and back, the unshadowed
        radiance by all sets, float32 (lights + 1, n, 3), by each light of the scene and by
        all other emitters. A side reflects their sum times the share of light that no
        isosurface blocks, averaged over each vertex and its neighbors.
        """
    def indirect(self, mesh: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the radiance without direct light: float32 (nodes, m, 3) at the vertices of
        the coarse mesh.
        """
    def mesh(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
        """
        Returns (vertices float32 (n, D) world, facets int32 (m, D)).
        """
    def moved(self, earlier: Scene, scene: Scene, same_as: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], progress: Progress, share: typing.SupportsInt | typing.SupportsIndex = 1, lights_alone: bool = False) -> WallRadiance:
        """
        Returns the walls of another scene than the baked one, `earlier`. Direct light is
        exact. Other light, except the meshes' own emission, is scaled by (r, g, b).
        same_as: number of each mesh in the earlier scene, or -1. share: one of this many
        shadow rays is traced; lights_alone: true if only lights have moved, which is
        faster. Raises Cancelled.
        """
    def places(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]]:
        """
        Returns the positions at which vertices are lit: (facets int32 (n,) of the original
        mesh, barycentric coordinates (n, 2)), for reference_walls().
        """
    def radiance(self, mesh: typing.SupportsInt | typing.SupportsIndex, c: typing.SupportsFloat | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns float32 (n, 3) at the vertices of a fine mesh, seen from the side of its
        normals or from behind.
        """
    def relit(self, scene: Scene, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> WallRadiance:
        """
        Returns the walls with other strengths of the scene's lights, as in
        RadianceGrid.relit().
        """
    @property
    def count(self) -> int:
        """
        Number of meshes.
        """
    @property
    def nodes(self) -> list[float]:
        """
        The common isovalues, ascending, between which indirect light is linear.
        """
    @property
    def point_amounts(self) -> numpy.typing.NDArray[numpy.float32]:
        """
        float32 (sets, points, 3): linear RGB of the light points.
        """
    @property
    def point_lights(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        int32 (points,): for each point of a set, the number of its light in the scene, or
        -1.
        """
class WallRadiance2:
    """
    The radiance of the walls over the common isovalue, at the vertices of fine meshes.
    """
    def between(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.uint32]:
        """
        Returns uint32 (n, 2): for each vertex, the two vertices of the coarse mesh that it
        lies halfway between.
        """
    def direct_ways(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Returns the shadow rays of a fine mesh, as five arrays. Each vertex has one of
        several sets of light points: its number, uint8 (n,). For each point, isosurfaces
        between the least and the greatest common isovalue block the ray, float32 (n,
        points) each; the least is None if isosurfaces are closed, and the greatest is
        infinite behind a mesh. Then the unshadowed irradiance over the amount of the point,
        negative on the back, float32 (n, points). Then, for front and back, the unshadowed
        radiance by all sets, float32 (lights + 1, n, 3), by each light of the scene and by
        all other emitters. A side reflects their sum times the share of light that no
        isosurface blocks, averaged over each vertex and its neighbors.
        """
    def indirect(self, mesh: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns the radiance without direct light: float32 (nodes, m, 3) at the vertices of
        the coarse mesh.
        """
    def mesh(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
        """
        Returns (vertices float32 (n, D) world, facets int32 (m, D)).
        """
    def moved(self, earlier: Scene2, scene: Scene2, same_as: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], progress: Progress, share: typing.SupportsInt | typing.SupportsIndex = 1, lights_alone: bool = False) -> WallRadiance2:
        """
        Returns the walls of another scene than the baked one, `earlier`. Direct light is
        exact. Other light, except the meshes' own emission, is scaled by (r, g, b).
        same_as: number of each mesh in the earlier scene, or -1. share: one of this many
        shadow rays is traced; lights_alone: true if only lights have moved, which is
        faster. Raises Cancelled.
        """
    def places(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]]:
        """
        Returns the positions at which vertices are lit: (facets int32 (n,) of the original
        mesh, barycentric coordinates (n, 2)), for reference_walls().
        """
    def radiance(self, mesh: typing.SupportsInt | typing.SupportsIndex, c: typing.SupportsFloat | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Returns float32 (n, 3) at the vertices of a fine mesh, seen from the side of its
        normals or from behind.
        """
    def relit(self, scene: Scene2, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> WallRadiance2:
        """
        Returns the walls with other strengths of the scene's lights, as in
        RadianceGrid.relit().
        """
    @property
    def count(self) -> int:
        """
        Number of meshes.
        """
    @property
    def nodes(self) -> list[float]:
        """
        The common isovalues, ascending, between which indirect light is linear.
        """
    @property
    def point_amounts(self) -> numpy.typing.NDArray[numpy.float32]:
        """
        float32 (sets, points, 3): linear RGB of the light points.
        """
    @property
    def point_lights(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        int32 (points,): for each point of a set, the number of its light in the scene, or
        -1.
        """
class BakeStatistics:
    """
    The cost of a bake and its estimated error.
    """
    @property
    def blocks(self) -> int:
        """
        Number of averaged blocks of indirect light.
        """
    @property
    def continued(self) -> bool:
        """
        True if it contains the light of the previous bake.
        """
    @property
    def error_percent(self) -> float:
        """
        Estimated error in percent, including noise.
        """
    @property
    def noise_percent(self) -> float:
        ...
    @property
    def passes(self) -> int:
        ...
    @property
    def peak_memory_bytes(self) -> int:
        """
        Peak memory of the process in bytes.
        """
    @property
    def rays(self) -> int:
        """
        Number of traced rays, including lines.
        """
    @property
    def seconds(self) -> float:
        ...
    @property
    def skipped(self) -> list[tuple[str, str]]:
        """
        (name, reason) of each pass that the scene does not need.
        """
    @property
    def stopped(self) -> bool:
        """
        True if time or the caller ended it before the target error.
        """
    @property
    def worst_error_percent(self) -> float:
        """
        Estimated error at worst_isovalue in percent.
        """
    @property
    def worst_isovalue(self) -> float:
        """
        Common isovalue with the largest error.
        """
class BakeSettings:
    def __init__(self) -> None:
        ...
    @property
    def both_sides(self) -> bool:
        """
        True to bake the back, too, if light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def error(self) -> float:
        """
        Target RMS error of colors, in percent.
        """
    @error.setter
    def error(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def exposure(self) -> float:
        """
        Factor from radiance to displayed color.
        """
    @exposure.setter
    def exposure(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Texels along x, y, z; all 0: chosen by the bake.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        ...
    @property
    def seconds(self) -> float:
        """
        Time limit in seconds; 0: none.
        """
    @seconds.setter
    def seconds(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def seed(self) -> int:
        ...
    @seed.setter
    def seed(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def threads(self) -> int:
        """
        Number of threads; 0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        True to bake the radiance of the walls, too, per common isovalue.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class Baked:
    @property
    def grids(self) -> list[RadianceGrid]:
        """
        List of RadianceGrids, one per volume.
        """
    @property
    def statistics(self) -> BakeStatistics:
        ...
    @property
    def texels(self) -> int:
        """
        Number of texels with radiance, of all volumes.
        """
    @property
    def walls(self) -> WallRadiance:
        """
        WallRadiance, or None if it was not baked.
        """
class BakeSettings2:
    def __init__(self) -> None:
        ...
    @property
    def both_sides(self) -> bool:
        """
        True to bake the back, too, if light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def error(self) -> float:
        """
        Target RMS error of colors, in percent.
        """
    @error.setter
    def error(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def exposure(self) -> float:
        """
        Factor from radiance to displayed color.
        """
    @exposure.setter
    def exposure(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        """
        Texels along x, y, z; all 0: chosen by the bake.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(2)"]) -> None:
        ...
    @property
    def seconds(self) -> float:
        """
        Time limit in seconds; 0: none.
        """
    @seconds.setter
    def seconds(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def seed(self) -> int:
        ...
    @seed.setter
    def seed(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def threads(self) -> int:
        """
        Number of threads; 0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        True to bake the radiance of the walls, too, per common isovalue.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class Baked2:
    @property
    def grids(self) -> list[RadianceGrid2]:
        """
        List of RadianceGrids, one per volume.
        """
    @property
    def statistics(self) -> BakeStatistics:
        ...
    @property
    def texels(self) -> int:
        """
        Number of texels with radiance, of all volumes.
        """
    @property
    def walls(self) -> WallRadiance2:
        """
        WallRadiance, or None if it was not baked.
        """
class PartTracer:
    """
    Computes parts of a bake in passes in another process, as a worker of bake(). Scene and
    settings must be equal.
    """
    def __init__(self, scene: Scene, settings: BakeSettings, progress: Progress) -> None:
        """
        progress.cancel() makes every call raise Cancelled. Raises LeaflightError if such a
        bake has no passes.
        """
    def read(self, kind: typing.SupportsInt | typing.SupportsIndex, data: bytes) -> None:
        """
        Reads what workers.send() received and parts look up.
        """
    def traced(self, part: bytes) -> bytes:
        """
        Computes a part that workers.announce() received; returns bytes for workers.take().
        """
class PolygonEdges:
    """
    The unique edges of a mesh's polygons.
    """
    def __init__(self, polygons: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], vertices: typing.SupportsInt | typing.SupportsIndex) -> None:
        """
        polygons: int32 (m, k), each vertex in [0, vertices).
        """
    def __len__(self) -> int:
        ...
    def write(self, edges: numpy.typing.NDArray[numpy.int32], corners: numpy.typing.NDArray[numpy.int32]) -> None:
        """
        Fills int32 arrays with any strides: the vertices of each edge (e, 2), lower vertex
        first, ascending, and the edge from each corner to the next one (m * k,).
        """
class ReplacedFiles:
    """
    Temporary files beside their targets, which replace all targets together.
    """
    def __init__(self, targets: collections.abc.Sequence[os.PathLike | str | bytes]) -> None:
        """
        Raises LeaflightError.
        """
    def commit(self) -> None:
        """
        Replaces all targets; returns when the files are on the disk. Raises LeaflightError.
        """
    def discard(self) -> None:
        """
        Removes all files that were not committed.
        """
    def temporary(self, target: typing.SupportsInt | typing.SupportsIndex) -> pathlib.Path:
        """
        Returns the temporary path of a target, by its number.
        """
def attach_walls(walls: WallRadiance, scene: Scene, progress: Progress) -> None:
    """
    Adds the meshes of the scene and their direct light to a radiance from a file.
    Raises LeaflightError, Cancelled.
    """
def bake(scene: Scene, settings: BakeSettings, progress: Progress, on_pass: typing.Any = None, previous: tuple[collections.abc.Sequence[RadianceGrid], typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex] | None = None, checkpoint: tuple[os.PathLike | str | bytes, str, typing.SupportsFloat | typing.SupportsIndex] | None = None, resumed: os.PathLike | str | bytes | None = None, workers: typing.Any = None) -> Baked:
    """
    Lights all isosurfaces of the scene's isovalue range. `on_pass` receives the bake
    after each pass except the last, in the thread that bakes. `previous`: (grids,
    passes, blocks) of a bake to continue. `checkpoint`: (file, text, seconds); the bake
    saves its state and the text to this file at this interval. `resumed`: such a file,
    of the same scene and settings, from which the bake continues. `workers`: an object
    whose PartTracers compute parts of it. send(kind, data) gives data to all, which parts
    announced later look up. announce(parts) begins parts, bytes each, and returns the
    number of the first. take(number) returns the result of a part, or b"" to make the bake
    compute it. drop(first, count) forgets parts. Raises LeaflightError, Cancelled.
    """
def bake2(scene: Scene2, settings: BakeSettings2, progress: Progress, on_pass: typing.Any = None, previous: tuple[collections.abc.Sequence[RadianceGrid2], typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex] | None = None, checkpoint: tuple[os.PathLike | str | bytes, str, typing.SupportsFloat | typing.SupportsIndex] | None = None, resumed: os.PathLike | str | bytes | None = None, workers: typing.Any = None) -> Baked2:
    """
    Lights all isosurfaces of the scene's isovalue range. `on_pass` receives the bake
    after each pass except the last, in the thread that bakes. `previous`: (grids,
    passes, blocks) of a bake to continue. `checkpoint`: (file, text, seconds); the bake
    saves its state and the text to this file at this interval. `resumed`: such a file,
    of the same scene and settings, from which the bake continues. `workers`: an object
    whose PartTracers compute parts of it. send(kind, data) gives data to all, which parts
    announced later look up. announce(parts) begins parts, bytes each, and returns the
    number of the first. take(number) returns the result of a part, or b"" to make the bake
    compute it. drop(first, count) forgets parts. Raises LeaflightError, Cancelled.
    """
def bump_box(n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
    """
    Returns the thesis's reference data set (Eq. 2.1, Table 2.1) as float32 [z, y, x],
    0..255, on the unit cube with n voxels along each axis.
    """
def bump_box2(n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
    """
    Returns the same in 2D, float32 [y, x].
    """
def coarser_values(field: Field) -> numpy.typing.NDArray[numpy.float32]:
    """
    Returns values at n // 2 + 1 nodes along each axis over the same domain, float32 [z,
    y, x]. Inside the border, each is a mean over about two voxels along each axis; NaN
    if one of them is.
    """
def components(field: Field, isovalue: typing.SupportsFloat | typing.SupportsIndex, progress: Progress) -> tuple[numpy.typing.NDArray[numpy.uint32], numpy.typing.NDArray[numpy.uint64]]:
    """
    Returns (numbers, sizes) of the parts of the voxels at or above an isovalue that are
    connected across faces of voxels. numbers: uint32 [z, y, x], 0 below the isovalue, from 1
    on in descending order of size. sizes: voxels of each number, uint64. Raises Cancelled,
    and LeaflightError for more than 2^32 - 1 voxels.
    """
def connected_parts(triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], vertices: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.int32]:
    """
    Returns, for each vertex, the least vertex of its connected part, int32 (n,).
    """
def contour(field: Field, isovalue: typing.SupportsFloat | typing.SupportsIndex, normals: bool = True) -> tuple:
    """
    Returns (vertices float32 (n, 3) world, outward unit normals (n, 3), triangles int32
    (m, 3)) by marching cubes, a manifold. Without normals, which take most of the time,
    they are None.
    """
def contour2(field: Field2, isovalue: typing.SupportsFloat | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
    """
    Returns (vertices (n, 2) world, outward unit normals (n, 2), segments (m, 2)) by
    marching squares.
    """
def fitting_resolution(scene: Scene, settings: BakeSettings, bytes: typing.SupportsInt | typing.SupportsIndex) -> typing.Annotated[list[int], "FixedSize(3)"]:
    """
    Returns the finest resolution (nx, ny, nz) whose light_memory() is at most `bytes`,
    or zeros if the default resolution fits. Raises LeaflightError if none fits.
    """
def has_seal(path: os.PathLike | str | bytes) -> bool:
    """
    True if a file ends with a checksum, which read_bake() checks. Raises
    LeaflightError.
    """
def isosurface_hits(field: Field, origins: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
    """
    Intersects rays from world points (n, 3), in directions (n, 3) of any length, with
    the isosurface of an isovalue in data units. Returns (distances float64 (n,) in
    lengths of the direction, infinite without a hit; uint8 (n,), 1 if the ray hits the
    back).
    """
def large_array(shape: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], dtype: numpy.dtype[typing.Any]) -> numpy.ndarray:
    """
    Returns an uninitialized array [z, y, x] for the values of a volume; see
    limit_large_memory(). Raises LeaflightError if the disk is full.
    """
def large_memory() -> tuple[int, int]:
    """
    Returns the current bytes of the arrays of volumes: (in memory, in files).
    """
def large_parts(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], smallest: typing.SupportsFloat | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32]]:
    """
    Removes connected parts of a mesh that are shorter than `smallest` along all axes.
    Returns (numbers of the remaining vertices int32 (k,), triangles int32 (j, 3) by
    indices into these).
    """
def libraries() -> list:
    """
    Returns [(name, version of the headers, loaded version), ...]; versions are (major,
    minor).
    """
def light_memory(scene: Scene, settings: BakeSettings) -> int:
    """
    Estimates the maximum memory of a bake in passes in bytes, without the arrays of the
    volume.
    """
def limit_large_memory(limit: typing.SupportsInt | typing.SupportsIndex, folder: os.PathLike | str | bytes) -> None:
    """
    Limits the bytes of volumes' arrays in memory. Arrays above the limit are mapped to
    a nameless file in the folder. 0: no limit.
    """
def machine_memory() -> int:
    """
    Returns the memory that this process may use, in bytes; 0: unknown.
    """
def map_resolution(field: Field, isovalues: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"], texels: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"], points: typing.SupportsInt | typing.SupportsIndex) -> typing.Annotated[list[int], "FixedSize(3)"]:
    """
    Returns the resolution of maps for this number of light points: that of the texels, or
    a coarser one if it would take too much memory.
    """
def mesh_hits(mesh: Mesh, origins: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> tuple:
    """
    Intersects such rays with a Mesh, in single precision. Returns (distances float64
    (n,), triangles int32 (n,) or -1, barycentric coordinates (n, 2) of the triangle's
    second and third vertex).
    """
def noise_to_reach(error: typing.SupportsFloat | typing.SupportsIndex, bias: typing.SupportsFloat | typing.SupportsIndex) -> float:
    """
    The noise in percent at which a bake with this target error ends. bias: all other errors in
    percent, such as detail finer than the texels.
    """
def normals(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
    """
    Returns outward unit shading normals float32 (n, 3) of the isosurfaces through world
    points (n, 3) of the domain; zero if there is none.
    """
def part_tracer_memory(scene: Scene, settings: BakeSettings) -> int:
    """
    Estimates the maximum memory of a PartTracer in bytes, including the volume's values.
    """
def photon_balance(scene: Scene, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> dict:
    """
    Traces `count` photons. Returns the flux-heights (r, g, b) that were emitted,
    absorbed by surfaces, and that left the scene.
    """
def photon_balance2(scene: Scene2, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> dict:
    """
    Traces `count` photons. Returns the flux-heights (r, g, b) that were emitted,
    absorbed by surfaces, and that left the scene.
    """
def photon_points(scene: Scene, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None) -> tuple:
    """
    Traces `count` photons to isosurfaces. Returns (world positions (n, D), flux-heights
    (n, 3), common isovalues (n,), 1 for photons straight from a light (n,)).
    """
def photon_points2(scene: Scene2, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None) -> tuple:
    """
    Traces `count` photons to isosurfaces. Returns (world positions (n, D), flux-heights
    (n, 3), common isovalues (n,), 1 for photons straight from a light (n,)).
    """
def project_along(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], outward: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex, reach: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]:
    """
    Moves world points (n, 3) to the nearest point of the isosurface along the
    directions outward (n, 3) or against them, within reach voxels. Values must fall
    below the isovalue in that direction. Points without such a point are unchanged.
    """
def project_to_isosurface(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]:
    """
    Moves world points (n, 3) to the nearest point of the isosurface along the gradient,
    within two voxels. Points without such a point are unchanged.
    """
def read_bake(path: os.PathLike | str | bytes, progress: Progress = None) -> tuple[list, list, WallRadiance, dict[str, str]]:
    """
    Reads a bake: ([(values [z, y, x], index_to_world), ...], [RadianceGrid, ...],
    WallRadiance or None, metadata). Grids with visibility maps need add_direct() before use,
    and walls attach_walls(). Raises LeaflightError, Cancelled.
    """
def read_bake_header(path: os.PathLike | str | bytes) -> dict[str, str]:
    """
    Reads only the metadata of a file, by key.
    """
def read_checkpoint(path: os.PathLike | str | bytes) -> bytes:
    """
    Returns the text of a checkpoint of bake(), as bytes. Raises LeaflightError.
    """
def read_exr(path: os.PathLike | str | bytes) -> numpy.typing.NDArray[numpy.float32]:
    """
    float32 [row, column, RGB or RGBA], top row first.
    """
def read_exr_comments(path: os.PathLike | str | bytes) -> str:
    """
    Returns the comments of write_exr(); reads only the header.
    """
def read_vdb_volume(path: os.PathLike | str | bytes, grid: str = '') -> tuple:
    """
    Returns (values float32 [z, y, x], index_to_world, name) of a scalar grid's active
    box.
    """
def reference(scene: Scene, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, volume: typing.SupportsInt | typing.SupportsIndex = 0, back: bool = False) -> tuple:
    """
    Traces paths from a volume's isosurface at world points (n, D). Returns (radiance
    (n, 3), standard error (n, 3)). It is unbiased, except for caustics of lights
    without extent, which no path hits.
    """
def reference2(scene: Scene2, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, volume: typing.SupportsInt | typing.SupportsIndex = 0, back: bool = False) -> tuple:
    """
    Traces paths from a volume's isosurface at world points (n, D). Returns (radiance
    (n, 3), standard error (n, 3)). It is unbiased, except for caustics of lights
    without extent, which no path hits.
    """
def reference_walls(scene: Scene, mesh: typing.SupportsInt | typing.SupportsIndex, facets: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], coordinates: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, back: bool = False) -> tuple:
    """
    Does the same at points of a wall: facets (n,) and barycentric coordinates (n, 2),
    seen from the side of the normals or from behind.
    """
def reference_walls2(scene: Scene2, mesh: typing.SupportsInt | typing.SupportsIndex, facets: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], coordinates: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, back: bool = False) -> tuple:
    """
    Does the same at points of a wall: facets (n,) and barycentric coordinates (n, 2),
    seen from the side of the normals or from behind.
    """
def seen_from_outside(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex, directions: typing.SupportsInt | typing.SupportsIndex = 32, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> numpy.typing.NDArray[numpy.uint8]:
    """
    Returns uint8 (n,): 1 if a world point on the isosurface is visible from outside,
    because one of `directions` random rays from its front leaves the domain without a
    hit.
    """
def skipped_passes(scene: Scene, settings: BakeSettings) -> list[tuple[str, str]]:
    """
    Returns (name, reason) of each pass that a bake of the scene does not need.
    """
def skipped_passes2(scene: Scene2, settings: BakeSettings2) -> list[tuple[str, str]]:
    """
    Returns (name, reason) of each pass that a bake of the scene does not need.
    """
def trace(scene: Scene, origin: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], direction: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], c: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
    """
    Returns the first hit of a ray: ("isosurface", "walls" or None, (x, y, z) or None).
    """
def write_bake(path: os.PathLike | str | bytes, fields: collections.abc.Sequence[Field], grids: collections.abc.Sequence[RadianceGrid], walls: WallRadiance, metadata: collections.abc.Mapping[str, str], progress: Progress = None) -> None:
    """
    Writes a bake as a .vdb file, which it replaces atomically. Raises LeaflightError,
    and Cancelled with an unchanged file.
    """
def write_exr(path: os.PathLike | str | bytes, pixels: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], comments: str = '') -> None:
    """
    float32 [row, column, RGB or RGBA], top row first.
    """
