# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes errors against seconds of all methods and Cycles, and the data sets of the thesis.

A row is a dict of the cells by the names of the columns.
"""

import os
import shutil
from dataclasses import dataclass

import numpy as np
from volume_recipes import absent_text
from written import parse_arguments, prepare, table, write

from . import plots
from .curves import (
    BAKE,
    CYCLES,
    GATHER,
    PHOTONS,
    QUICK_CURVES,
    RAYS,
    CurveEffort,
    measure_curves,
)
from .data_sets import QUICK_DATA, DataEffort, measure_data_sets
from .fits import break_even, cost, noise_and_floor, root, samples_for, slope

# Smallest and largest break-even number of isosurfaces in the thesis.
THESIS_BREAK_EVEN = (3, 11)
# Relative variation of seconds from run to run on a shared machine (95 %).
SECONDS_VARY = 0.1
MEBIBYTE = 2**20
NO_BLENDER = "There is no Blender on the search path, so this section is empty."


def main():
    options = parse_arguments(__doc__)
    prepare(options.out, "report.md")
    curve_effort, data_effort = CurveEffort(), DataEffort()
    if options.quick:
        curve_effort, data_effort = QUICK_CURVES, QUICK_DATA
    curves = measure_curves(curve_effort, cycles=shutil.which("blender") is not None)
    rows, absent = measure_data_sets(data_effort, options.data)
    analysis = analysed(curves)
    parts = {
        "Error against seconds": curves_text(curves),
        "Convergence": slopes_text(curves, analysis),
        "One bake against Cycles": break_even_text(analysis),
        "The thesis's data sets (Fig. 5.14)": data_text(rows, absent, data_effort),
    }
    lines = [
        "# Report",
        "",
        f"Written by `validation/run report{' --quick' * options.quick}` on {os.cpu_count()} "
        "cores, from nothing but the program, the data and the seed: errors come out the same in "
        "every run, seconds do not.",
    ]
    for title, part in parts.items():
        lines += ["", f"## {title}", "", *part]
    files = {
        "images/curves.png": plots.error_against_seconds(curves),
        "images/convergence.png": plots.convergence(curves, analysis.errors),
        "report.md": "\n".join(lines) + "\n",
    }
    if analysis.break_even:
        files["images/break_even.png"] = plots.break_even(analysis.break_even, THESIS_BREAK_EVEN)
    write(options.out, files)
    print("\n".join(lines))


@dataclass(frozen=True, eq=False)
class Analysis:
    """Conclusions from the curves.

    slopes: Estimates of the slope of each curve's noise; errors and costs: Fits by name, without
    leaflight.bake, whose passes follow from its error; break_even: rows, dicts.
    """

    slopes: dict
    errors: dict
    costs: dict
    break_even: list


def analysed(curves):
    """Returns the Analysis of Curves."""
    slopes, errors, costs = {}, {}, {}
    for curve in _sampled(curves):
        name, samples = curve.name, [point.samples for point in curve.points]
        slopes[name] = slope(samples, [point.noise for point in curve.points])
        values = [point.error for point in curve.points]
        errors[name] = noise_and_floor(samples, values, slopes[name].value)
        costs[name] = cost(samples, [point.seconds for point in curve.points])
    return Analysis(slopes, errors, costs, list(_break_even_rows(curves, errors, costs)))


def _sampled(curves):
    """Returns the curves whose number of samples varies."""
    return [curve for curve in curves.curves if curve.name != BAKE]


def _break_even_rows(curves, errors, costs):
    """Yields one row for each bake by leaflight.bake and by the thesis's default estimator."""
    cycles = curves.of(CYCLES)
    if cycles is None:
        return
    least = min(point.error for point in cycles.points)
    bakes = filter(None, (curves.of(name) for name in (BAKE, GATHER)))
    for curve, point in ((curve, point) for curve in bakes for point in curve.points):
        isosurfaces = break_even(
            point.error, point.seconds, errors[CYCLES], costs[CYCLES], SECONDS_VARY
        )
        yield {
            "bake": curve.name,
            "samples": f"{point.samples} {curve.unit}",
            "RMS %": point.error,
            "seconds": point.seconds,
            "isosurfaces": isosurfaces,
            "beyond what Cycles was measured at": "yes" if point.error < least else "",
        }


def curve_rows(curves):
    """Returns one row for each point of each curve."""
    return [
        {
            "curve": curve.name,
            "samples": f"{point.samples}",
            "rays": None if point.costs[0].rays is None else f"{point.costs[0].rays:,}",
            "seconds": f"{point.seconds:.2f}",
            "fastest": f"{min(cost.seconds for cost in point.costs):.2f}",
            "slowest": f"{max(cost.seconds for cost in point.costs):.2f}",
            "RMS %": f"{point.error:.2f}",
            "noise %": f"{point.noise:.2f}",
            "peak MiB": f"{point.peak / MEBIBYTE:.0f}",
            "file MiB": point.costs[0].file and f"{point.costs[0].file / MEBIBYTE:.1f}",
        }
        for curve in curves.curves
        for point in curve.points
    ]


def curves_text(curves):
    effort, reference = curves.effort, curves.reference
    repetitions = f"{effort.repetitions} repetitions with other seeds"
    isovalues = ", ".join(f"{one.isovalue:g}" for one in reference.surfaces)
    return [
        "![RMS error against seconds of a processor](images/curves.png)",
        "",
        f"- Each bake lights all isosurfaces of the bump box, with {effort.texels}^3 nodes. The "
        f"error is measured at {len(reference.truth)} vertices of the isosurfaces "
        f"{isovalues}, against {reference.paths:,} paths at each. The mean color is "
        f"{reference.color:.2f}. The noise of the reference is {reference.noise:.2f} % and is not "
        "subtracted.",
        f"- {BAKE} has default settings, but for its texels: their number per axis is in the "
        "column *samples*. The others are the methods of the thesis, with as many texels as nodes. "
        "Along each curve of theirs the rays of a texel double, and so do the photons, with "
        f"{PHOTONS:,} for each ray. Scattered samples have {RAYS} rays each, and the same number "
        "of rays in all. Their filter is Shepard's of 3 texels.",
        f"- Seconds are processor time of all threads, medians of {repetitions}, one curve after "
        f"the other in turn. On a shared machine they vary by some {100 * SECONDS_VARY:.0f} %, or "
        "more if both threads of a core are busy.",
        f"- {CYCLES}: a background Blender bakes the vertices of the same isosurface's mesh, with "
        "caustics, without clamping or denoising. The clock starts after the setup of the scene "
        "and a first pass. Seconds are the mean of the isosurfaces. Cycles bakes each corner of a "
        "triangle, about six at a vertex. Its error includes that of the mesh.",
        "",
        *table(curve_rows(curves)),
    ]


def slope_rows(curves, analysis):
    """Returns one row for each curve: slopes and floors, with their intervals."""
    rows = []
    for curve in _sampled(curves):
        samples = [point.samples for point in curve.points]
        fit, last = analysis.errors[curve.name], curve.points[-1]
        floor = root(fit.interval(0))
        of_error = slope(samples, [point.error for point in curve.points])
        rest = np.sqrt(max(0.0, last.error**2 - last.noise**2))
        enough = samples_for(np.sqrt(2.0) * floor.value, fit) if floor.value > 0 else np.inf
        rows.append(
            {
                "curve": curve.name,
                "slope of the error": _interval(of_error, ".2f"),
                "slope of the noise": _interval(analysis.slopes[curve.name], ".2f"),
                "floor, %": _interval(floor, ".2f"),
                "samples for noise = floor": f"{enough:.0f}",
                "most samples": f"{last.samples}",
                "error less noise there, %": f"{rest:.2f}",
            }
        )
    return rows


def slopes_text(curves, analysis):
    return [
        "![Error and noise against samples, with fits](images/convergence.png)",
        "",
        "- Samples are rays for each texel; for Cycles they are paths at each corner of a "
        "triangle. Slopes are d log / d log samples by least squares, with 95 % intervals "
        "(Student's t). Random samples have -0.5. Evenly spread samples and more photons together "
        "are steeper. Clamped colors make large errors smaller and slopes flatter. The noise is "
        "the deviation among seeds, without the reference or the floor.",
        "- The floor is the error with very many samples. It comes from a fit of error^2 = "
        "floor^2 + a samples^(2 slope), with the slope of the noise. It includes texture, bias "
        f"and the noise of the reference ({curves.reference.noise:.2f} %).",
        "- The last column is the floor without a fit, from the squares of error and noise with "
        "the most samples.",
        "",
        *table(slope_rows(curves, analysis)),
    ]


def break_even_text(analysis):
    low, high = THESIS_BREAK_EVEN
    if not analysis.break_even:
        return [NO_BLENDER]
    return [
        "![Isosurfaces after which a bake is worth it](images/break_even.png)",
        "",
        "- *Isosurfaces* is the number that Cycles renders in the time of one bake of all of them, "
        "with the same error. It is the seconds of the bake over those of Cycles for one "
        "isosurface, by fits of its error and seconds against samples. The thesis states "
        f"{low} to {high}.",
        "- The 95 % intervals include the covariances of the fits and a variation of seconds by "
        f"{100 * SECONDS_VARY:.0f} % between runs. A value of 0 means that Cycles does not reach "
        "the error, because of the triangles of its mesh.",
        "",
        *table(
            [
                {
                    **row,
                    "RMS %": f"{row['RMS %']:.2f}",
                    "seconds": f"{row['seconds']:.2f}",
                    "isosurfaces": _interval(row["isosurfaces"], ".1f"),
                }
                for row in analysis.break_even
            ]
        ),
    ]


def _interval(estimate, form):
    low, value, high = (
        format(number, form) for number in (estimate.low, estimate.value, estimate.high)
    )
    return f"{value} ({low} .. {high})"


def data_rows(rows):
    """Returns one row for each data set."""
    result = []
    for row in rows:
        printed = row.data_set.printed
        result.append(
            {
                "data set": row.data_set.name,
                "isovalues": ", ".join(f"{c:g}" for c in row.data_set.isovalues),
                "texels": f"{row.texels:,}",
                "bake s": f"{row.cost.seconds:.1f}",
                "direct s": f"{row.direct:.1f}",
                "estimated %": f"{row.estimated:.2f}",
                "RMS %": f"{row.error:.2f}",
                "of which noise %": f"{row.noise:.2f}",
                "mean color": f"{row.color:.2f}",
                "break-even": f"{row.break_even:.1f}",
                "peak MiB": f"{row.cost.peak / MEBIBYTE:.0f}",
                "file MiB": f"{row.cost.file / MEBIBYTE:.1f}",
                "thesis bake s": printed and f"{printed.bake:.0f}",
                "thesis direct s": printed and f"{printed.direct:.0f}",
                "thesis RMS %": printed and f"{printed.error:.2f}",
                "thesis break-even": printed and f"{printed.bake / printed.direct:.1f}",
            }
        )
    return result


def data_text(rows, absent, effort):
    lines = [
        "- Bakes have default settings. The four of the thesis cover the whole range of isovalues. "
        "*Estimated* is the error that the bake reports at its end. The true one is measured at "
        f"up to {effort.vertices} vertices of the isosurfaces, against {effort.paths:,} paths at "
        "each.",
        '- "Direct" is the time in which our path tracer lights the vertices of one isosurface to '
        "the error of the bake. It follows from its time for a path and its noise. Seconds are "
        "processor time of all threads. Those of the thesis are of two Pentium 4 Xeon of 3 GHz. "
        "Break-even is bake s over direct s.",
        "- Only the brain of the thesis's volumes is public. The others are generated stand-ins "
        "of the same kind and size. RMS % grows with the brightness of a scene, which the thesis "
        "does not state. Isovalues of two volumes are from 0 to 1 over the range of each.",
        "- The peak is the most memory of the process during the bake, with Python, its modules "
        "and the volume. The file holds the radiance and the volume, compressed.",
    ]
    return [*lines, *absent_text(absent), "", *table(data_rows(rows))]
