# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a bake is from the path-traced truth on one isosurface, or on a mesh around it."""

import time

from . import _core
from ._core import LeaflightError
from .cycles import measure
from .on_mesh import positions, random_places, random_points
from .truth import Truth, errors_of, parts_of

REFERENCES = ("path", "cycles")
# Random rays by which a point shows itself to the outside.
EXPOSURE_RAYS = 32


def compare(
    bake,
    isovalue,
    points=3000,
    spp=1024,
    seed=0,
    threads=0,
    progress=None,
    volume=0,
    back=False,
    mesh=None,
    reference="path",
):
    """Compares baked with path-traced radiance at random points of one volume's isosurface.

    back: on its inner side; mesh: the name of a mesh of the surroundings to compare on instead,
    back then being the side from which its normals point away. reference: "path", the core's own
    path tracer, or "cycles" (cycles.py). spp: paths a point. `isovalue` is the leaf coordinate, as
    everywhere in a Bake.

    The points are distributed by area over the marching-cubes triangles; the bake is looked up
    where the mesh is, the core's reference is traced from the leaf itself. Returns a dict with

    rms_percent              RMS error of the colours in percent (thesis Eq. 4.11, corrected: a
                             colour is radiance times exposure, clamped to 0..1)
    relative_rms             RMS error of the radiance over the mean radiance, nothing clamped;
                             None where all is dark
    reference_noise_percent  what the reference's own noise adds to rms_percent (RMS standard error)
    mean_radiance            mean of the reference colours before clamping
    mean_ratio               mean of the baked radiance over that of the reference; None where all
                             is dark
    mean_ratio_error         its standard error from the noise of the reference
    exposed                  the same six, and their points, over the points that can be seen from
                             outside the volume; a scan hides most of an isosurface in the dark;
                             None of the inner side and of meshes
    parts                    noise_percent, texture_percent and mesh_percent, of which rms_percent
                             and the reference's noise are the sum of squares (truth.py); None of
                             the inner side and of meshes
    and points, spp, reference, isovalue, triangles, bake_seconds, reference_seconds.
    Raises LeaflightError, Cancelled.
    """
    if points < 1 or spp < 2:
        raise LeaflightError("compare needs at least 1 point and 2 samples per point.")
    place = _OnLeaf(bake, isovalue, volume, back) if mesh is None else _OnMesh(bake, mesh, back)
    start = time.perf_counter()
    trace = {"path": place.path_traced, "cycles": place.by_cycles}[reference]
    truth = trace(isovalue, points, spp=spp, seed=seed, threads=threads, progress=progress)
    reference_seconds = time.perf_counter() - start
    baked, exposure = place.baked(isovalue, truth.points), bake.scene.exposure
    exposed = place.exposed(isovalue, truth.points, seed)
    parts = None
    if mesh is None and not back:
        path = truth
        if reference != "path":
            work = {"spp": spp, "seed": seed, "threads": threads, "progress": progress}
            path = place.path_traced_at(isovalue, truth.points, **work)
        error = bake.radiance_error(truth.points, volume)
        parts = parts_of(baked, error, path, truth, exposure)
    return {
        "isovalue": float(isovalue),
        "spp": int(spp),
        "reference": reference,
        "triangles": place.triangles,
        **errors_of(baked, truth, exposure),
        "parts": parts,
        "exposed": None if exposed is None else errors_of(baked, truth, exposure, exposed),
        "bake_seconds": bake.statistics["seconds"],
        "reference_seconds": reference_seconds,
    }


def _check_diffuse(look):
    if look.scattering != "diffuse":
        raise LeaflightError(
            f'What "{look.name}" shows depends on the view, since it is of {look.scattering}: '
            "choose something diffuse."
        )


class _OnLeaf:
    """The isosurface of a volume, on one side."""

    def __init__(self, bake, isovalue, volume, back):
        self.bake, self.volume, self.back = bake, volume, back
        self.surface = bake.surface(isovalue, volume, back)
        _check_diffuse(bake.scene.leaves[volume])
        self.triangles = len(self.surface.triangles)
        if self.triangles == 0:
            raise LeaflightError(
                f"Isovalue {isovalue:g} has no surface inside the data; choose another one."
            )

    def path_traced(self, isovalue, points, spp, seed, threads, progress):
        on_mesh = random_points(self.surface.vertices, self.surface.triangles, points, seed)
        return self.path_traced_at(isovalue, on_mesh, spp, seed, threads, progress)

    def path_traced_at(self, isovalue, on_mesh, spp, seed, threads, progress):
        """The same at the points of the leaf next to given ones of the mesh (n, 3)."""
        on_leaf = self._projected(isovalue, on_mesh)
        where = {"volume": self.volume, "back": self.back}
        found = self.bake.reference(on_leaf, isovalue, spp, seed, threads, progress, **where)
        return Truth.traced(on_mesh, *found)

    def by_cycles(self, isovalue, points, spp, **work):
        where = {"volume": self.volume, "back": self.back}
        return _by_cycles(self.bake, isovalue, points, spp, **where, **work)

    def baked(self, isovalue, points):
        return self.bake.radiance(points, self.volume, self.back)

    def exposed(self, isovalue, points, seed):
        """Which points can be seen from outside, a mask (n,); None of the inner side."""
        if self.back:
            return None
        field, own = self._field(), self.bake.isovalue_of(self.volume, isovalue)
        on_leaf = self._projected(isovalue, points)
        return _core.exposed(field, on_leaf, own, EXPOSURE_RAYS, seed) > 0

    def _projected(self, isovalue, points):
        own = self.bake.isovalue_of(self.volume, isovalue)
        return _core.project_to_leaf(self._field(), points, own)

    def _field(self):
        return self.bake.volumes[self.volume].field()


class _OnMesh:
    """A mesh of the surroundings, on one side."""

    def __init__(self, bake, name, back):
        self.bake, self.back, self.number = bake, back, bake.mesh_number(name)
        self.mesh = bake.scene.meshes[self.number]
        _check_diffuse(self.mesh)
        self.triangles = len(self.mesh.triangles)

    def path_traced(self, isovalue, points, spp, seed, threads, progress):
        vertices, triangles = self.mesh.vertices, self.mesh.triangles
        places = random_places(vertices, triangles, points, seed)
        found = self.bake.mesh_reference(
            self.number, *places, isovalue, spp, seed, threads, progress, back=self.back
        )
        return Truth.traced(positions(vertices, triangles, *places), *found)

    def by_cycles(self, isovalue, points, spp, **work):
        where = {"mesh": self.number, "back": self.back}
        return _by_cycles(self.bake, isovalue, points, spp, **where, **work)

    def baked(self, isovalue, points):
        return self.bake.mesh_radiance(self.number, points, isovalue, self.back)

    def exposed(self, isovalue, points, seed):
        return None


def _by_cycles(bake, isovalue, points, spp, **where):
    fields = [volume.field() for volume in bake.volumes]
    return Truth.measured(
        measure(bake.scene, fields, isovalue, points=points, samples=spp, **where)
    )
