# SPDX-License-Identifier: GPL-3.0-or-later
"""The sections of the report on curves, fits, data sets and memory: Markdown and rows for CSV.

A row is a dict of the cells by the names of the columns.
"""

from dataclasses import dataclass

import numpy as np

from ..io.markdown import table
from ..measure.volume_recipes import absent_text
from .curves import CYCLES, DEFAULT, PHOTONS, RAYS
from .fits import break_even, cost, noise_and_floor, root, samples_for, slope

# From how many to how many isosurfaces the thesis breaks even.
THESIS_BREAK_EVEN = (3, 11)
# The bakes that are held against Cycles.
WORTH = (DEFAULT, f"{DEFAULT}, spacing 2")
# By which share seconds vary from run to run on a shared machine (95 %).
SECONDS_VARY = 0.1
MEBIBYTE = 2**20
NO_BLENDER = "There is no Blender on the search path, so that nothing can be said of Cycles."


@dataclass(frozen=True, eq=False)
class Analysis:
    """What the curves tell.

    slopes: Estimates of the slope of each curve's noise, errors and costs: Fits, by name;
    break_even: rows, dicts.
    """

    slopes: dict
    errors: dict
    costs: dict
    break_even: list


def analysed(curves, seed):
    """The Analysis of Curves."""
    slopes, errors, costs = {}, {}, {}
    for curve in curves.curves:
        name, samples = curve.name, [point.samples for point in curve.points]
        slopes[name] = slope(samples, [point.noise for point in curve.points])
        values = [point.error for point in curve.points]
        errors[name] = noise_and_floor(samples, values, slopes[name].value)
        costs[name] = cost(samples, [point.seconds for point in curve.points])
    return Analysis(slopes, errors, costs, list(_break_even_rows(curves, errors, costs, seed)))


def _break_even_rows(curves, errors, costs, seed):
    """One row for each bake of the default and of the one with wider spacing."""
    cycles = curves.of(CYCLES)
    if cycles is None:
        return
    least = min(point.error for point in cycles.points)
    for name in WORTH:
        for point in curves.of(name).points:
            isosurfaces = break_even(
                point.error, point.seconds, errors[CYCLES], costs[CYCLES], SECONDS_VARY, seed
            )
            yield {
                "bake": name,
                "rays": point.samples,
                "RMS %": point.error,
                "seconds": point.seconds,
                "isosurfaces": isosurfaces,
                "beyond what Cycles was measured at": "yes" if point.error < least else "",
            }


def curve_rows(curves):
    """One row for each point of each curve."""
    return [
        {
            "curve": curve.name,
            "samples": point.samples,
            "rays": point.costs[0].rays,
            "seconds": point.seconds,
            "fastest": min(cost.seconds for cost in point.costs),
            "slowest": max(cost.seconds for cost in point.costs),
            "RMS %": point.error,
            "noise %": point.noise,
            "peak MiB": point.peak / MEBIBYTE,
            "file MiB": point.costs[0].file and point.costs[0].file / MEBIBYTE,
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
        f"- The bump box, {effort.texels}^3 nodes and as many texels, all isosurfaces "
        f"in each bake. The error is that at {len(reference.truth)} vertices of the isosurfaces "
        f"{isovalues} together, against {reference.paths:,} paths at each; mean colour "
        f"{reference.colour:.2f}. The reference's own noise is {reference.noise:.2f} %; nothing is "
        "subtracted.",
        f"- Along each curve the rays of a texel double, and with them the photons, {PHOTONS:,} a "
        f"ray. Scattered samples have {RAYS} rays each and are as many as give the same rays in "
        "all; their filter is Shepard's, of 3 texels.",
        f"- Seconds are those of a processor, all threads together, medians of {repetitions}, one "
        "curve after the other in turn. Where a machine is shared they still vary by some "
        f"{100 * SECONDS_VARY:.0f} %, when both threads of a core are at work by more.",
        f"- {CYCLES}: a background Blender bakes the same isosurface's mesh into its vertices, "
        "caustics on, nothing clamped or denoised. Blender starts and builds the scene before the "
        "clock does, and a first pass warms up; seconds are the mean of the isosurfaces. Cycles "
        "bakes each corner of a triangle, about six at a vertex. Its error holds that of the mesh, "
        "which follows the leaf by triangles.",
        "",
        *table(curve_rows(curves), CURVE_FORMATS),
    ]


def slope_rows(curves, analysis):
    """One row for each curve: slopes and floors, with their intervals."""
    rows = []
    for curve in curves.curves:
        samples = [point.samples for point in curve.points]
        fit, last = analysis.errors[curve.name], curve.points[-1]
        floor = root(fit.interval(0))
        enough = samples_for(np.sqrt(2.0) * floor.value, fit) if floor.value > 0 else np.inf
        rows.append(
            {
                "curve": curve.name,
                "slope of the error": slope(samples, [point.error for point in curve.points]),
                "slope of the noise": analysis.slopes[curve.name],
                "floor, %": floor,
                "samples for noise = floor": enough,
                "most samples": last.samples,
                "error less noise there, %": float(
                    np.sqrt(max(0.0, last.error**2 - last.noise**2))
                ),
            }
        )
    return rows


def slopes_text(curves, analysis):
    return [
        "![Error and noise against samples, with fits](images/convergence.png)",
        "",
        "- Samples are rays a texel, of Cycles those at a corner of a triangle. Slopes are "
        "d log / d log samples by least squares, with their intervals of 95 % (Student's t). "
        "Random samples have -0.5. Photons double with the rays, and the samples of a texel are "
        "spread evenly: noise of both falls faster together. Colours are clamped, which makes "
        "large errors of few rays smaller and slopes flatter. The noise is the deviation among "
        "seeds, which knows nothing of reference or floor.",
        "- The floor is what remains of the error with ever more samples, by a fit of error^2 = "
        "floor^2 + a samples^(2 slope), with the slope of the noise; it holds the texture's "
        f"resolution, the estimator's bias and the reference's noise ({curves.reference.noise:.2f} "
        "%). With more samples than those for noise = floor, the noise is less than the floor.",
        "- The last column is a floor without a fit: error and noise measured with the most "
        "samples, the one less the other in squares.",
        "",
        *table(slope_rows(curves, analysis), SLOPE_FORMATS),
    ]


def break_even_text(curves, analysis):
    low, high = THESIS_BREAK_EVEN
    if not analysis.break_even:
        return [NO_BLENDER]
    return [
        "![Isosurfaces after which a bake is worth it](images/break_even.png)",
        "",
        "- So many isosurfaces of the bump box take Cycles as long as one bake of all of them, of "
        "the whole range of isovalues, with the same error: the measured seconds of the bake over "
        "those of Cycles for one isosurface, by the fits of its error and its seconds against "
        f"samples. The thesis says {low} to {high}.",
        "- Intervals of 95 % come from Cycles' fits, drawn at random within their covariances, and "
        f"from seconds that vary by {100 * SECONDS_VARY:.0f} % from one run to the next, those of "
        "the bake and of Cycles each for themselves; where other work is done beside, they vary "
        "more. 0: Cycles does not reach the error, because the triangles of its mesh are not the "
        "leaf.",
        "",
        *table(analysis.break_even, BREAK_EVEN_FORMATS),
    ]


def data_rows(rows):
    """One row for each data set."""
    result = []
    for row in rows:
        printed = row.data_set.printed
        result.append(
            {
                "data set": row.data_set.name,
                "isovalues": ", ".join(f"{c:g}" for c in row.data_set.isovalues),
                "texels": row.texels,
                "bake s": row.cost.seconds,
                "direct s": row.direct,
                "RMS %": row.error,
                "of which noise %": row.noise,
                "mean colour": row.colour,
                "break-even": row.break_even,
                "thesis bake s": printed and printed.bake,
                "thesis direct s": printed and printed.direct,
                "thesis RMS %": printed and printed.error,
                "thesis break-even": printed and printed.bake / printed.direct,
            }
        )
    return result


def data_text(rows, absent, effort):
    lines = [
        f"- Bakes of the whole range of isovalues with {effort.rays} rays a texel, "
        f"{effort.photons:,} photons and {effort.texels:g} texels a node along each axis. The "
        f"error is that at up to {effort.vertices} vertices of some isosurfaces together, against "
        f"{effort.paths:,} paths at each.",
        '- "Direct" are seconds in which our path tracer lights the vertices of one isosurface, '
        "the average of those, with the error of the bake: from its seconds for a path and its "
        "noise at the vertices judged. Seconds are those of a processor, all threads together; the "
        "thesis's are those of two Pentium 4 Xeon of 3 GHz. Break-even is the one over the other.",
        "- Of the thesis's volumes the brain alone is public. The others are generated stand-ins "
        "of the same kind and size; RMS % grows with a scene's brightness, which the "
        "thesis does not tell. Isovalues of two volumes run from 0 to 1 over the window of each.",
    ]
    if effort.texels < 1:
        lines += [
            f"- Reduced: a node has {effort.texels:g} texels along each axis. The "
            "errors are larger, the seconds fewer than with the texel a node that a bake has by "
            "default."
        ]
    return [*lines, *absent_text(absent), "", *table(data_rows(rows), DATA_FORMATS)]


def memory_rows(curves, rows):
    """Of each curve with the most samples, and of each data set."""
    result = []
    for curve in curves.curves:
        point = curve.points[-1]
        taken = (f"bump box, {curve.name}", None, point.peak, point.costs[0].file)
        result.append(taken)
    result += [(row.data_set.name, row.texels, row.cost.peak, row.cost.file) for row in rows]
    return [
        {
            "bake": name,
            "texels": texels,
            "peak MiB": peak / MEBIBYTE,
            "file MiB": file and file / MEBIBYTE,
        }
        for name, texels, peak, file in result
    ]


def memory_text(curves, rows):
    return [
        "- The peak is what the whole process held in memory at most during the bake, Python, its "
        "modules and the volume included; of Cycles it is Blender's. The file holds the radiance "
        "and the volume, compressed.",
        "",
        *table(memory_rows(curves, rows), MEMORY_FORMATS),
    ]


CURVE_FORMATS = {
    "samples": "{}",
    "rays": "{:,}",
    "seconds": "{:.2f}",
    "fastest": "{:.2f}",
    "slowest": "{:.2f}",
    "RMS %": "{:.2f}",
    "noise %": "{:.2f}",
    "peak MiB": "{:.0f}",
    "file MiB": "{:.1f}",
}
SLOPE_FORMATS = {
    "slope of the error": "{:.2f}",
    "slope of the noise": "{:.2f}",
    "floor, %": "{:.2f}",
    "samples for noise = floor": "{:.0f}",
    "most samples": "{}",
    "error less noise there, %": "{:.2f}",
}
BREAK_EVEN_FORMATS = {
    "rays": "{}",
    "RMS %": "{:.2f}",
    "seconds": "{:.2f}",
    "isosurfaces": "{:.1f}",
}
DATA_FORMATS = {
    "texels": "{:,}",
    "bake s": "{:.1f}",
    "direct s": "{:.1f}",
    "RMS %": "{:.2f}",
    "of which noise %": "{:.2f}",
    "mean colour": "{:.2f}",
    "break-even": "{:.1f}",
    "thesis bake s": "{:.0f}",
    "thesis direct s": "{:.0f}",
    "thesis RMS %": "{:.2f}",
    "thesis break-even": "{:.1f}",
}
MEMORY_FORMATS = {"texels": "{:,}", "peak MiB": "{:.0f}", "file MiB": "{:.1f}"}
