# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench rays`: isosurface rays beside Embree on the contoured mesh, on one thread.

A program of core/bench traces the same rays both ways, in turns: from points of the isosurface into
its front, distributed by the cosine. Seconds are of the processor, medians.
"""

import json
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from leaflight import _core
from leaflight._core import Cancelled, LeaflightError
from volume_recipes import colin27, generated
from leaflight.volume.volume import bump_box

PROGRAM = "rays_against_embree"
POLL_SECONDS = 0.05
KINDS = ("intersect", "occluded")


@dataclass(frozen=True)
class RayCase:
    """volumes(folder, fineness): see volume_recipes.py; isovalues: each is measured."""

    name: str
    volumes: object
    isovalues: tuple


@dataclass(frozen=True)
class RayEffort:
    """rays: of each isovalue; repetitions: how often all are traced."""

    cases: tuple = (
        RayCase("bump box, 100^3", generated(bump_box, 100), (20.0, 47.0, 100.0)),
        RayCase("bump box, 256^3", generated(bump_box, 256), (47.0,)),
        RayCase("Colin27 (ch2.nii.gz)", colin27, (24.5, 45.5, 70.5, 100.5, 150.5)),
    )
    rays: int = 50_000
    repetitions: int = 9


QUICK_RAYS = RayEffort(
    (replace(RayEffort.cases[0], name="bump box, 16^3", volumes=generated(bump_box, 16)),), 500, 3
)


def measure_rays(effort, run, *, folder=None):
    """Returns (rows, absent): a dict for each isovalue, and the names of volumes not at hand.

    folder: with the files of real volumes, or None; run(work, label) returns work(progress). A row:
    name, isovalue, nodes, triangles; rays; for intersect and occluded rays_per_second_* and
    embree_*, ratio_* (Embree's seconds over ours), hits_* and embree_hits_*; repetitions.

    Raises LeaflightError, also where the program is not built, and Cancelled.
    """
    rows, absent = [], []
    for case in effort.cases:
        volumes = case.volumes(folder, 1.0)
        if volumes is None:
            absent.append(case.name)
            continue
        label = f"bench: {case.name}, rays"
        found = run(lambda progress: _traced(volumes[0], case, effort, progress), label)
        nodes = list(volumes[0].field().dims)
        rows.extend(_row(case, nodes, one, effort) for one in found if one["triangles"])
    return rows, absent


def program():
    """Returns the path of the program. Raises LeaflightError where it is not built."""
    path = Path(_core.__file__).resolve().parents[2] / "core" / "bench" / PROGRAM
    if not path.exists():
        raise LeaflightError(
            f"{path}: bench rays needs this program; run 'cmake --build --preset bench'."
        )
    return path


def _traced(volume, case, effort, progress):
    """Returns the program's answer for each isovalue of a case."""
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        path = Path(folder) / "values.f32"
        np.ascontiguousarray(volume.values, np.float32).tofile(path)
        numbers = (*volume.field().dims, effort.rays, effort.repetitions, *case.isovalues)
        command = [str(program()), str(path), *map(str, numbers)]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process:
            while True:
                try:
                    answers, problem = process.communicate(timeout=POLL_SECONDS)
                    break
                except subprocess.TimeoutExpired:
                    if progress.cancelled:
                        process.kill()
                        raise Cancelled("The measurement was cancelled.") from None
    if process.returncode != 0:
        raise LeaflightError(f"{PROGRAM} failed ({process.returncode}): {problem.strip()}")
    return [json.loads(line) for line in answers.splitlines()]


def _row(case, nodes, found, effort):
    row = {
        "name": f"{case.name} at {found['isovalue']:g}",
        "isovalue": found["isovalue"],
        "nodes": nodes,
        "triangles": found["triangles"],
        "rays": effort.rays,
        "repetitions": effort.repetitions,
    }
    for kind in KINDS:
        ours, peer = found[kind], found[f"embree_{kind}"]
        seconds, of_peer = (float(np.median(one["seconds"])) for one in (ours, peer))
        row[f"rays_per_second_{kind}"] = effort.rays / seconds
        row[f"embree_rays_per_second_{kind}"] = effort.rays / of_peer
        row[f"ratio_{kind}"] = of_peer / seconds
        row[f"hits_{kind}"], row[f"embree_hits_{kind}"] = ours["hits"], peer["hits"]
    return row
