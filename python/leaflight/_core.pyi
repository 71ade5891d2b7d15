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
__all__: list[str] = ['AreaLight', 'AreaLight2', 'BakeSettings', 'BakeSettings2', 'BakeStatistics', 'Baked', 'Baked2', 'BlockTracer', 'Cancelled', 'DirectLight', 'Environment', 'Environment2', 'Field', 'Field2', 'FixedSettings', 'FixedSettings2', 'IndirectShares', 'LeaflightError', 'Mesh', 'Mesh2', 'PointLight', 'PointLight2', 'Progress', 'RadianceGrid', 'RadianceGrid2', 'ReplacedFiles', 'Scene', 'Scene2', 'SunLight', 'SunLight2', 'Texture', 'Volume', 'Volume2', 'WallRadiance', 'WallRadiance2', 'attach_walls', 'bake', 'bake2', 'bake_with_fixed_samples', 'bake_with_fixed_samples2', 'block_tracer_memory', 'bump_box', 'bump_box2', 'coarser_values', 'connected_parts', 'contour', 'contour2', 'exposed', 'fitting_resolution', 'has_seal', 'isosurface_hits', 'large_array', 'large_memory', 'large_parts', 'libraries', 'light_memory', 'limit_large_memory', 'machine_memory', 'mesh_hits', 'noise_to_reach', 'normals', 'photon_balance', 'photon_balance2', 'photon_points', 'photon_points2', 'polygon_edges', 'project_along', 'project_to_isosurface', 'read_bake', 'read_bake_header', 'read_checkpoint', 'read_exr', 'read_exr_comments', 'read_vdb_volume', 'reference', 'reference2', 'reference_walls', 'reference_walls2', 'skipped_passes', 'skipped_passes2', 'trace', 'write_bake', 'write_exr']
class LeaflightError(Exception):
    pass
class Cancelled(Exception):
    pass
class Progress:
    """
    Shared between work that runs, as a bake or the reading of a file, and whoever watches it from another thread.
    """
    def __init__(self) -> None:
        ...
    def advance(self, work: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Adds what was done, in the same unit.
        """
    def begin(self, stage: str) -> None:
        """
        Names what is done from now on.
        """
    def cancel(self) -> None:
        """
        The bake raises Cancelled within half a second.
        """
    def check(self) -> None:
        """
        Raises Cancelled after cancel().
        """
    def expect(self, total: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        How much there is to do, in any unit.
        """
    def stop(self) -> None:
        """
        A bake in passes ends after the pass under way, with what it has.
        """
    @property
    def cancelled(self) -> bool:
        ...
    @property
    def fraction(self) -> float:
        """
        Work done, 0..1.
        """
    @property
    def stage(self) -> str:
        """
        What is being done, for the user.
        """
    @property
    def stopped(self) -> bool:
        ...
class Field:
    """
    A scalar volume with its transform to the world, checked and indexed for ray tracing.
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
    def sample(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Interpolated values (n,) at world points (n, D); NaN outside and where masked.
        """
    def shade_by(self, values: numpy.typing.NDArray[numpy.float32]) -> None:
        """
        Takes the normals of isosurfaces from other values, float32 [z, y, x], such as
        smoothed ones: NaN where the field's are. Before the field is part of a scene.
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
    def masked(self) -> bool:
        """
        Whether some voxels are NaN.
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
    A scalar field in the plane.
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
    def sample(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Interpolated values (n,) at world points (n, D); NaN outside and where masked.
        """
    def shade_by(self, values: numpy.typing.NDArray[numpy.float32]) -> None:
        """
        Takes the normals of isosurfaces from other values, float32 [z, y, x], such as
        smoothed ones: NaN where the field's are. Before the field is part of a scene.
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
    def masked(self) -> bool:
        """
        Whether some voxels are NaN.
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
class AreaLight:
    """
    A rectangle, or the ellipse in it, that shines towards edge_u x edge_v; it neither blocks
    nor reflects light.
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
    A sphere that shines alike in all directions, or within a cone.
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
    Light from all around.
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
    A mesh of the walls, alike on both sides.
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
    A field and how its isosurfaces look.
    """
    def __init__(self, name: str, field: Field, albedo: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]], emission: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]] = [(0.0, [0.0, 0.0, 0.0])], scattering: str = 'diffuse', ior: typing.SupportsFloat | typing.SupportsIndex = 1.5, offset: typing.SupportsFloat | typing.SupportsIndex = 0.0, scale: typing.SupportsFloat | typing.SupportsIndex = 1.0) -> None:
        """
        albedo, emission: [(common isovalue, linear RGB), ...] in ascending order; the isosurface
        coordinate c shows the isovalue offset + scale c.
        """
    @property
    def name(self) -> str:
        ...
class Scene:
    """
    Volumes, what surrounds them, and the common isovalues to light.
    """
    def __init__(self, volumes: collections.abc.Sequence[Volume], meshes: collections.abc.Sequence[Mesh], lights: collections.abc.Sequence[AreaLight | PointLight | SunLight], isovalues: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex], environment: Environment | None = None) -> None:
        """
        isovalues: (low, high) of the common isovalue. Raises LeaflightError naming the object
        that is wrong.
        """
class AreaLight2:
    """
    A segment that shines to the left of its edge; it neither blocks nor reflects light.
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
    A sphere that shines alike in all directions, or within a cone.
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
    Light from all around.
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
    A mesh of the walls, alike on both sides.
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
    A field and how its isosurfaces look.
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
    Volumes, what surrounds them, and the common isovalues to light.
    """
    def __init__(self, volumes: collections.abc.Sequence[Volume2], meshes: collections.abc.Sequence[Mesh2], lights: collections.abc.Sequence[AreaLight2 | PointLight2 | SunLight2], isovalues: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex], environment: Environment2 | None = None) -> None:
        """
        isovalues: (low, high) of the common isovalue. Raises LeaflightError naming the object
        that is wrong.
        """
class DirectLight:
    """
    Maps of the direct light of every isosurface of one volume: for each texel of a lattice
    and each light point the greatest value of the volume on the way between them, as a byte.
    """
    def __init__(self, scene: Scene, volume: typing.SupportsInt | typing.SupportsIndex, resolution: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"], back: bool, progress: Progress, spacing: typing.SupportsFloat | typing.SupportsIndex = 1.0, earlier: DirectLight = None) -> None:
        """
        Of a scene's volume by its number. resolution: texels of the maps along x, y, z;
        back: also of the backs; spacing: voxels between the lines that find shadows, or
        texels where these are nearer to each other; earlier: where lights alone were others,
        whose maps serve for the points that have not moved. Raises Cancelled.
        """
    def codes(self, point: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 (n,) of the active texels, in the order of mask(), for a light point. An isosurface is
        lit at a texel if the code of its isovalue h is greater: 1 + 252 (h - lo) / (hi - lo)
        within code_range (lo, hi). 255 is behind a mesh. back: of backs, whose codes
        begin at hi.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    @property
    def code_range(self) -> tuple[float, float]:
        """
        (lo, hi): the values that codes tell apart, a little more than the isovalue range.
        """
    @property
    def has_back(self) -> bool:
        """
        Whether backs have maps.
        """
    @property
    def index_to_frame(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        float64 (4, 4): the frame is the world, moved and scaled uniformly.
        """
    @property
    def light_points(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        float64 (n, 4, 4), four rows for each point:
        its position in the frame and 1, or the direction to light from afar and 0;
        the normal along which it shines and 1, or 2 for both ways, or 0 for all directions;
        linear RGB irradiance [W/m^2] of a surface that faces it at distance 1 in the frame,
        and how wide the soft edge of its cone is, in cosines;
        the axis of the cone and the cosine at which it ends, -2 for none.
        """
    @property
    def lights(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        int32 (n,): the number of the scene's light that each point belongs to, or -1.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Texels along x, y, z, evenly spaced from the first voxel to the last.
        """
class IndirectShares:
    """
    How much indirect light comes from which lights of a scene.
    """
    def __init__(self, scene: Scene) -> None:
        ...
    def factor(self, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]]) -> tuple[float, float, float]:
        """
        How much more light there is, (r, g, b), if each light of the scene is brighter by its
        factors (r, g, b).
        """
    @property
    def total(self) -> tuple[float, float, float]:
        """
        Of all of them, (r, g, b).
        """
class RadianceGrid:
    """
    The radiance [W/(m^2 sr)] of every isosurface of one volume within an isovalue range.
    """
    def atlas(self, back: bool = False) -> tuple:
        """
        (pixels float32 [row, column, RGBA] bottom row first, columns, rows): slice k of the
        texture is the tile in column k % columns and row k // columns, without padding.
        """
    def dense(self, name: str) -> numpy.typing.NDArray[numpy.float32]:
        """
        radiance, radiance_indirect (all but the lights' direct light), radiance_back or
        radiance_back_indirect (the back): float32 [z, y, x, 3]; radiance_error, the standard error of the mean
        over the channels: float32 [z, y, x]. Zero at inactive texels.
        """
    def lit_contour(self, field: Field, isovalue: typing.SupportsFloat | typing.SupportsIndex, normals: bool = False, front: bool = True, back: bool = False, largest_step: typing.SupportsFloat | typing.SupportsIndex = ...) -> tuple:
        """
        (vertices, normals, triangles, radiance, radiance of the back, triangles before
        edges were cut): contour() and lookup() at its vertices at once, float32 (n, 3) each
        and int32 (m, 3). What is not asked for is None. Edges are cut in two as often as
        texels are narrower than voxels there, so that vertices show them; where the mesh is
        small twice at most more, if the radiance of their ends differs by more than
        largest_step. Fastest if the arrays of the call before are all let go.
        """
    def lookup(self, field: Field, points: typing.Any, back: bool = False, indirect: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Radiance (n, 3) of the isosurfaces through world points (n, D); indirect: the part of it that
        radiance_indirect holds.
        """
    def lookup_error(self, field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Standard error (n,) of the front's radiance at world points (n, D), of the mean
        over the channels: that of independent texels.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    def moved(self, field: Field, direct: DirectLight, indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid:
        """
        The same with the direct light of another scene, and all else but what isosurfaces emit
        brighter by the factors (r, g, b). field: its values, where they are now. Texels are
        shared.
        """
    def relit(self, field: Field, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid:
        """
        The same, of the field that was lit, with the lights of its scene at other strengths:
        for each, factors (r, g, b) against those that were baked; `indirect`: of all else but
        what isosurfaces emit. Texels are shared. Needs can_be_relit.
        """
    @property
    def can_be_relit(self) -> bool:
        """
        Whether the direct light of all sides is known exactly.
        """
    @property
    def direct(self) -> DirectLight:
        """
        The DirectLight that lookups add; None: texels hold all light. A bake in passes has it, a
        grid that was read from a file is given it.
        """
    @direct.setter
    def direct(self, arg1: DirectLight) -> None:
        ...
    @property
    def has_back(self) -> bool:
        """
        Whether the back was baked.
        """
    @property
    def map_resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"] | None:
        """
        Of the maps from which lookups compute direct light where they are, beside indirect
        light of texels; None: texels hold all light.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        ...
    @property
    def texels(self) -> int:
        """
        Active texels.
        """
class RadianceGrid2:
    """
    The radiance [W/(m^2 sr)] of every isosurface of one volume within an isovalue range.
    """
    def dense(self, name: str) -> numpy.typing.NDArray[numpy.float32]:
        """
        radiance, radiance_indirect (all but the lights' direct light), radiance_back or
        radiance_back_indirect (the back): float32 [z, y, x, 3]; radiance_error, the standard error of the mean
        over the channels: float32 [z, y, x]. Zero at inactive texels.
        """
    def lookup(self, field: Field2, points: typing.Any, back: bool = False, indirect: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Radiance (n, 3) of the isosurfaces through world points (n, D); indirect: the part of it that
        radiance_indirect holds.
        """
    def lookup_error(self, field: Field2, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
        """
        Standard error (n,) of the front's radiance at world points (n, D), of the mean
        over the channels: that of independent texels.
        """
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        uint8 [z, y, x], 1 at active texels.
        """
    def relit(self, field: Field2, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> RadianceGrid2:
        """
        The same, of the field that was lit, with the lights of its scene at other strengths:
        for each, factors (r, g, b) against those that were baked; `indirect`: of all else but
        what isosurfaces emit. Texels are shared. Needs can_be_relit.
        """
    @property
    def can_be_relit(self) -> bool:
        """
        Whether the direct light of all sides is known exactly.
        """
    @property
    def has_back(self) -> bool:
        """
        Whether the back was baked.
        """
    @property
    def map_resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"] | None:
        """
        Of the maps from which lookups compute direct light where they are, beside indirect
        light of texels; None: texels hold all light.
        """
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        ...
    @property
    def texels(self) -> int:
        """
        Active texels.
        """
class WallRadiance:
    """
    The radiance of the walls over the common isovalue, at the vertices of fine meshes.
    """
    def between(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.uint32]:
        """
        uint32 (n, 2): the vertices of the coarser mesh that each vertex lies halfway between.
        """
    def direct_ways(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Of the vertices of a fine mesh, each of which has one of several sets of light points:
        the number of its set, uint8 (n,); for each point the least and the greatest isosurface
        coordinate on the way to it, between which isosurfaces block it, float32 (n, points), the
        least None where isosurfaces are closed, the greatest infinite behind a mesh; the irradiance
        if nothing stood in
        the way over the amount of the point, negative behind the vertex, float32 (n, points);
        and the radiance by all sets if nothing did, of the front and of the back, float32
        (lights + 1, n, 3) by each light of the scene and by all that is no light. A side
        reflects their sum times the mean over each vertex and its neighbors of the share of
        their sets' light that no isosurface blocks.
        """
    def indirect(self, mesh: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Its part but direct light: float32 (nodes, m, 3) at the vertices of a coarser mesh.
        """
    def mesh(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
        """
        (vertices float32 (n, D) world, facets int32 (m, D)).
        """
    def moved(self, earlier: Scene, scene: Scene, same_as: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], progress: Progress, share: typing.SupportsInt | typing.SupportsIndex = 1, lights_alone: bool = False) -> WallRadiance:
        """
        The same beside another scene than that which was baked, `earlier`: direct light is
        exact, all else but the meshes' own emission brighter by the factors (r, g, b).
        same_as: of each mesh of the scene its number in the earlier one, or -1. share:
        one way of so many is traced for shadows; lights_alone: whether nothing else has moved,
        which takes less time. Raises Cancelled.
        """
    def places(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]]:
        """
        Where the vertices were lit: (facets int32 (n,) of the original mesh, barycentric
        coordinates (n, 2)), for reference_walls().
        """
    def radiance(self, mesh: typing.SupportsInt | typing.SupportsIndex, c: typing.SupportsFloat | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        float32 (n, 3) at the vertices of a fine mesh, seen from its normals' side or from
        behind.
        """
    def relit(self, scene: Scene, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> WallRadiance:
        """
        The same with the lights of the scene that was baked at other strengths, as
        RadianceGrid.relit() has it.
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
        int32 (points,): the number of the scene's light that each point of a set belongs to, or -1.
        """
class WallRadiance2:
    """
    The radiance of the walls over the common isovalue, at the vertices of fine meshes.
    """
    def between(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.uint32]:
        """
        uint32 (n, 2): the vertices of the coarser mesh that each vertex lies halfway between.
        """
    def direct_ways(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Of the vertices of a fine mesh, each of which has one of several sets of light points:
        the number of its set, uint8 (n,); for each point the least and the greatest isosurface
        coordinate on the way to it, between which isosurfaces block it, float32 (n, points), the
        least None where isosurfaces are closed, the greatest infinite behind a mesh; the irradiance
        if nothing stood in
        the way over the amount of the point, negative behind the vertex, float32 (n, points);
        and the radiance by all sets if nothing did, of the front and of the back, float32
        (lights + 1, n, 3) by each light of the scene and by all that is no light. A side
        reflects their sum times the mean over each vertex and its neighbors of the share of
        their sets' light that no isosurface blocks.
        """
    def indirect(self, mesh: typing.SupportsInt | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        Its part but direct light: float32 (nodes, m, 3) at the vertices of a coarser mesh.
        """
    def mesh(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
        """
        (vertices float32 (n, D) world, facets int32 (m, D)).
        """
    def moved(self, earlier: Scene2, scene: Scene2, same_as: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], progress: Progress, share: typing.SupportsInt | typing.SupportsIndex = 1, lights_alone: bool = False) -> WallRadiance2:
        """
        The same beside another scene than that which was baked, `earlier`: direct light is
        exact, all else but the meshes' own emission brighter by the factors (r, g, b).
        same_as: of each mesh of the scene its number in the earlier one, or -1. share:
        one way of so many is traced for shadows; lights_alone: whether nothing else has moved,
        which takes less time. Raises Cancelled.
        """
    def places(self, mesh: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]]:
        """
        Where the vertices were lit: (facets int32 (n,) of the original mesh, barycentric
        coordinates (n, 2)), for reference_walls().
        """
    def radiance(self, mesh: typing.SupportsInt | typing.SupportsIndex, c: typing.SupportsFloat | typing.SupportsIndex, back: bool = False) -> numpy.typing.NDArray[numpy.float32]:
        """
        float32 (n, 3) at the vertices of a fine mesh, seen from its normals' side or from
        behind.
        """
    def relit(self, scene: Scene2, lights: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]], indirect: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> WallRadiance2:
        """
        The same with the lights of the scene that was baked at other strengths, as
        RadianceGrid.relit() has it.
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
        int32 (points,): the number of the scene's light that each point of a set belongs to, or -1.
        """
class BakeStatistics:
    """
    The cost of a bake, and its estimated error.
    """
    @property
    def blocks(self) -> int:
        """
        Of indirect light, in the averages.
        """
    @property
    def error_percent(self) -> float:
        """
        Noise included.
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
        Of the process.
        """
    @property
    def rays(self) -> int:
        """
        Traced, lines included.
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
        By time or by the caller, before the error was reached.
        """
    @property
    def worst_error_percent(self) -> float:
        """
        There.
        """
    @property
    def worst_isovalue(self) -> float:
        """
        The isovalue whose isosurface errs most.
        """
class BakeSettings:
    def __init__(self) -> None:
        ...
    @property
    def both_sides(self) -> bool:
        """
        Bake the back too, where light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def error(self) -> float:
        """
        The RMS error of colors to reach, in percent.
        """
    @error.setter
    def error(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def exposure(self) -> float:
        """
        Radiance times this is a displayed color.
        """
    @exposure.setter
    def exposure(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Texels along x, y, z; all 0: as the bake chooses them.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        ...
    @property
    def seconds(self) -> float:
        """
        No pass begins after so many; 0: no limit.
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
        0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        Bake the radiance of the walls per common isovalue too.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class Baked:
    @property
    def grids(self) -> list[RadianceGrid]:
        """
        A RadianceGrid per volume.
        """
    @property
    def statistics(self) -> BakeStatistics:
        ...
    @property
    def texels(self) -> int:
        """
        That hold radiance, of all volumes.
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
        Bake the back too, where light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def error(self) -> float:
        """
        The RMS error of colors to reach, in percent.
        """
    @error.setter
    def error(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def exposure(self) -> float:
        """
        Radiance times this is a displayed color.
        """
    @exposure.setter
    def exposure(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        """
        Texels along x, y, z; all 0: as the bake chooses them.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(2)"]) -> None:
        ...
    @property
    def seconds(self) -> float:
        """
        No pass begins after so many; 0: no limit.
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
        0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        Bake the radiance of the walls per common isovalue too.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class Baked2:
    @property
    def grids(self) -> list[RadianceGrid2]:
        """
        A RadianceGrid per volume.
        """
    @property
    def statistics(self) -> BakeStatistics:
        ...
    @property
    def texels(self) -> int:
        """
        That hold radiance, of all volumes.
        """
    @property
    def walls(self) -> WallRadiance2:
        """
        WallRadiance, or None if it was not baked.
        """
class FixedSettings:
    """
    Of a bake with a fixed number of samples.
    """
    def __init__(self) -> None:
        ...
    def set_only_at(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        World points (n, D): bake only the texels that lookups there use, by the estimator path.
        """
    def set_photon_map(self, k: typing.SupportsInt | typing.SupportsIndex = 200, radius: typing.SupportsFloat | typing.SupportsIndex = 0.0, g: typing.SupportsFloat | typing.SupportsIndex = 10.0, region: str = 'clipped_sphere') -> None:
        """
        Of the estimator `thesis`: the k nearest photons, or those within the radius (shares of
        the volume's longest side; 0: no limit), kappa = g * domain / range; region: sphere,
        clipped_sphere, box, cylinder or graph.
        """
    def set_scattered(self, strategy: str, count: typing.SupportsInt | typing.SupportsIndex, isovalues: typing.SupportsInt | typing.SupportsIndex | collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex] = 9, filter: str = 'shepard', radius: typing.SupportsInt | typing.SupportsIndex = 3) -> None:
        """
        Samples scattered over the domain (uniform, stratified, importance, level_set, letters,
        slabs, regular; `isovalues` of level_set: how many, or which) and interpolated (shepard,
        tent, box) into texels up to `radius` away, instead of samples in each texel.
        """
    @property
    def both_sides(self) -> bool:
        """
        Bake the back too, where light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def caustic_photons(self) -> int:
        """
        Photons emitted for caustics, where there are mirrors or glass.
        """
    @caustic_photons.setter
    def caustic_photons(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def estimator(self) -> str:
        """
        gather, volumetric, path or thesis.
        """
    @estimator.setter
    def estimator(self, arg1: str) -> None:
        ...
    @property
    def photons(self) -> int:
        """
        Photons emitted over all isovalues.
        """
    @photons.setter
    def photons(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(3)"]:
        """
        Texels along x, y, z; all 0 for one per voxel.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"]) -> None:
        ...
    @property
    def samples(self) -> int:
        """
        Samples per texel, each one shadow ray and one gather ray.
        """
    @samples.setter
    def samples(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
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
        0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        Bake the radiance of the walls per common isovalue too.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class FixedSettings2:
    """
    Of a bake with a fixed number of samples.
    """
    def __init__(self) -> None:
        ...
    def set_only_at(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        World points (n, D): bake only the texels that lookups there use, by the estimator path.
        """
    def set_photon_map(self, k: typing.SupportsInt | typing.SupportsIndex = 200, radius: typing.SupportsFloat | typing.SupportsIndex = 0.0, g: typing.SupportsFloat | typing.SupportsIndex = 10.0, region: str = 'clipped_sphere') -> None:
        """
        Of the estimator `thesis`: the k nearest photons, or those within the radius (shares of
        the volume's longest side; 0: no limit), kappa = g * domain / range; region: sphere,
        clipped_sphere, box, cylinder or graph.
        """
    def set_scattered(self, strategy: str, count: typing.SupportsInt | typing.SupportsIndex, isovalues: typing.SupportsInt | typing.SupportsIndex | collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex] = 9, filter: str = 'shepard', radius: typing.SupportsInt | typing.SupportsIndex = 3) -> None:
        """
        Samples scattered over the domain (uniform, stratified, importance, level_set, letters,
        slabs, regular; `isovalues` of level_set: how many, or which) and interpolated (shepard,
        tent, box) into texels up to `radius` away, instead of samples in each texel.
        """
    @property
    def both_sides(self) -> bool:
        """
        Bake the back too, where light can reach it.
        """
    @both_sides.setter
    def both_sides(self, arg0: bool) -> None:
        ...
    @property
    def caustic_photons(self) -> int:
        """
        Photons emitted for caustics, where there are mirrors or glass.
        """
    @caustic_photons.setter
    def caustic_photons(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def estimator(self) -> str:
        """
        gather, volumetric, path or thesis.
        """
    @estimator.setter
    def estimator(self, arg1: str) -> None:
        ...
    @property
    def photons(self) -> int:
        """
        Photons emitted over all isovalues.
        """
    @photons.setter
    def photons(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def resolution(self) -> typing.Annotated[list[int], "FixedSize(2)"]:
        """
        Texels along x, y, z; all 0 for one per voxel.
        """
    @resolution.setter
    def resolution(self, arg0: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(2)"]) -> None:
        ...
    @property
    def samples(self) -> int:
        """
        Samples per texel, each one shadow ray and one gather ray.
        """
    @samples.setter
    def samples(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
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
        0: all.
        """
    @threads.setter
    def threads(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def walls(self) -> bool:
        """
        Bake the radiance of the walls per common isovalue too.
        """
    @walls.setter
    def walls(self, arg0: bool) -> None:
        ...
class BlockTracer:
    """
    Traces single blocks of indirect light for a bake in passes of the same scene and settings that runs
    elsewhere: what bake()'s `workers` give it.
    """
    def __init__(self, scene: Scene, settings: BakeSettings, progress: Progress) -> None:
        """
        progress.cancel() ends whatever is done with Cancelled. Raises LeaflightError where
        such a bake has no passes.
        """
    def look_up(self, state: str) -> None:
        """
        Takes the bytes that workers.begin() was given; blocks need them.
        """
    def trace(self, number: typing.SupportsInt | typing.SupportsIndex) -> bytes:
        """
        The block of this number: bytes for workers.take().
        """
class ReplacedFiles:
    """
    Files written beside their targets, which take their places at once.
    """
    def __init__(self, targets: collections.abc.Sequence[os.PathLike | str | bytes]) -> None:
        """
        Raises LeaflightError.
        """
    def commit(self) -> None:
        """
        Returns when all are on the disk and under their names. Raises LeaflightError.
        """
    def discard(self) -> None:
        """
        Removes what was not committed.
        """
    def temporary(self, target: typing.SupportsInt | typing.SupportsIndex) -> pathlib.Path:
        """
        The path to write the file of a target, by its number, to.
        """
def attach_walls(walls: WallRadiance, scene: Scene, progress: Progress) -> None:
    """
    Gives a radiance that was read from a file the meshes of its scene and its direct light.
    Raises LeaflightError, Cancelled.
    """
def bake(scene: Scene, settings: BakeSettings, progress: Progress, on_pass: typing.Any = None, previous: tuple[collections.abc.Sequence[RadianceGrid], typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex] | None = None, checkpoint: tuple[os.PathLike | str | bytes, str, typing.SupportsFloat | typing.SupportsIndex] | None = None, resumed: os.PathLike | str | bytes | None = None, workers: typing.Any = None) -> Baked:
    """
    Lights all isosurfaces of the scene's isovalue range. `on_pass` is given what is baked after each
    pass but the last, from the thread that bakes. `previous`: (grids, passes, blocks) of a
    bake to go on with. `checkpoint`: (file, text, seconds): the bake leaves
    its state there, with the text, so many seconds apart. `resumed`: such a file, of a bake of
    the same scene and settings, to go on from. `workers`: an object that has blocks of light
    traced by BlockTracers: begin(first, count, state) announces the blocks [first,
    first + count), and what their lines look up, bytes;
    take(number) returns one of them, or b"", and the bake traces it itself. Raises
    LeaflightError, or Cancelled.
    """
def bake2(scene: Scene2, settings: BakeSettings2, progress: Progress, on_pass: typing.Any = None, previous: tuple[collections.abc.Sequence[RadianceGrid2], typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex] | None = None, checkpoint: tuple[os.PathLike | str | bytes, str, typing.SupportsFloat | typing.SupportsIndex] | None = None, resumed: os.PathLike | str | bytes | None = None, workers: typing.Any = None) -> Baked2:
    """
    Lights all isosurfaces of the scene's isovalue range. `on_pass` is given what is baked after each
    pass but the last, from the thread that bakes. `previous`: (grids, passes, blocks) of a
    bake to go on with. `checkpoint`: (file, text, seconds): the bake leaves
    its state there, with the text, so many seconds apart. `resumed`: such a file, of a bake of
    the same scene and settings, to go on from. `workers`: an object that has blocks of light
    traced by BlockTracers: begin(first, count, state) announces the blocks [first,
    first + count), and what their lines look up, bytes;
    take(number) returns one of them, or b"", and the bake traces it itself. Raises
    LeaflightError, or Cancelled.
    """
def bake_with_fixed_samples(scene: Scene, settings: FixedSettings, progress: Progress) -> Baked:
    """
    Lights all isosurfaces of the scene's isovalue range by a fixed number of samples. Raises
    LeaflightError, or Cancelled.
    """
def bake_with_fixed_samples2(scene: Scene2, settings: FixedSettings2, progress: Progress) -> Baked2:
    """
    Lights all isosurfaces of the scene's isovalue range by a fixed number of samples. Raises
    LeaflightError, or Cancelled.
    """
def block_tracer_memory(scene: Scene, settings: BakeSettings) -> int:
    """
    About how many bytes a BlockTracer holds at most, the volume's values included.
    """
def bump_box(n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
    """
    The thesis's reference data set (Eq. 2.1, Table 2.1) as float32 [z, y, x], 0..255, on the
    unit cube with n voxels along each axis.
    """
def bump_box2(n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
    """
    The same in the plane, float32 [y, x].
    """
def coarser_values(field: Field) -> numpy.typing.NDArray[numpy.float32]:
    """
    The values at nodes n // 2 + 1 along each axis over the same domain, float32 [z, y, x]. Between its
    borders each is a mean over about two voxels along each axis; NaN where one of the mean is.
    """
def connected_parts(triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], vertices: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.int32]:
    """
    The least vertex of the connected part that each of so many vertices is in, int32 (n,).
    """
def contour(field: Field, isovalue: typing.SupportsFloat | typing.SupportsIndex, normals: bool = True) -> tuple:
    """
    Marching cubes: (vertices float32 (n, 3) world, outward unit normals (n, 3), triangles int32
    (m, 3)), a manifold. Without normals, which take the longest, there is None in their place.
    """
def contour2(field: Field2, isovalue: typing.SupportsFloat | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.int32]]:
    """
    Marching squares: (vertices (n, 2) world, outward unit normals (n, 2), segments (m, 2)).
    """
def exposed(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex, directions: typing.SupportsInt | typing.SupportsIndex = 32, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> numpy.typing.NDArray[numpy.uint8]:
    """
    uint8 (n,): 1 where one of `directions` random rays from the isosurface's front leaves the
    domain, so that the world point can be seen from outside.
    """
def fitting_resolution(scene: Scene, settings: BakeSettings, bytes: typing.SupportsInt | typing.SupportsIndex) -> typing.Annotated[list[int], "FixedSize(3)"]:
    """
    The finest texels (nx, ny, nz) for which light_memory() is at most `bytes`; zeros
    where it is with those that the bake takes by itself. Raises LeaflightError where
    none fit.
    """
def has_seal(path: os.PathLike | str | bytes) -> bool:
    """
    Whether a file ends with a checksum, which read_bake() looks at. Raises LeaflightError.
    """
def isosurface_hits(field: Field, origins: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
    """
    Where rays first hit the isosurface of an isovalue (in data units), from world points
    (n, 3) in directions (n, 3) of any length: (distances float64 (n,), in lengths of
    the direction, infinite where they do not; uint8 (n,), 1 where the ray arrives from
    higher values, at the back).
    """
def large_array(shape: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], dtype: numpy.dtype[typing.Any]) -> numpy.ndarray:
    """
    An array [z, y, x] for the values of a volume, whatever is in it; see limit_large_memory().
    Raises LeaflightError where the disk has no room.
    """
def large_memory() -> tuple[int, int]:
    """
    Bytes that the arrays of volumes take now: (in memory, in files).
    """
def large_parts(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], smallest: typing.SupportsFloat | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32]]:
    """
    (vertices int32 (k,) that stay, triangles int32 (j, 3) by places among these) of a mesh
    without its connected parts that are shorter than `smallest` along all axes.
    """
def libraries() -> list:
    """
    [(name, version of the headers, version that is loaded), ...], versions (major, minor).
    """
def light_memory(scene: Scene, settings: BakeSettings) -> int:
    """
    About how many bytes a bake in passes takes at most, besides the arrays of the volume.
    """
def limit_large_memory(limit: typing.SupportsInt | typing.SupportsIndex, folder: os.PathLike | str | bytes) -> None:
    """
    Arrays of a volume that are made from now on lie in a file in the folder, which has no
    name, as soon as those in memory would take more than `limit` bytes; 0: no limit.
    """
def machine_memory() -> int:
    """
    What this process may take of the machine's memory at most, in bytes; 0: not known.
    """
def mesh_hits(mesh: Mesh, origins: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> tuple:
    """
    Where such rays first hit a Mesh, in single precision: (distances float64 (n,);
    triangles int32 (n,), -1 for none; barycentric coordinates (n, 2) of its second and
    third vertex).
    """
def noise_to_reach(error: typing.SupportsFloat | typing.SupportsIndex, texture: typing.SupportsFloat | typing.SupportsIndex) -> float:
    """
    Percent of noise at which a bake ends that is asked for an error (percent) and whose
    texels miss some of the light (percent).
    """
def normals(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float32]:
    """
    Outward unit normals float32 (n, 3) with which isosurfaces are shaded at world points (n, 3) of
    the domain; zero where there is none.
    """
def photon_balance(scene: Scene, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> dict:
    """
    Flux-height (r, g, b) that `count` photons emitted, lost at surfaces and took out
    of the scene.
    """
def photon_balance2(scene: Scene2, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0) -> dict:
    """
    Flux-height (r, g, b) that `count` photons emitted, lost at surfaces and took out
    of the scene.
    """
def photon_points(scene: Scene, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None) -> tuple:
    """
    Where `count` emitted photons hit isosurfaces: (world positions (n, D), flux-height
    (n, 3), common isovalue (n,), 1 where they came straight from a light (n,)).
    """
def photon_points2(scene: Scene2, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None) -> tuple:
    """
    Where `count` emitted photons hit isosurfaces: (world positions (n, D), flux-height
    (n, 3), common isovalue (n,), 1 where they came straight from a light (n,)).
    """
def polygon_edges(polygons: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], vertices: typing.SupportsInt | typing.SupportsIndex) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32]]:
    """
    (edges int32 (e, 2), each once, lower vertex first, ascending; the edge from each corner to
    the next one, int32 (m, k)) of polygons int32 (m, k) with so many vertices in all.
    """
def project_along(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], outward: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex, reach: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]:
    """
    The points of the trilinear isosurface nearest to world points (n, 3), along the directions outward (n, 3)
    or against them, where values fall below the isovalue in that direction, within reach voxels; points
    without one are returned as they are.
    """
def project_to_isosurface(field: Field, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], isovalue: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]:
    """
    The points of the trilinear isosurface nearest along the gradient to world points (n, 3), within
    two voxels; points without one are returned as they are.
    """
def read_bake(path: os.PathLike | str | bytes) -> tuple[list, list, WallRadiance, dict[str, str]]:
    """
    ([(values [z, y, x], index_to_world), ...], [RadianceGrid, ...], WallRadiance or
    None, metadata) of a bake. The walls need attach_walls() before use.
    """
def read_bake_header(path: os.PathLike | str | bytes) -> dict[str, str]:
    """
    The metadata of the file itself, by key: nothing else of it is read.
    """
def read_checkpoint(path: os.PathLike | str | bytes) -> bytes:
    """
    The text, bytes, of a checkpoint that bake() left. Raises LeaflightError.
    """
def read_exr(path: os.PathLike | str | bytes) -> numpy.typing.NDArray[numpy.float32]:
    """
    float32 [row, column, RGB or RGBA], top row first.
    """
def read_exr_comments(path: os.PathLike | str | bytes) -> str:
    """
    The comments that write_exr() wrote; reads the header alone.
    """
def read_vdb_volume(path: os.PathLike | str | bytes, grid: str = '') -> tuple:
    """
    (values float32 [z, y, x], index_to_world, name) of a scalar grid's active box.
    """
def reference(scene: Scene, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, volume: typing.SupportsInt | typing.SupportsIndex = 0, back: bool = False) -> tuple:
    """
    Radiance of a volume's isosurface by path tracing at world points (n, D): (radiance
    (n, 3), standard error (n, 3)). Unbiased, save for caustics of lights without
    extent, which no path hits.
    """
def reference2(scene: Scene2, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, volume: typing.SupportsInt | typing.SupportsIndex = 0, back: bool = False) -> tuple:
    """
    Radiance of a volume's isosurface by path tracing at world points (n, D): (radiance
    (n, 3), standard error (n, 3)). Unbiased, save for caustics of lights without
    extent, which no path hits.
    """
def reference_walls(scene: Scene, mesh: typing.SupportsInt | typing.SupportsIndex, facets: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], coordinates: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, back: bool = False) -> tuple:
    """
    The same at points of a mesh of the walls: facets (n,) and barycentric
    coordinates (n, 2), seen from the normals' side or from behind.
    """
def reference_walls2(scene: Scene2, mesh: typing.SupportsInt | typing.SupportsIndex, facets: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], coordinates: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], c: typing.SupportsFloat | typing.SupportsIndex, spp: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex = 0, threads: typing.SupportsInt | typing.SupportsIndex = 0, progress: Progress = None, back: bool = False) -> tuple:
    """
    The same at points of a mesh of the walls: facets (n,) and barycentric
    coordinates (n, 2), seen from the normals' side or from behind.
    """
def skipped_passes(scene: Scene, settings: BakeSettings) -> list[tuple[str, str]]:
    """
    (name, reason) of each pass that a bake of them does not need.
    """
def skipped_passes2(scene: Scene2, settings: BakeSettings2) -> list[tuple[str, str]]:
    """
    (name, reason) of each pass that a bake of them does not need.
    """
def trace(scene: Scene, origin: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], direction: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], c: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
    """
    ("isosurface", "walls" or None, (x, y, z) or None): what a ray hits, and where.
    """
def write_bake(path: os.PathLike | str | bytes, fields: collections.abc.Sequence[Field], grids: collections.abc.Sequence[RadianceGrid], walls: WallRadiance, metadata: collections.abc.Mapping[str, str], progress: Progress = None) -> None:
    """
    Replaces one .vdb as a whole. Raises LeaflightError, and Cancelled with the file as it was.
    """
def write_exr(path: os.PathLike | str | bytes, pixels: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], comments: str = '') -> None:
    """
    float32 [row, column, RGB or RGBA], top row first.
    """
