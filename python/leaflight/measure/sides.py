# SPDX-License-Identifier: GPL-3.0-or-later
"""One side of an isosurface, or of a mesh around it: its baked light and its references.

isovalue is always the common isovalue. progress: As for bake().
"""

from dataclasses import replace

import leaflight._core as _core
import numpy as np

from .._core import Field, LeaflightError, Progress
from ..arrays import Array
from ..bake.baked import Bake
from ..scene.on_mesh import positions, random_places, random_points
from ..scene.scene import Isosurfaces, Mesh, covered
from .cycles import measure
from .sampling import Sampling, Target
from .truth import Truth, parts_of

# Number of random rays that test if a point can be seen from outside.
EXPOSURE_RAYS = 32
# Number of independent sets of samples per point, which estimate the error of stratified samples.
PASSES = 8


class IsosurfaceSide:
    """The isosurface of a volume, or its back. Raises LeaflightError.

    Points are those of its marching-cubes mesh, float64 (n, 3), world. The mesh is as fine as the
    texels, but does not depend on light, so that bakes are compared at the same points. triangles:
    Number of triangles.
    """

    def __init__(self, bake: Bake, isovalue: float, volume: int = 0, back: bool = False) -> None:
        self.bake, self.isovalue = bake, isovalue
        self.volume, self.back = volume, back
        bake.check_isovalue(isovalue, volume)
        _check_diffuse(bake.scene.isosurfaces[volume])
        mesh = bake.grids[volume].lit_contour(self._field(), self._own(), front=False)
        self._vertices, _, self._triangles, *_ = mesh
        # Raise an error if that side was not baked.
        self.baked(self._vertices[:1])
        self.triangles = len(self._triangles)
        if self.triangles == 0:
            raise LeaflightError(
                f"Isovalue {isovalue:g} has no surface inside the data: choose another isovalue."
            )

    def area(self) -> float:
        """Returns the area of the mesh, in the square of the world's unit."""
        a, b, c = (self._vertices[corner] for corner in self._triangles.T)
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)

    def path_traced(self, sampling: Sampling, progress: Progress | None) -> Truth:
        """Returns the Truth of the core's path tracer at random points."""
        on_mesh = random_points(self._vertices, self._triangles, sampling.points, sampling.seed)
        return self.path_traced_at(on_mesh, sampling, progress)

    def path_traced_at(self, on_mesh: Array, how: Sampling, progress: Progress | None) -> Truth:
        """Returns the same at given points of the mesh, traced from the nearby isosurface."""
        passes = min(PASSES, how.spp)
        points = np.tile(self._projected(on_mesh), (passes, 1))
        work = -(-how.spp // passes), how.seed, how.threads, progress
        radiance, _ = self.bake.reference(points, self.isovalue, *work, self.volume, self.back)
        return self._of_visible(_of_passes(on_mesh, radiance, passes))

    def by_cycles(self, sampling: Sampling, progress: Progress | None) -> Truth:
        """Returns the Truth of Cycles at about as many random points."""
        target = Target(self.volume, None, self.back)
        return self._of_visible(_by_cycles(self.bake, self.isovalue, target, sampling, progress))

    def _of_visible(self, truth: Truth) -> Truth:
        """Returns the Truth without weight for points inside another volume's isosurface."""
        fields = [volume.field() for volume in self.bake.volumes]
        hidden = covered(self.bake.scene, fields, self.volume, self.isovalue, truth.points)
        weights = np.where(hidden, 0, truth.weights)
        if not weights.any():
            raise LeaflightError(
                f"The surface at isovalue {self.isovalue:g} is inside another volume: choose "
                "another isovalue."
            )
        return replace(truth, weights=weights)

    def baked(self, points: Array) -> Array:
        return self.bake.radiance(points, self.volume, self.back)

    def parts(self, truth: Truth, path: Truth) -> dict[str, float | None]:
        """Returns parts_of() the error of the bake. path: As for parts_of()."""
        error = self.bake.radiance_error(truth.points, self.volume)
        return parts_of(self.baked(truth.points), error, path, truth, self.bake.scene.exposure)

    def seen_from_outside(self, points: Array, seed: int) -> Array | None:
        """Returns a mask (n,) of points that can be seen from outside; None on the back."""
        if self.back:
            return None
        where = self._projected(points), self._own()
        seen: Array = _core.seen_from_outside(self._field(), *where, EXPOSURE_RAYS, seed) > 0
        return seen

    def _projected(self, points: Array) -> Array:
        return _core.project_to_isosurface(self._field(), points, self._own())

    def _own(self) -> float:
        return self.bake.isovalue_of(self.volume, self.isovalue)

    def _field(self) -> Field:
        return self.bake.volumes[self.volume].field()


class MeshSide:
    """The mesh of that name around the volumes. back: True for the side against its normals.

    The methods are those of IsosurfaceSide, without parts().
    """

    def __init__(self, bake: Bake, name: str, isovalue: float, back: bool = False) -> None:
        self.bake, self.isovalue, self.back = bake, isovalue, back
        self.number = bake.mesh_number(name)
        self.mesh = bake.scene.meshes[self.number]
        _check_diffuse(self.mesh)
        self.triangles = len(self.mesh.triangles)

    def path_traced(self, how: Sampling, progress: Progress | None) -> Truth:
        vertices, triangles = self.mesh.vertices, self.mesh.triangles
        facets, coordinates = random_places(vertices, triangles, how.points, how.seed)
        passes = min(PASSES, how.spp)
        places = np.tile(facets, passes), np.tile(coordinates, (passes, 1))
        work = -(-how.spp // passes), how.seed, how.threads, progress, self.back
        radiance, _ = self.bake.mesh_reference(self.number, places, self.isovalue, *work)
        return _of_passes(positions(vertices, triangles, facets, coordinates), radiance, passes)

    def by_cycles(self, sampling: Sampling, progress: Progress | None) -> Truth:
        target = Target(mesh=self.number, back=self.back)
        return _by_cycles(self.bake, self.isovalue, target, sampling, progress)

    def baked(self, points: Array) -> Array:
        return self.bake.mesh_radiance(self.number, points, self.isovalue, self.back)

    def seen_from_outside(self, points: Array, seed: int) -> None:
        return None


def _of_passes(points: Array, radiance: Array, passes: int) -> Truth:
    return Truth.of_passes(points, np.ones(len(points)), radiance.reshape(passes, -1, 3))


def _check_diffuse(item: Isosurfaces | Mesh) -> None:
    if item.scattering != "diffuse":
        raise LeaflightError(
            f'"{item.name}" is {item.scattering}, so its appearance depends on the view: choose a '
            "diffuse material."
        )


def _by_cycles(
    bake: Bake, isovalue: float, target: Target, sampling: Sampling, progress: Progress | None
) -> Truth:
    fields = [volume.field() for volume in bake.volumes]
    found = measure(bake.scene, fields, isovalue, target, sampling, progress=progress)
    return Truth.measured(found)
