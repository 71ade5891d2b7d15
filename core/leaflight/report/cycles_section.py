# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of the report on bakes against Cycles: see sections.py."""

from ..bake.settings import DEFAULT_ERROR
from ..io.markdown import table
from ..measure.volume_recipes import absent_text
from .against_cycles import MET, MISSED, TOLD, TRUE_WITHIN

# A mean colour below which a share of it says nothing.
DARK = 0.01
BAKE_FORMATS = {
    "texels": "{:,}",
    "rounds": "{}",
    "said s": "{:.0f}",
    "bake s": "{:.1f}",
    "said before %": "{:.2f}",
    "said after %": "{:.2f}",
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


def bake_rows(rows):
    """One row for each bake."""
    # A row a case, in the order of the cases.
    bakes = {row.bake.case.name: row.bake for row in rows}
    return [
        {
            "bake": name,
            "nodes": " x ".join(map(str, bake.nodes)),
            "texels": bake.statistics["texels"],
            "rounds": bake.statistics["rounds"],
            "said s": bake.before.seconds,
            "bake s": bake.statistics["seconds"],
            "said before %": bake.before.error,
            "said after %": bake.after,
            "found %": bake.found,
            "true": "yes" if bake.true else "no",
        }
        for name, bake in bakes.items()
    ]


def cycles_rows(rows):
    """One row for each isosurface that Cycles judged."""
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


def cycles_text(rows, absent, effort):
    lines = [
        "- Each bake is one by default, of all isosurfaces of its default window: no setting was "
        "touched. It is held against Cycles, which traces *paths* at each of about "
        f"{effort.points:,} random points of an isosurface's mesh. Blender builds the scene for "
        "itself: marching cubes, smooth normals, caustics on, nothing clamped or denoised.",
        "- RMS % is the error of the colours (thesis Eq. 4.11, corrected), from which nothing is "
        'subtracted. "Mean off by" is how much more or less light all points together have; it is '
        "left out where there is hardly any.",
        "- Its square is the sum of four, but for chance. *Noise*: what "
        "samples leave to chance, as the texels report it. *Texture*: what else keeps the bake "
        "from our path tracer on the leaf itself: texels are too coarse, or the estimator is not "
        "quite right. *Mesh*: what our path tracer and Cycles differ by, since Cycles sees "
        "triangles for the leaf; it stays when all else is perfect. *Noise of Cycles*: the "
        "judge's own.",
    ]
    if effort.judged:
        lines += [
            f"- A bake by default is asked for {DEFAULT_ERROR:g} %. *{MET.capitalize()}*: it errs "
            f"no more. *{TOLD.capitalize()}*: it errs more, and said so of itself both before "
            f"(`--estimate`) and afterwards. *{MISSED.capitalize()}*: it errs more, and did not "
            "say so.",
        ]
    lines += [
        "- *Said* is what a bake says of itself: seconds and error before it starts, and the error "
        "when it is done. *Found* is the RMS over its isosurfaces below, the noise of "
        f"Cycles taken out. *True*: said afterwards and found differ by a factor of {TRUE_WITHIN:g}"
        " at most. Scenes with several volumes are not baked in rounds, and know only their noise.",
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
    """Percent; None where all is dark."""
    return None if errors["mean_radiance"] < DARK else 100 * (errors["mean_ratio"] - 1)
