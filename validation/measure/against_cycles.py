# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares default bakes with Cycles, volume by volume: docs/validation/cycles.md."""

import os

import numpy as np
from leaflight.bake.settings import DEFAULT_ERROR
from leaflight.io.markdown import table
from leaflight.measure.cycles import find_blender
from volume_recipes import absent_text
from written import parse_arguments, prepare, write

from .judged_bakes import (
    EXCEEDED,
    QUICK_CYCLES,
    REACHED,
    REPORTED,
    TRUE_WITHIN,
    CyclesEffort,
    measure_against_cycles,
)

# Mean color below which a relative difference means nothing.
DARK = 0.01
BAKE_FORMATS = {
    "texels": "{:,}",
    "passes": "{}",
    "estimated before %": "{:.2f}",
    "estimated after %": "{:.2f}",
    "found %": "{:.2f}",
}
CYCLES_FORMATS = {
    "isovalue": "{:g}",
    "paths": "{:,}",
    "RMS %": "{:.2f}",
    "mean off by %": "{:+.1f}",
    "noise %": "{:.2f}",
    "texture %": "{:.2f}",
    "mesh %": "{:.2f}",
    "noise of Cycles %": "{:.2f}",
}


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
            "texels": bake.statistics.texels,
            "passes": bake.statistics.passes,
            "estimated before %": bake.before.error,
            "estimated after %": bake.after,
            "found %": bake.found,
            "true": "yes" if bake.true else "no",
        }
        for name, bake in bakes.items()
    ]


def cycles_rows(rows):
    """Returns one row for each isosurface that Cycles judged."""
    return [
        {
            "bake": ": ".join(filter(None, (row.bake.case.name, row.volume))),
            "isovalue": row.isovalue,
            "paths": row.paths,
            "RMS %": row.errors["rms_percent"],
            "mean off by %": _off_by(row.errors),
            "noise %": row.parts["noise_percent"],
            "texture %": row.parts["texture_percent"],
            "mesh %": row.parts["mesh_percent"],
            "noise of Cycles %": row.errors["reference_noise_percent"],
            "verdict": row.verdict,
        }
        for row in rows
    ]


def summary(rows):
    """Returns a paragraph about the rows of cycles_rows()."""
    errors = np.array([row["RMS %"] for row in rows])
    noise = [row["noise %"] for row in rows]
    off = [row["mean off by %"] for row in rows if row["mean off by %"] is not None]
    exceeded = sum(row["verdict"] == EXCEEDED for row in rows)
    return (
        f"{sum(errors <= DEFAULT_ERROR)} of the {len(rows)} isosurfaces have an error of at most "
        f"{DEFAULT_ERROR:g} %, and {sum(errors <= 2)} one of at most 2 %; the median is "
        f"{np.median(errors):.1f} %. Noise is {min(noise):.1f} to {max(noise):.1f} %. "
        f"{exceeded} err by more than {DEFAULT_ERROR:g} % where their bake reported less. The "
        f"light of {sum(abs(one) > 2 for one in off)} is off by more than 2 % on average."
    )


def cycles_text(rows, absent, effort):
    lines = [
        *([summary(cycles_rows(rows)), ""] if effort.judged and rows else []),
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
        "- *Estimated* is the error before the bake starts, and at its end. *Found* is the "
        "RMS over its isosurfaces below, without the noise of Cycles. *True*: "
        f"estimated after and found differ by a factor of {TRUE_WITHIN:g} at most.",
    ]
    return [
        *lines,
        *absent_text(absent),
        "",
        *table(bake_rows(rows), BAKE_FORMATS),
        "",
        *table(cycles_rows(rows), CYCLES_FORMATS),
    ]


def _off_by(errors):
    """Returns the deviation of the mean in percent; None if everything is dark."""
    return None if errors["mean_radiance"] < DARK else 100 * (errors["mean_ratio"] - 1)
