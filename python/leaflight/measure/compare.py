# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a bake is from the path-traced truth on one isosurface, or on a mesh around it."""

import time
from dataclasses import astuple
from typing import TYPE_CHECKING, Any

from .._core import LeaflightError, Progress
from ..bake.baked import Bake
from ..progress_bar import with_progress
from .sampling import Sampling, SamplingOptions
from .sides import IsosurfaceSide, MeshSide
from .truth import errors_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_progress("compare")
def compare(
    bake: Bake,
    isovalue: float,
    *,
    volume: int = 0,
    back: bool = False,
    mesh: str | None = None,
    reference: str = "path",
    progress: Progress | None = None,
    **sampling: "Unpack[SamplingOptions]",
) -> dict[str, Any]:
    """Compares baked with path-traced radiance at random points of one volume's isosurface.

    back: on its back; mesh: the name of a mesh of the walls to compare on instead,
    back then being the side from which its normals point away. reference: "path", the core's own
    path tracer, or "cycles" (cycles.py). progress: as of leaflight.bake.
    sampling: Sampling by its names: points (3000), spp, paths a point (1024), seed, threads.
    `isovalue` is the common isovalue, as everywhere in a Bake.

    The points are distributed by area over the marching-cubes triangles; the bake is looked up
    where the mesh is, the core's reference is traced from the isosurface itself. Points inside
    another volume's isosurface do not count. Returns a dict with

    rms_percent              RMS error of the colors in percent (thesis Eq. 4.11, corrected: a
                             color is radiance times exposure, clamped to 0..1)
    relative_rms             RMS error of the radiance over the mean radiance, nothing clamped;
                             None where all is dark
    reference_noise_percent  what the reference's own noise adds to rms_percent (RMS standard error)
    mean_radiance            mean of the reference colors before clamping
    mean_ratio               mean of the baked radiance over that of the reference; None where all
                             is dark
    mean_ratio_error         its standard error from the noise of the reference
    exposed                  the same six, and their points, over the points that can be seen from
                             outside the volume; a scan hides most of an isosurface in the dark;
                             None of the back and of meshes
    parts                    noise_percent, texture_percent and mesh_percent, of which rms_percent
                             and the reference's noise are the sum of squares (truth.py); None of
                             the back and of meshes
    and points, spp, reference, isovalue, triangles, bake_seconds, reference_seconds.
    Raises LeaflightError, Cancelled.
    """
    points, spp, seed, threads = astuple(Sampling(**sampling))
    if points < 1 or spp < 2:
        raise LeaflightError("compare needs at least 1 point and 2 samples per point.")
    side: IsosurfaceSide | MeshSide
    if mesh is None:
        side = IsosurfaceSide(bake, isovalue, volume, back)
    else:
        side = MeshSide(bake, mesh, isovalue, back)
    work = spp, seed, threads, progress
    start = time.perf_counter()
    trace = {"path": side.path_traced, "cycles": side.by_cycles}[reference]
    truth = trace(points, *work)
    reference_seconds = time.perf_counter() - start
    baked, exposure = side.baked(truth.points), bake.scene.exposure
    exposed = side.exposed(truth.points, seed)
    parts = None
    if isinstance(side, IsosurfaceSide) and not back:
        path = truth if reference == "path" else side.path_traced_at(truth.points, *work)
        parts = side.parts(truth, path)
    return {
        "isovalue": float(isovalue),
        "spp": int(spp),
        "reference": reference,
        "triangles": side.triangles,
        **errors_of(baked, truth, exposure),
        "parts": parts,
        "exposed": None if exposed is None else errors_of(baked, truth, exposure, exposed),
        "bake_seconds": bake.statistics.seconds,
        "reference_seconds": reference_seconds,
    }
