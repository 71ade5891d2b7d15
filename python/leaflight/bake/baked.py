# SPDX-License-Identifier: GPL-3.0-or-later
"""The class Bake: the radiance of every isosurface, and the methods that read it."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from ..io.output import check_writable
from ..paths import AnyPath
from ..scene.on_mesh import interpolated
from ..scene.lights import Color
from ..scene.scene import SceneDescription, core_scene, isovalue_at
from ..scene.volume_texture import named_values
from ..volume.setting_error import SettingError, check_is_baked
from ..volume.volume import Volume
from ..words import by, figures, html_table
from .provenance import Provenance
from .relit import relit
from .statistics import Statistics

if TYPE_CHECKING:
    from PIL.Image import Image

    _Watched = _core.Progress | Callable[[float, str], object] | Literal[False] | None

    class _Page(Protocol):
        """The interface of the result of export.notebook.show()."""

        @property
        def path(self) -> Path: ...
        @property
        def height(self) -> int: ...
        def _repr_html_(self) -> str: ...


# Largest difference of the colors at the ends of an edge of a small mesh. Light is interpolated
# linearly between them.
LARGEST_STEP = 0.05


@dataclass(frozen=True, eq=False, repr=False)
class Surface:
    """One lit isosurface in world coordinates.

    vertices: Positions, float32 (n, 3).
    normals: Unit normals towards the lit side, float32 (n, 3).
    radiance: Radiance of each vertex in W/(m^2 sr), linear RGB, float32 (n, 3).
    triangles: Vertex numbers, int32 (m, 3).
    seconds: Time of contouring and lookup.
    unit: Unit of the world, as in a Volume.
    values: Values of the volumes that color it, by name, float32 (n,) each; NaN where there are
        none.
    """

    vertices: Array
    normals: Array
    triangles: Array
    radiance: Array
    seconds: float
    unit: str = ""
    values: dict[str, Array] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Surface: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"

    if TYPE_CHECKING:
        # Signatures of functions in export.mesh_objects. __init__.py makes them methods.
        def to_vtk(self, exposure: float = 1.0) -> Any: ...
        def to_pyvista(self, exposure: float = 1.0) -> Any: ...
        def to_trimesh(self, exposure: float = 1.0) -> Any: ...


@dataclass(frozen=True, eq=False, repr=False)
class Bake:
    """Volumes, the scene in world coordinates that lit them, and the radiance of all isosurfaces.

    Every `isovalue` is the common isovalue (see scene.py): the isovalue of a single volume, and
    0..1 with several.

    isovalues: The baked isovalue range (lo, hi).
    grids: One _core.RadianceGrid for each volume.
    walls: A _core.WallRadiance or None.
    statistics: The cost and the estimated error.
    provenance: Everything that the result depends on. Equal bakes have equal ones.
    original: The bake that relit() or moved() was called on. None for a bake that was computed.
    factors: Strength (r, g, b) of each lamp of the scene relative to the original. None unless
        relit() made this bake.
    """

    volumes: list[Volume]
    scene: SceneDescription
    isovalues: tuple[float, float]
    grids: list[_core.RadianceGrid]
    walls: _core.WallRadiance | None
    statistics: Statistics
    provenance: Provenance
    original: "Bake | None" = None
    factors: tuple[Color, ...] | None = None

    def __repr__(self) -> str:
        return f"<Bake: {', '.join(f'{what} {text}' for what, text in self._facts())}>"

    def _repr_html_(self) -> str:
        return html_table("Bake", self._facts())

    def _facts(self) -> list[tuple[str, str]]:
        lo, hi = figures(*self.isovalues)
        known = self.statistics
        error = known.estimated_error_percent or known.estimated_rms_percent
        return [
            ("of", " and ".join(volume.name for volume in self.volumes)),
            ("in", self.scene.name),
            ("isovalues", f"{lo}..{hi}"),
            ("texels", by(self.grid.resolution)),
            *([("error", f"{error:.2g} %")] if error else []),
            ("seconds", f"{known.seconds:.3g}"),
        ]

    @property
    def is_moved(self) -> bool:
        """True if moved() made it: the light of an original in another scene."""
        return self.original is not None and self.factors is None

    @property
    def volume(self) -> Volume:
        return self.volumes[0]

    @property
    def grid(self) -> _core.RadianceGrid:
        return self.grids[0]

    @property
    def unit(self) -> str:
        """Unit of world coordinates: a key of METERS, "" if unknown."""
        return self.volume.unit

    @property
    def id(self) -> str:
        """Identifier of 32 hexadecimal digits; equal bakes have equal ones, on any machine."""
        return self.provenance.id

    @property
    def largest_step(self) -> float:
        """Largest difference of radiance along an edge of a small mesh for display."""
        return LARGEST_STEP / self.scene.exposure

    def save(self, path: AnyPath, progress: _core.Progress | None = None) -> None:
        """Writes the bake as one .vdb. No incomplete file gets the final name.

        Raises LeaflightError, and Cancelled if progress, a _core.Progress, is cancelled before the
        file is complete. A bake that relit() or moved() made cannot be saved.
        """
        if self.original is not None:
            raise LeaflightError(
                "A bake with changed lamps or in another scene cannot be saved: save its "
                "original, which can be changed again at any time, or bake again."
            )
        check_writable(path, ".vdb")
        metadata = {
            "id": self.id,
            "provenance": self.provenance.to_json(),
            "statistics": json.dumps(self.statistics.record()),
        }
        fields = [volume.field() for volume in self.volumes]
        walls = self.walls
        _core.write_bake(path, fields, self.grids, walls, metadata, progress)  # type: ignore[arg-type]

    def relit(self, lamps: Mapping[str, float | Sequence[float]]) -> "Bake":
        """Returns the Bake with other strengths or colors of its lamps, without a new bake.

        lamps: {name: factor}, relative to the strengths in this bake: a number of at least 0, or
        (r, g, b), linear. Direct light is exact. Indirect light, and the direct light of wide
        sources, are scaled by one factor per channel: the growth of the light that returns to
        isosurfaces after one reflection. This is exact if nothing else emits and one lamp, or all
        lamps alike, are changed. Emission of meshes and isosurfaces is unchanged. Texels are shared
        with this bake.
        Raises LeaflightError for a name that no lamp has, and if the bake has no exact direct
        light: bakes of mirrors, of glass, of backs of several volumes, or of fixed samples.
        """
        return relit(self, lamps)

    @cached_property
    def indirect_shares(self) -> _core.IndirectShares:
        """Share of each lamp in the indirect light, a _core.IndirectShares."""
        return _core.IndirectShares(self.core_scene())

    def isovalue_of(self, volume: int, isovalue: float) -> float:
        """Returns the isovalue, in data units, of a volume (its number) at a common isovalue."""
        return isovalue_at(self.scene, volume, isovalue)

    def surface(self, isovalue: float, volume: int = 0, back: bool = False) -> Surface:
        """Returns an isosurface of a volume with its radiance, a Surface.

        The mesh is subdivided where texels are narrower than voxels. A small mesh is also
        subdivided where the light changes steeply.
        back: takes the back, towards higher values. Raises LeaflightError outside the isovalue
            range.
        """
        self.check_isovalue(isovalue, volume)
        start = time.perf_counter()
        dark = self._is_dark(volume, back)
        vertices, normals, triangles, *sides, _ = self.grids[volume].lit_contour(
            self.volumes[volume].field(),
            self.isovalue_of(volume, isovalue),
            normals=True,
            front=not back,
            back=back and not dark,
            largest_step=self.largest_step,
        )
        radiance = np.zeros((len(vertices), 3), np.float32) if dark else sides[back]
        if back:
            normals, triangles = -normals, np.ascontiguousarray(triangles[:, ::-1])
        values = named_values(self.scene.isosurfaces[volume].texture, vertices)
        seconds = time.perf_counter() - start
        return Surface(vertices, normals, triangles, radiance, seconds, self.unit, values)

    def radiance(self, points: ArrayLike, volume: int = 0, back: bool = False) -> Array:
        """Returns baked radiance of a volume's isosurfaces, float32 (n, 3), at world points (n, 3).

        It is zero where no isosurface passes.
        back: takes the backs. Raises LeaflightError.
        """
        self.check_volume(volume)
        if self._is_dark(volume, back):
            return np.zeros((np.shape(points)[0], 3), dtype=np.float32)
        return self.grids[volume].lookup(self.volumes[volume].field(), points, back)

    def _is_dark(self, volume: int, back: bool) -> bool:
        """Returns True if the bake skipped the back because no light can reach it.

        Raises SettingError if the back was not asked for.
        """
        if not back or self.grids[volume].has_back:
            return False
        if not self.provenance.both_sides:
            raise SettingError("The back was not baked: bake again with both sides.", "both-sides")
        return True

    def radiance_error(self, points: ArrayLike, volume: int = 0) -> Array:
        """Returns the standard error of the mean of radiance() over the channels: float32 (n,)."""
        self.check_volume(volume)
        return self.grids[volume].lookup_error(self.volumes[volume].field(), points)

    def reference(
        self,
        points: ArrayLike,
        isovalue: float,
        spp: int = 1024,
        seed: int = 0,
        threads: int = 0,
        progress: _core.Progress | None = None,
        volume: int = 0,
        back: bool = False,
    ) -> tuple[Array, Array]:
        """Computes path-traced radiance at points (n, 3) of an isosurface, on its front or back.

        Returns (radiance, standard_error), float32 (n, 3) each. Raises LeaflightError, Cancelled.
        """
        self.check_isovalue(isovalue, volume)
        scene = self.core_scene()
        progress = progress or _core.Progress()
        return _core.reference(
            scene, points, isovalue, spp, seed, threads, progress, volume=volume, back=back
        )

    def mesh_number(self, name: str) -> int:
        """Returns the number of the mesh of the walls with this name. Raises LeaflightError."""
        names = [mesh.name for mesh in self.scene.meshes]
        if name not in names:
            raise LeaflightError(
                f'The scene has no mesh "{name}": choose one of {", ".join(names)}.'
            )
        return names.index(name)

    def mesh_radiance(self, mesh: int, points: Array, isovalue: float, back: bool = False) -> Array:
        """Returns baked radiance, float64 (n, 3), at points (n, 3) of a mesh of the walls.

        mesh: its number; back: takes the side that its normals point away from. Raises
            LeaflightError.
        """
        self._check_isovalue(isovalue)
        if self.walls is None:
            raise SettingError("The walls were not baked: bake again with walls.", "walls")
        vertices, triangles = self.walls.mesh(mesh)
        radiance = self.walls.radiance(mesh, isovalue, back)
        return interpolated(vertices, triangles, radiance, points)

    def mesh_reference(
        self,
        mesh: int,
        places: tuple[ArrayLike, ArrayLike],
        isovalue: float,
        spp: int = 1024,
        seed: int = 0,
        threads: int = 0,
        progress: _core.Progress | None = None,
        back: bool = False,
    ) -> tuple[Array, Array]:
        """Computes path-traced radiance at points of a mesh, as reference() does.

        places: facets (n,) and coordinates (n, 2), see on_mesh.py.
        """
        self._check_isovalue(isovalue)
        scene = self.core_scene()
        facets, coordinates = np.asarray(places[0]).tolist(), places[1]
        progress = progress or _core.Progress()
        return _core.reference_walls(
            scene, mesh, facets, coordinates, isovalue, spp, seed, threads, progress, back
        )

    def check_isovalue(self, isovalue: float, volume: int = 0) -> None:
        """Raises LeaflightError unless the baked range and the data include the isovalue."""
        self.check_volume(volume)
        self._check_isovalue(isovalue)
        low, high = self.volumes[volume].field().range
        local = self.isovalue_of(volume, isovalue)
        if not low < local <= high:
            shown, least, most = figures(local, *self.volumes[volume].data_range())
            raise LeaflightError(
                f"Isovalue {shown} is outside the data, {least}..{most}, so it has no isosurface: "
                "choose an isovalue inside."
            )

    def core_scene(self) -> _core.Scene:
        """Returns the scene for the core, a _core.Scene."""
        fields = [volume.field() for volume in self.volumes]
        return core_scene(self.scene, fields, self.isovalues)

    def _check_isovalue(self, isovalue: float) -> None:
        check_is_baked(isovalue, self.isovalues)

    def check_volume(self, volume: int) -> None:
        if not 0 <= volume < len(self.volumes):
            raise SettingError(
                f"There is no volume {volume}: the bake holds {len(self.volumes)}, "
                "numbered from 0.",
                "volume",
            )

    if TYPE_CHECKING:
        # Signatures of functions that use bakes. __init__.py makes them methods.
        def moved(
            self,
            volumes: Any,
            scene: SceneDescription | None,
            *,
            isovalues: Sequence[float] | None = None,
            quick: bool = False,
            walls: bool = True,
            progress: _core.Progress | None = None,
        ) -> "Bake": ...

        def export_page(
            self,
            path: AnyPath,
            isovalue: float | None = None,
            *,
            coarser: int = 0,
            embed: bool = False,
            lengths: tuple[float, str] | None = None,
            progress: _Watched = None,
        ) -> Path: ...

        def show(
            self,
            isovalue: float | None = None,
            *,
            height: int = 600,
            coarser: int | None = None,
            progress: _Watched = None,
        ) -> _Page: ...

        def widget(
            self,
            isovalue: float | None = None,
            *,
            height: int = 600,
            coarser: int | None = None,
            progress: _Watched = None,
        ) -> Any: ...

        def to_xarray(self, volume: int = 0) -> Any: ...

        def still(
            self, isovalue: float | None = None, color_bar: bool = False, **options: Any
        ) -> "Image": ...
