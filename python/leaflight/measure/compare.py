# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the error of a bake on one isosurface, or on a mesh around it, by a reference."""

import time
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

    isovalue: The common isovalue, as everywhere in a Bake.
    back: True for the back.
    mesh: Name of a mesh of the walls to compare instead. Its back is the side that its normals
        point away from.
    reference: "path", the path tracer of the core, or "cycles" (cycles.py).
    progress: As for bake().
    sampling: Fields of Sampling by name: points (3000), spp (paths per point, 1024), seed, threads.
    Returns a dict, as follows. Raises LeaflightError, Cancelled.

    Points are uniform over the area of the marching-cubes triangles. The bake is looked up on the
    mesh; the path tracer starts on the isosurface itself. Points inside another volume's isosurface
    do not count.

    rms_percent: RMS error of the colors in percent (thesis Eq. 4.11, corrected). A color is
        radiance times exposure, clamped to 0..1.
    relative_rms: RMS error of the radiance over the mean radiance, nothing clamped. None if all is
        dark.
    reference_noise_percent: Contribution of the reference's noise to rms_percent (RMS standard
        error).
    mean_radiance: Mean of the reference colors before clamping.
    mean_ratio: Mean of the baked radiance over that of the reference. None if all is dark.
    mean_ratio_error: Its standard error from the noise of the reference.
    exposed: The same six, and the number of points, over points that can be seen from outside the
        volume. Most of an isosurface of a scan is hidden in the dark. None for backs and meshes.
    parts: Dict of noise_percent, texture_percent and mesh_percent (truth.py). Their squares and
        that of the reference's noise add up to that of rms_percent. None for backs and meshes.
    points, spp, reference, isovalue, triangles, bake_seconds, reference_seconds: Further facts.
    """
    how = Sampling(**sampling)
    if how.points < 1 or how.spp < 2:
        raise LeaflightError(
            "The number of points or samples is too small: give at least 1 point and 2 samples "
            "per point."
        )
    side: IsosurfaceSide | MeshSide
    if mesh is None:
        side = IsosurfaceSide(bake, isovalue, volume, back)
    else:
        side = MeshSide(bake, mesh, isovalue, back)
    start = time.perf_counter()
    trace = {"path": side.path_traced, "cycles": side.by_cycles}[reference]
    truth = trace(how, progress)
    reference_seconds = time.perf_counter() - start
    baked, exposure = side.baked(truth.points), bake.scene.exposure
    exposed = side.seen_from_outside(truth.points, how.seed)
    parts = None
    if isinstance(side, IsosurfaceSide) and not back:
        path = truth if reference == "path" else side.path_traced_at(truth.points, how, progress)
        parts = side.parts(truth, path)
    return {
        "isovalue": float(isovalue),
        "spp": int(how.spp),
        "reference": reference,
        "triangles": side.triangles,
        **errors_of(baked, truth, exposure),
        "parts": parts,
        "exposed": None if exposed is None else errors_of(baked, truth, exposure, exposed),
        "bake_seconds": bake.statistics.seconds,
        "reference_seconds": reference_seconds,
    }
