# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench scrub`: time from a new isovalue to its lit mesh, against VTK and inside Blender.

Outside Blender, it is contouring and the lookup of baked radiance at the vertices. VTK does the
same with FlyingEdges3D and ProbeFilter, alternately. Inside Blender, it is the wait before the
drawing: from the slider's change to the evaluated mesh.
"""

import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import driver
import numpy as np
from leaflight import _core
from leaflight.bake.bake import bake
from leaflight.volume.volume import bump_box
from written import table
from volume_recipes import absent_text, colin27, generated

from .page import measured_on
from .vtk_peer import VtkPeer

SCRIPT = Path(__file__).with_name("scrub_scene.py")
# Settings of a coarse bake, because the time of a lookup does not depend on the noise.
LEAST_WORK = {"error": 20.0, "progress": False}


@dataclass(frozen=True)
class Effort:
    """The effort. volumes: see volume_recipes.py; repetitions: per isovalue."""

    name: str = "Colin27 (ch2.nii.gz)"
    volumes: Callable = colin27
    isovalues: tuple = (24.5, 45.5, 70.5, 100.5, 150.5)
    isovalues_in_blender: tuple = (45.5, 150.5)
    repetitions: int = 7


# The effort without Colin27: a generated volume with as many triangles.
GENERATED = Effort(
    "bump box, 256^3", generated(bump_box, 256), (20.0, 47.0, 100.0), isovalues_in_blender=(20.0,)
)
QUICK = Effort("bump box, 24^3", generated(bump_box, 24), (47.0, 100.0), (47.0,), 2)


def scrub_section(options):
    """Returns lines of Markdown. Raises LeaflightError without VTK or without Blender."""
    effort = QUICK if options.quick else Effort()
    volumes, absent = effort.volumes(options.data, 1.0), []
    if volumes is None:
        absent, effort = [effort.name], GENERATED
        volumes = effort.volumes(options.data, 1.0)
    (volume,) = volumes
    isovalue_range = min(effort.isovalues) - 1, max(effort.isovalues) + 1
    baked = bake(volume, isovalues=isovalue_range, **LEAST_WORK)
    grid = baked.grids[0]
    with VtkPeer(volume.values, grid.dense("radiance")) as peer:
        rows = [_row(effort, volume.field(), grid, c, peer) for c in effort.isovalues]
    version, inside = _in_blender(baked, effort)
    return [
        "## Isovalues",
        "",
        measured_on(),
        "",
        "- Times are wall-clock medians of contouring and lookup of the radiance at the vertices. "
        "VTK's FlyingEdges3D and ProbeFilter take turns with ours; the ratio is that of a turn.",
        f"- The second table is of Blender {version}, from the slider to "
        "the evaluated mesh, before any drawing.",
        *absent_text(absent),
        "",
        *table(rows),
        "",
        *table(inside),
    ]


def _row(effort, field, grid, isovalue, peer):
    # Run each once before, so that both have allocated their memory.
    triangles, theirs = _ours(field, grid, isovalue)[1], peer.contour(isovalue)[1]
    plain = len(_core.contour(field, isovalue)[2])
    assert abs(plain - theirs) < 0.02 * plain, f"VTK has {theirs} triangles, not {plain}"
    pairs = [
        (_ours(field, grid, isovalue)[0], peer.contour(isovalue)[0])
        for _ in range(effort.repetitions)
    ]
    ours, theirs = np.transpose(pairs)
    return {
        "volume": f"{effort.name} at {isovalue:g}",
        "triangles": f"{triangles:,}",
        "ms": f"{np.median(ours):.0f}",
        "VTK ms": f"{np.median(theirs):.0f}",
        "VTK / ours": f"{np.median(theirs / ours):.2f}",
    }


def _ours(field, grid, isovalue):
    """Returns (milliseconds, triangles)."""
    start = time.perf_counter()
    triangles = grid.lit_contour(field, isovalue)[2]
    return 1e3 * (time.perf_counter() - start), len(triangles)


def _in_blender(baked, effort):
    """Returns (version, rows) of measurements in Blender with the add-on."""
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        blender = driver.with_addon(Path(folder, "blender"))
        baked.save(Path(folder, "bake.vdb"))
        work = {
            "bake": f"{folder}/bake.vdb",
            "isovalues": effort.isovalues_in_blender,
            "repetitions": effort.repetitions,
            "rows": f"{folder}/rows.json",
        }
        blender.run(*driver.NAMED, "--python", SCRIPT, "--", json.dumps(work))
        return blender.about["blender"], json.loads(Path(work["rows"]).read_text())
