# SPDX-License-Identifier: GPL-3.0-or-later
"""The sections of the report on curves, fits, data sets and memory: Markdown and rows for CSV.

A row is a dict of the cells by the names of the columns.
"""

from dataclasses import dataclass

import numpy as np

from .curves import CYCLES, DEFAULT, PHOTONS, RAYS
from .fits import break_even, cost, noise_and_floor, root, samples_for, slope

# From how many to how many isosurfaces the thesis breaks even.
THESIS_BREAK_EVEN = (3, 11)
MEBIBYTE = 2**20


@dataclass(frozen=True, eq=False)
class Analysis:
    """Fits by the name of each curve, and rows of (error, Estimate) of where bakes break even."""

    errors: dict
    costs: dict
    break_even: list


def analysed(curves, seed):
    """The Analysis of Curves."""
    errors, costs = {}, {}
    for curve in curves.curves:
        samples = [point.samples for point in curve.points]
        errors[curve.name] = noise_and_floor(samples, [point.error for point in curve.points])
        costs[curve.name] = cost(samples, [point.seconds for point in curve.points])
    rows = []
    if CYCLES in errors:
        bake, other = ((errors[name], costs[name]) for name in (DEFAULT, CYCLES))
        for point in curves.of(DEFAULT).points:
            # At the fitted error, so that the bake's effort is the measured one.
            floor_squared, a = np.maximum(bake[0].coefficients, 0.0)
            error = float(np.sqrt(floor_squared + a / point.samples))
            rows.append((error, break_even(error, bake, other, seed)))
    return Analysis(errors, costs, rows)


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
        "curve after the other in turn. Where a machine is shared they still vary by some 10 %, "
        "when both threads of a core are at work by more.",
        f"- {CYCLES}: a background Blender bakes the same isosurface's mesh into its vertices, "
        "caustics on, nothing clamped or denoised. Blender starts and builds the scene before the "
        "clock does, and a first pass warms up; seconds are the mean of the isosurfaces. Cycles "
        "bakes each corner of a triangle, about six at a vertex. Its error holds that of the mesh, "
        "which follows the leaf by triangles.",
        "",
        *table(curve_rows(curves), CURVE_FORMATS),
    ]


def slope_rows(curves, analysis):
    """One row for each curve: slopes, floor and noise, with their intervals."""
    rows = []
    for curve in curves.curves:
        samples = [point.samples for point in curve.points]
        fit = analysis.errors[curve.name]
        floor, one = root(fit.interval(0)), root(fit.interval(1))
        own = np.sqrt(max(0.0, floor.value**2 - curves.reference.noise**2))
        enough = samples_for(np.sqrt(2.0) * floor.value, fit) if floor.value > 0 else np.inf
        rows.append(
            {
                "curve": curve.name,
                "slope of the error": slope(samples, [point.error for point in curve.points]),
                "slope of the noise": slope(samples, [point.noise for point in curve.points]),
                "error of one sample, %": one,
                "floor, %": floor,
                "floor less the reference's noise, %": float(own),
                "samples for noise = floor": float(enough),
            }
        )
    return rows


def slopes_text(curves, analysis):
    return [
        "![Error and noise against samples, with fits](images/convergence.png)",
        "",
        "- Slopes are d log / d log samples by least squares, with their intervals of 95 % "
        "(Student's t). Unbiased noise has -0.5; samples that are spread evenly do better. The "
        "noise is the deviation among seeds, which knows nothing of reference or floor.",
        "- The floor is what remains of the error with ever more samples, by a fit of error^2 = "
        "floor^2 + a / samples to all points; it holds the texture's resolution, the estimator's "
        "bias and the reference's noise. From the samples in the last column on, the noise is "
        "less than the floor.",
        "- A slope of the error nearer to 0 than that of the noise is a floor. The fit "
        "takes noise to fall as 1 / samples in squares: where the slope of the noise is another, "
        "its floor is only as good as that.",
        "",
        *table(slope_rows(curves, analysis), SLOPE_FORMATS),
    ]


def break_even_rows(analysis):
    return [{"RMS %": error, "isosurfaces": found} for error, found in analysis.break_even]


def break_even_text(curves, analysis):
    low, high = THESIS_BREAK_EVEN
    if not analysis.break_even:
        return ["There is no Blender on the search path, so that nothing can be said of Cycles."]
    return [
        "![Isosurfaces after which a bake is worth it](images/break_even.png)",
        "",
        f"- So many isosurfaces of the bump box take Cycles as long as one bake of all of them "
        f"({DEFAULT}, the whole range of isovalues) with the same error, from the fits of error "
        f"and of seconds against samples. The thesis says {low} to {high}.",
        "- Intervals of 95 % come from fits drawn at random within their covariances. Seconds of "
        "other runs may lie outside where the machine is busier during one of the two.",
        "- 0: Cycles does not reach the error, because the triangles of its mesh are not the leaf; "
        "inf: the bake does not, because of its floor.",
        "",
        *table(break_even_rows(analysis), BREAK_EVEN_FORMATS),
    ]


def data_rows(rows):
    """One row for each data set."""
    result = []
    for row in rows:
        printed = row.data_set.printed
        result.append(
            {
                "data set": row.data_set.name,
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
        "thesis does not tell.",
    ]
    if effort.texels < 1:
        lines += [
            f"- Reduced: a node has {effort.texels:g} texels along each axis. The "
            "errors are larger, the seconds fewer than with the texel a node that a bake has by "
            "default."
        ]
    if absent:
        lines += [
            f"- Absent, hence left out: {'; '.join(absent)}. Name the folder that holds "
            "the files with `--data DIR`."
        ]
    return [*lines, "", *table(data_rows(rows), DATA_FORMATS)]


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


def table(rows, formats):
    """Lines of a Markdown table; formats: of each column, by its name."""
    if not rows:
        return []
    lines = [_line(rows[0]), "|" + "---|" * len(rows[0])]
    return [*lines, *(_line(_cell(row[name], formats.get(name)) for name in row) for row in rows)]


def _cell(value, form):
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if hasattr(value, "low"):
        return f"{form.format(value.value)} ({form.format(value.low)} .. {form.format(value.high)})"
    return form.format(value)


def _line(cells):
    return "| " + " | ".join(cells) + " |"


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
    "error of one sample, %": "{:.1f}",
    "floor, %": "{:.2f}",
    "floor less the reference's noise, %": "{:.2f}",
    "samples for noise = floor": "{:.0f}",
}
BREAK_EVEN_FORMATS = {"RMS %": "{:.2f}", "isosurfaces": "{:.1f}"}
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
