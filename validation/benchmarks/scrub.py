# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench scrub`: a new isovalue, until its lit mesh is there; VTK beside it, and inside Blender.

Outside Blender a case is contouring and the lookup of baked radiance at the vertices. VTK does the
same with FlyingEdges3D and ProbeFilter, in turns with us. Inside Blender it is what its user waits
for before the drawing: all from the slider's change to the evaluated mesh.
"""

import time
from dataclasses import dataclass

import numpy as np

from leaflight.bake.bake import bake
from volume_recipes import colin27, generated
from leaflight.volume.volume import bump_box
from .blender_scrub import scrub_in_blender
from .vtk_peer import VtkPeer

# Little work: the seconds of a lookup do not depend on the noise.
_LEAST = {"error": 20.0}


@dataclass(frozen=True)
class ScrubEffort:
    """volumes: see volume_recipes.py; isovalues: of the cases; blender_isovalues: of those inside
    Blender; repetitions: of each.
    """

    name: str = "Colin27 (ch2.nii.gz)"
    volumes: object = colin27
    isovalues: tuple = (24.5, 45.5, 70.5, 100.5, 150.5)
    blender_isovalues: tuple = (45.5, 150.5)
    repetitions: int = 7


# Effort without Colin27: a generated volume with as many triangles.
GENERATED = ScrubEffort(
    "bump box, 256^3", generated(bump_box, 256), (20.0, 47.0, 100.0), blender_isovalues=(20.0,)
)
QUICK_SCRUB = ScrubEffort("bump box, 24^3", generated(bump_box, 24), (47.0, 100.0), (47.0,), 2)


def measure_scrub(effort, run, *, folder=None, seed=0, threads=0):
    """Measures changes of the isovalue; returns a dict.

    cases: dicts of name, isovalue, triangles, milliseconds and vtk_milliseconds (medians by the
        clock), vtk_ratio (VTK's time over ours, median of the turns)
    vtk_ratio: the least vtk_ratio of the cases
    absent: names of the volumes that are absent
    blender: list of the results of scrub_in_blender()

    run(work, label) returns work(progress). Raises LeaflightError, also without Blender, VTK or the
    add-on's source, and Cancelled.
    """
    volumes = effort.volumes(folder, 1.0)
    absent = []
    if volumes is None:
        absent, effort = [effort.name], GENERATED
        volumes = effort.volumes(folder, 1.0)
    (volume,) = volumes
    low, high = min(effort.isovalues), max(effort.isovalues)
    baked = run(
        lambda progress: bake(
            volume,
            isovalues=(low - 1, high + 1),
            seed=seed,
            threads=threads,
            progress=progress,
            **_LEAST,
        ),
        f"bench: {effort.name}, bake",
    )
    grid = baked.grids[0]
    with VtkPeer(volume.values, grid.dense("radiance")) as peer:
        cases = [
            run(lambda _, c=c: _case(effort, volume.field(), grid, c, peer), f"bench: {c:g}")
            for c in effort.isovalues
        ]
    blender = [
        run(
            lambda progress, c=c: scrub_in_blender(baked, c, effort.repetitions, progress),
            f"bench: {c:g} in Blender",
        )
        for c in effort.blender_isovalues
    ]
    return {
        "cases": cases,
        "vtk_ratio": min(case["vtk_ratio"] for case in cases),
        "blender": blender,
        "absent": absent,
    }


def _case(effort, field, grid, isovalue, peer):
    # Each once before, so that neither has yet to find its memory.
    triangles, theirs = _ours(field, grid, isovalue)[1], peer.milliseconds(isovalue)
    pairs = []
    for _ in range(effort.repetitions):
        pairs.append((_ours(field, grid, isovalue)[0], peer.milliseconds(isovalue)))
    ours, theirs = np.transpose(pairs)
    return {
        "name": effort.name,
        "isovalue": isovalue,
        "triangles": triangles,
        "milliseconds": float(np.median(ours)),
        "vtk_milliseconds": float(np.median(theirs)),
        "vtk_ratio": float(np.median(theirs / ours)),
    }


def _ours(field, grid, isovalue):
    """Returns (milliseconds, triangles)."""
    start = time.perf_counter()
    triangles = grid.lit_contour(field, isovalue)[2]
    return 1e3 * (time.perf_counter() - start), len(triangles)
