# SPDX-License-Identifier: GPL-3.0-or-later
"""The first page of the report: what to choose when, in sentences made from its figures."""

import numpy as np

from leaflight.io.markdown import table
from .curves import BAKE, CYCLES, GATHER
from .fits import root, samples_for, slope
from .sections import MEBIBYTE, THESIS_BREAK_EVEN

# Budgets in seconds: these steps in each decade.
STEPS = (1, 2, 5)
# The least number of curves measured within a budget for it to be reported.
CHOICES = 3


def advice(curves, analysis, data_rows):
    """Returns lines of Markdown."""
    effort = curves.effort
    lines = [
        f"All figures of this page are those of the sections below: the bump box of "
        f"{effort.texels}^3 nodes, seconds of a processor, RMS errors of which the "
        f"reference's noise is {curves.reference.noise:.2f} %.",
        "",
        *_table_of_budgets(curves),
        "",
    ]
    sentences = (
        _bake(curves),
        _samples(analysis),
        _strategies(curves),
        _path(curves),
        _thesis(curves),
        _break_even(analysis),
        _real(data_rows),
        _memory(curves, data_rows),
    )
    return lines + [f"- {sentence}" for sentence in sentences if sentence]


def budget_rows(curves):
    """Returns the measured estimators and strategies that err least within budgets of seconds."""
    own = [curve for curve in curves.curves if curve.group != "Cycles"]
    most = max(point.seconds for curve in own for point in curve.points)
    rows = []
    for budget in (step * 10.0**power for power in range(-3, 7) for step in STEPS):
        # The last budget is the first that all fit in.
        found = sorted(filter(None, (_best(curve, budget) for curve in own)), key=_error)
        if len(found) >= CHOICES:
            (first, point), (second, other), *_ = found
            row = {
                "choose": first.name,
                "with": f"{point.samples} {first.unit}",
                "RMS %": point.error,
                "next": second.name,
                "its RMS %": other.error,
            }
            # A larger budget with the same choices gets no row.
            if not rows or {**rows[-1], **row} != rows[-1]:
                rows.append({"seconds at most": budget, **row})
        if budget >= most:
            break
    return rows


def _best(curve, budget):
    """Returns (Curve, Point) of the curve's least error within a budget, or None."""
    within = [point for point in curve.points if point.seconds <= budget]
    return (curve, min(within, key=lambda point: point.error)) if within else None


def _error(choice):
    return choice[1].error


def _table_of_budgets(curves):
    formats = {"seconds at most": "{:g}", "RMS %": "{:.2f}", "its RMS %": "{:.2f}"}
    return table(budget_rows(curves), formats)


def _bake(curves):
    """Returns the best of leaflight.bake beside the best of the thesis's methods."""
    own = curves.of(BAKE)
    others = [curve for curve in curves.curves if curve.group in ("estimators", "strategies")]
    if own is None or not others:
        return None
    best = min(own.points, key=lambda point: point.error)
    other, point = min((_best(curve, np.inf) for curve in others), key=_error)
    return (
        f"**Bake.** `{BAKE}` errs {best.error:.2f} % in {best.seconds:.1f} s with {best.samples} "
        f"{own.unit}. The best of the thesis's methods, {other.name}, errs {point.error:.2f} % in "
        f"{point.seconds:.1f} s."
    )


def _samples(analysis):
    fit = analysis.errors.get(GATHER)
    if fit is None:
        return None
    floor, rate = root(fit.interval(0)), analysis.slopes[GATHER].value
    text = (
        f"**Samples.** With {GATHER}, twice the rays and photons leave {2**rate:.2f} of the noise"
    )
    if not floor.value > 0:
        return f"{text}; no floor shows within the samples measured."
    enough = samples_for(np.sqrt(2.0) * floor.value, fit)
    return (
        f"{text}; at {enough:.0f} rays a texel it is as small as the floor of {floor.value:.2f} % "
        f"({floor.low:.2f} to {floor.high:.2f}), beyond which a finer texture does more."
    )


def _strategies(curves):
    plain = curves.of(GATHER)
    scattered = [curve for curve in curves.curves if curve.group == "strategies"]
    if plain is None or not scattered:
        return None
    few, many = (
        ", ".join(f"{curve.name} {curve.points[end].error:.2f} %" for curve in scattered)
        for end in (0, -1)
    )
    first, last = plain.points[0], plain.points[-1]
    return (
        f"**Sampling.** With {first.samples} ray(s) a texel in all, scattered samples give {few}, "
        f"samples in each texel {first.error:.2f} %; with {last.samples}, {many} and "
        f"{last.error:.2f} %."
    )


def _path(curves):
    plain, path = curves.of(GATHER), curves.of("path")
    if plain is None or path is None:
        return None
    own, other = plain.points[-1], path.points[-1]
    rate = slope([p.samples for p in path.points], [p.error for p in path.points])
    return (
        f"**Without bias.** `path` has nothing cached: {other.error:.2f} % in "
        f"{other.seconds:.1f} s with {other.samples} rays a texel, where {GATHER} has "
        f"{own.error:.2f} % in {own.seconds:.1f} s; slope {rate.value:.2f}. It is for checking."
    )


def _thesis(curves):
    thesis, own = curves.of("thesis"), curves.of("volumetric")
    if thesis is None or own is None:
        return None
    last = thesis.points[-1]
    same = next(point for point in own.points if point.samples == last.samples)
    return (
        f"**Photons alone.** The thesis's photon map takes {last.seconds / same.seconds:.0f} times "
        f"the seconds of `volumetric` with as many photons ({last.seconds:.1f} against "
        f"{same.seconds:.2f} s) and errs {last.error:.2f} % against {same.error:.2f} %."
    )


def _break_even(analysis):
    known = [
        row
        for row in analysis.break_even
        if row["bake"] == BAKE and 0 < row["isosurfaces"].value < np.inf
    ]
    if not known:
        return None
    first, last = known[0], known[-1]
    low, high = THESIS_BREAK_EVEN
    return (
        "**One bake or Cycles for each isosurface.** One bake of all isosurfaces takes as long as "
        f"{first['isosurfaces'].value:.1f} of them in Cycles at an error of {first['RMS %']:.1f} % "
        f"and {last['isosurfaces'].value:.1f} at {last['RMS %']:.1f} %; the thesis says {low} to "
        f"{high}. For more of them, or to move the isovalue, bake."
    )


def _real(rows):
    if not rows:
        return None
    errors = [row.error for row in rows]
    seconds = [1e6 * row.cost.seconds / row.texels for row in rows]
    return (
        f"**Data.** {len(rows)} data sets err {min(errors):.2f} to {max(errors):.2f} % and take "
        f"{min(seconds):.0f} to {max(seconds):.0f} s for each million texels that an isosurface "
        "passes through."
    )


def _memory(curves, rows):
    cycles = curves.of(CYCLES)
    own = max(point.peak for curve in curves.curves for point in curve.points if curve != cycles)
    text = f"**Memory.** The bump box takes {own / MEBIBYTE:.0f} MiB at most"
    if rows:
        most = max(rows, key=lambda row: row.cost.peak)
        text += (
            f"; the most, {most.cost.peak / MEBIBYTE:.0f} MiB, takes {most.data_set.name}, "
            f"{most.texels:,} texels, whose file has {most.cost.file / MEBIBYTE:.0f} MiB"
        )
    return text + "."


def _list(words):
    *most, last = words
    return f"{', '.join(most)} and {last}"
