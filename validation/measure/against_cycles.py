# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares default bakes with Cycles, volume by volume: docs/validation/cycles.md."""

import os

import numpy as np
from leaflight.bake.settings import DEFAULT_ERROR
from leaflight.measure.cycles import find_blender
from volume_recipes import absent_text
from written import parse_arguments, prepare, table, write

from .judged_bakes import (
    EXCEEDED,
    QUICK_CYCLES,
    REACHED,
    REPORTED,
    CyclesEffort,
    measure_against_cycles,
)

# Mean color below which a relative difference means nothing.
DARK = 0.01


def main():
    """Returns 1 if a bake has a larger error than its target but reported a smaller one."""
    options = parse_arguments(__doc__)
    find_blender()
    prepare(options.out, "cycles.md")
    effort = QUICK_CYCLES if options.quick else CyclesEffort()
    judged, absent = measure_against_cycles(effort, options.data)
    lines = [
        "# Against Cycles",
        "",
        f"Written by `validation/run against_cycles` on {os.cpu_count()} cores.",
        "",
        *cycles_text(judged, absent, effort),
    ]
    write(options.out, {"cycles.md": "\n".join(lines) + "\n"})
    print("\n".join(lines))
    return int(any(row.verdict == EXCEEDED for row in judged))


def bake_rows(rows):
    """Returns one row for each bake."""
    # Make one row per case, in the order of the cases.
    bakes = {row.bake.case.name: row.bake for row in rows}
    return [
        {
            "bake": name,
            "nodes": " x ".join(map(str, bake.nodes)),
            "texels": f"{bake.statistics.texels:,}",
            "passes": f"{bake.statistics.passes}",
            "estimated before %": f"{bake.before.error:.2f}",
            "estimated after %": f"{bake.after:.2f}",
        }
        for name, bake in bakes.items()
    ]


def cycles_rows(rows):
    """Returns one row for each isosurface that Cycles judged."""
    return [
        {
            "bake": ": ".join(filter(None, (row.bake.case.name, row.volume))),
            "isovalue": f"{row.isovalue:g}",
            "paths": f"{row.paths:,}",
            "RMS %": f"{row.errors['rms_percent']:.2f}",
            "mean off by %": "".join(f"{off:+.1f}" for off in _off_by(row)),
            "noise %": f"{row.parts['noise_percent']:.2f}",
            "texture %": f"{row.parts['texture_percent']:.2f}",
            "mesh %": f"{row.parts['mesh_percent']:.2f}",
            "noise of Cycles %": f"{row.errors['reference_noise_percent']:.2f}",
            "verdict": row.verdict,
        }
        for row in rows
    ]


def summary(rows):
    """Returns a paragraph about the isosurfaces."""
    errors = np.array([row.errors["rms_percent"] for row in rows])
    mesh = np.array([row.parts["mesh_percent"] for row in rows])
    own = np.sqrt(np.maximum(errors**2 - mesh**2, 0))
    noise = [row.parts["noise_percent"] for row in rows]
    off = [off for row in rows for off in _off_by(row)]
    exceeded = sum(row.verdict == EXCEEDED for row in rows)
    return (
        f"{sum(errors <= DEFAULT_ERROR)} of the {len(rows)} isosurfaces have an error of at most "
        f"{DEFAULT_ERROR:g} %, and {sum(errors <= 2.5)} one of at most 2.5 %; the median is "
        f"{np.median(errors):.1f} %. Without the part of the mesh, which no bake removes, these "
        f"are {sum(own <= DEFAULT_ERROR)}, {sum(own <= 2.5)} and {np.median(own):.1f} %. "
        f"Noise is {min(noise):.1f} to {max(noise):.1f} %. "
        f"{exceeded} err by more than {DEFAULT_ERROR:g} % where their bake reported less. The "
        f"light of {sum(abs(one) > 3 for one in off)} is off by more than 3 % on average."
    )


def cycles_text(rows, absent, effort):
    lines = [
        *([summary(rows), ""] if effort.judged and rows else []),
        "- Each bake has default settings and covers its default isovalue range. Cycles traces "
        f"*paths* at each of about {effort.points:,} random points of an isosurface's mesh. "
        "Blender builds the scene itself: marching cubes, smooth normals, caustics, no clamping "
        "and no denoising.",
        "- RMS % is the error of the colors (thesis Eq. 4.11, corrected), without subtraction. "
        '"Mean off by" is the relative error of the light of all points together. It is empty if '
        "there is hardly any light.",
        "- The square of RMS % is the sum of the squares of four parts, up to chance. *Noise* is "
        "the random error that the texels report. *Texture* is the rest of the difference between "
        "the bake and our path tracer on the isosurface: coarse texels, or bias. *Mesh* is the "
        "difference between our path tracer and Cycles, which sees triangles. *Noise of Cycles* "
        "is the noise of the reference.",
    ]
    if effort.judged:
        lines += [
            f"- The target of a default bake is {DEFAULT_ERROR:g} %. *{REACHED.capitalize()}*: the "
            f"error is not larger. *{REPORTED.capitalize()}*: it is larger, and the bake reported "
            f"it before (`--estimate`) and after. *{EXCEEDED.capitalize()}*: it is larger, and the "
            "bake did not report it.",
        ]
    lines += [
        "- *Estimated* is the error over the area of all isosurfaces of the range, before the "
        "bake starts and at its end. [Against paths](paths.md) compares it with the true one.",
    ]
    return [
        *lines,
        *absent_text(absent),
        "",
        *table(bake_rows(rows)),
        "",
        *table(cycles_rows(rows)),
    ]


def _off_by(row):
    """Returns [deviation of the mean in percent]; an empty list if everything is dark."""
    is_dark = row.errors["mean_radiance"] < DARK
    return [] if is_dark else [100 * (row.errors["mean_ratio"] - 1)]
