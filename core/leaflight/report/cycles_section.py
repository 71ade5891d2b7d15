# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of the report on bakes against Cycles: see sections.py."""

from ..io.markdown import table
from ..measure.volume_recipes import absent_text
from .against_cycles import OF_FLOOR

CYCLES_FORMATS = {
    "isovalue": "{:g}",
    "refine": "{}",
    "rays": "{}",
    "texels": "{:,}",
    "seconds": "{:.0f}",
    "points": "{:,}",
    "paths": "{:,}",
    "RMS %": "{:.2f}",
    "noise %": "{:.2f}",
    "texture %": "{:.2f}",
    "mesh %": "{:.2f}",
    "noise of Cycles %": "{:.2f}",
    "RMS of the mean %": "{:.1f}",
    "mean off by %": "{:.2f}",
    "floor %": "{:.2f}",
    "goal %": "{:.2f}",
}


def cycles_rows(rows):
    """One row for each isosurface that Cycles judged."""
    verdicts = {None: "", True: "met", False: "missed"}
    return [
        {
            "bake": row.case.name,
            "isovalue": row.isovalue,
            "refine": row.case.refine,
            "rays": row.rays,
            "texels": row.texels,
            "seconds": row.seconds,
            "points": row.errors["points"],
            "paths": row.paths,
            "RMS %": row.error,
            "noise %": row.parts["noise_percent"],
            "texture %": row.parts["texture_percent"],
            "mesh %": row.parts["mesh_percent"],
            "noise of Cycles %": row.errors["reference_noise_percent"],
            "RMS of the mean %": _percent(row.errors["relative_rms"]),
            "mean off by %": row.bias,
            "floor %": row.floor,
            "goal %": row.goal,
            "verdict": verdicts[row.passed],
        }
        for row in rows
    ]


def cycles_text(rows, absent, effort):
    lines = [
        f"- Each bake with {effort.photons:,} photons and all isosurfaces of its default window, "
        "against Cycles, which traces *paths* at each of about "
        f"{effort.points:,} random points of an isosurface's mesh. Blender builds the scene for "
        "itself: marching cubes, smooth normals, caustics on, nothing clamped or denoised.",
        "- RMS % is the error of the colours (thesis Eq. 4.11, corrected), from which nothing is "
        "subtracted. Its squares are the sum of those of the next four columns, but for chance. "
        "*Noise*: what rays and photons leave to chance, as the texels report it; more of them "
        "make it smaller. *Texture*: what else keeps the bake from our path "
        "tracer on the leaf itself: texels are too coarse, or the estimator is not quite right. "
        "*Mesh*: what our path tracer and Cycles differ by, since Cycles sees triangles for the "
        "leaf. *Noise of Cycles*: the judge's own. Texels report up to a third more noise than "
        "they have, for their samples are spread evenly: a texture that matters little next to it "
        "shows as 0.",
        "- *refine* says how many times texels are halved where light varies most.",
        "- The floor is the error of a perfect bake with these texels, none of them halved: each "
        f"texel that the points need is computed by {effort.floor_samples} paths instead, without "
        "photons or caches, and the noise of these and of Cycles is taken out. It holds the mesh, "
        "too. An error near the floor can be lowered by finer texels alone.",
        '- "RMS of the mean" is the error of the radiance, nothing clamped, over its mean; "mean '
        'off by", how much more or less light the bake has at all points together, with an '
        "interval of 95 % from the noise of Cycles.",
    ]
    if effort.judged:
        lines += [
            "- An error must not exceed its goal. Where that is no round number, it is "
            f"{OF_FLOOR:g} times the floor."
        ]
    return [*lines, *absent_text(absent), "", *table(cycles_rows(rows), CYCLES_FORMATS)]


def _percent(share):
    """A share in percent; None of None."""
    return None if share is None else 100 * share
