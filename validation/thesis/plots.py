# SPDX-License-Identifier: GPL-3.0-or-later
"""The plots of the report, each the bytes of a PNG file."""

import io

import numpy as np
from matplotlib import ticker as ticks
from matplotlib.figure import Figure

from .curves import GATHER

# Okabe and Ito's colors, which color-blind eyes distinguish.
COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
MARKERS = "osD^vPX"
# Styles of the curves that both panels show.
STYLES = {
    "bake": {"color": "black", "linewidth": 2.5},
    "Cycles": {"color": "0.45", "linestyle": "--", "marker": "."},
}
DOTS_PER_INCH = 110


def error_against_seconds(curves):
    """Plots estimators and strategies in two panels, over Cycles and the reference's noise."""
    figure = Figure(figsize=(11, 4.6))
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    groups = (("estimators", "estimators"), ("strategies", "strategies of sampling (gather)"))
    for panel, (group, title) in zip(panels, groups):
        shown = [curve for curve in curves.curves if curve.group in (group, "bake", "Cycles")]
        if group == "strategies":
            shown.insert(0, curves.of(GATHER))
        for number, curve in enumerate(filter(None, shown)):
            style = {"color": COLORS[number], "marker": MARKERS[number], "markersize": 4}
            style |= STYLES.get(curve.group, {})
            is_here = curve.group in (group, *STYLES)
            label = curve.name if is_here else f"{curve.name}, each texel"
            seconds = [point.seconds for point in curve.points]
            panel.plot(seconds, [point.error for point in curve.points], label=label, **style)
        panel.axhline(curves.reference.noise, color="0.6", linewidth=1, linestyle=":")
        panel.annotate(
            "reference's noise",
            (0.99, curves.reference.noise),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            color="0.4",
            fontsize=8,
        )
        _logarithmic(panel, title, "seconds of a processor")
        panel.legend(fontsize=8, frameon=False)
    panels[0].set_ylabel("RMS error, %")
    return _png(figure)


def convergence(curves, fits):
    """Plots error and noise against samples, with the fits of noise and floor; one panel per curve.

    fits: Fit of noise_and_floor by the names of the shown curves.
    """
    columns = 4
    rows = -(-len(fits) // columns)
    figure = Figure(figsize=(12, 2.6 * rows + 0.4))
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for panel in panels.ravel()[len(fits) :]:
        panel.remove()
    for number, (panel, (name, fit)) in enumerate(zip(panels.ravel(), fits.items())):
        points = curves.of(name).points
        samples = np.array([point.samples for point in points], dtype=float)
        panel.plot(samples, [point.error for point in points], "o", color=COLORS[0], label="error")
        noise = [point.noise for point in points]
        panel.plot(samples, noise, "x", color=COLORS[3], label="noise, from seed to seed")
        fine = np.geomspace(samples.min(), samples.max(), 100)
        floor_squared, a = np.maximum(fit.coefficients, 0.0)
        fitted = np.sqrt(floor_squared + a * fine**fit.power)
        panel.plot(fine, fitted, "-", color=COLORS[0], linewidth=1, label="fit")
        floor = np.sqrt(floor_squared) or np.nan
        panel.axhline(floor, color="0.5", linewidth=1, linestyle="--", label="floor of the fit")
        _logarithmic(panel, name, "samples" if number >= len(fits) - columns else "")
        if number >= len(fits) - columns:
            panel.tick_params(labelbottom=True)
    for panel in panels[:, 0]:
        panel.set_ylabel("%")
    panels[0, 0].legend(fontsize=7, frameon=False)
    return _png(figure)


def break_even(rows, thesis):
    """Plots the break-even number of isosurfaces against the error.

    rows: see sections.py; thesis: (lowest, highest) in the thesis.
    """
    figure = Figure(figsize=(6.6, 4.0))
    panel = figure.subplots()
    panel.axhspan(*thesis, color="0.9", label="thesis")
    for number, name in enumerate(dict.fromkeys(row["bake"] for row in rows)):
        # Logarithmic axes show only positive values.
        own = [row for row in rows if row["bake"] == name and row["isosurfaces"].value > 0]
        found = [row["isosurfaces"] for row in own]
        panel.errorbar(
            [row["RMS %"] for row in own],
            [one.value for one in found],
            (
                [one.value - max(one.low, 0.05 * one.value) for one in found],
                [one.high - one.value for one in found],
            ),
            color=COLORS[number],
            marker=MARKERS[number],
            capsize=3,
            label=name,
        )
    _logarithmic(panel, "one bake against Cycles at equal error", "RMS error of both, %")
    panel.set_ylabel("isosurfaces")
    panel.legend(fontsize=8, frameon=False)
    return _png(figure)


def _logarithmic(panel, title, x):
    panel.set_xscale("log")
    panel.set_yscale("log")
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_major_locator(ticks.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(ticks.FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(ticks.NullFormatter())
    panel.grid(color="0.9")
    panel.set_axisbelow(True)
    panel.set_title(title, fontsize=10)
    panel.set_xlabel(x)


def _png(figure):
    file = io.BytesIO()
    figure.tight_layout()
    # Leave out date and version, so that equal figures make equal files.
    figure.savefig(file, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return file.getvalue()
