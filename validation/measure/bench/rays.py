# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench rays`: isosurface rays against Embree on the contoured mesh, on one thread.

A program of core/bench traces the same rays both ways, alternately: from points of the isosurface
into its front, cosine-distributed. Results are medians of processor time.
"""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from leaflight import LeaflightError, _core
from leaflight.volume.volume import bump_box
from written import table
from volume_recipes import absent_text, colin27, generated

from .page import measured_on

PROGRAM = "rays_against_embree"
# Name, volumes as in volume_recipes.py, isovalues.
CASES = (
    ("bump box, 100^3", generated(bump_box, 100), (20.0, 47.0, 100.0)),
    ("bump box, 256^3", generated(bump_box, 256), (47.0,)),
    ("Colin27 (ch2.nii.gz)", colin27, (24.5, 45.5, 70.5, 100.5, 150.5)),
)
QUICK_CASES = (("bump box, 16^3", generated(bump_box, 16), (20.0, 47.0, 100.0)),)
# Rays per isovalue, and number of repetitions.
RAYS, REPETITIONS = 50_000, 9
QUICK_RAYS, QUICK_REPETITIONS = 500, 3


def rays_section(options):
    """Returns lines of Markdown. Raises LeaflightError if the program is not built."""
    cases, rays, repetitions = CASES, RAYS, REPETITIONS
    if options.quick:
        cases, rays, repetitions = QUICK_CASES, QUICK_RAYS, QUICK_REPETITIONS
    rows, absent = [], []
    for name, recipe, isovalues in cases:
        volumes = recipe(options.data, 1.0)
        if volumes is None:
            absent.append(name)
        elif options.only in name:
            found = _traced(volumes[0], rays, repetitions, isovalues)
            rows += [_row(name, one, rays) for one in found if one["triangles"]]
    return [
        "## Rays against Embree",
        "",
        measured_on(),
        "",
        f"- {rays:,} rays start on the front of each isosurface, with a cosine "
        "distribution, on one thread. Embree's rays hit the contoured mesh (rtcIntersect1 and "
        "rtcOccluded1, a tree of high quality). Ours hit the isosurface of the volume itself, so "
        f"a new isovalue needs no tree. Processor seconds, medians of {repetitions} turns.",
        *absent_text(absent),
        "",
        *table(rows),
    ]


def _traced(volume, rays, repetitions, isovalues):
    """Returns the program's answer for each isovalue of a volume."""
    program = Path(_core.__file__).resolve().parents[2] / "core" / "bench" / PROGRAM
    if not program.exists():
        raise LeaflightError(f"{program} is absent; run 'cmake --build --preset bench'.")
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        path = Path(folder) / "values.f32"
        np.ascontiguousarray(volume.values, np.float32).tofile(path)
        numbers = (*volume.field().dims, rays, repetitions, *isovalues)
        done = subprocess.run([program, path, *map(str, numbers)], capture_output=True, text=True)
    if done.returncode != 0:
        raise LeaflightError(f"{PROGRAM} failed ({done.returncode}): {done.stderr.strip()}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def _row(name, found, rays):
    # Both must have the same hits, except for few rays that start under a triangle of the mesh.
    assert abs(found["intersect"]["hits"] - found["embree_intersect"]["hits"]) < 0.1 * rays
    assert found["intersect"]["hits"] == found["occluded"]["hits"]
    (speed, ratio), (of_occluded, ratio_of_occluded) = (
        _speeds(found, kind, rays) for kind in ("intersect", "occluded")
    )
    return {
        "isosurface": f"{name} at {found['isovalue']:g}",
        "triangles": f"{found['triangles']:,}",
        "million rays/s": f"{speed:.2f}",
        "over Embree's": f"{ratio:.2f}",
        "occluded, million rays/s": f"{of_occluded:.2f}",
        "over Embree's ": f"{ratio_of_occluded:.2f}",
    }


def _speeds(found, kind, rays):
    """Returns (million rays per second, ratio to Embree)."""
    ours, theirs = (float(np.median(found[name]["seconds"])) for name in (kind, f"embree_{kind}"))
    return rays / ours / 1e6, theirs / ours
