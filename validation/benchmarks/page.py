# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/validation/performance.md: the tables of `bench`, each between its marks."""

from pathlib import Path

from leaflight._core import LeaflightError
from leaflight.io.markdown import table
from leaflight.io.output import check_writable, replaced
from volume_recipes import absent_text
from .interpolation import FEWER
from .repetitions import REPETITIONS

MEBIBYTE = 2**20
PAGE = """# Performance

This page shows how fast bakes, rays and isovalues are. `validation/bench bake --out
docs/validation/performance.md` writes the tables between their marks, and so do `scale`, `rays` and
`scrub`.
The innermost loops of the core have benchmarks of their own:
`build/release/core/bench/core_bench`.

<!-- bench bake -->
<!-- /bench bake -->

<!-- bench scale -->
<!-- /bench scale -->

<!-- bench rays -->
<!-- /bench rays -->

<!-- bench scrub -->
<!-- /bench scrub -->
"""


def check_page(path, name):
    """Raises LeaflightError unless the tables of `bench NAME` can be written into this document."""
    check_writable(path, ".md")
    _split(path, name)


def write_page(path, name, result):
    """Writes the tables of `bench NAME` from its result into a document, as a whole or not at all.

    A document that is not there is made. Raises LeaflightError.
    """
    before, after = _split(path, name)
    lines = {"bake": bake_lines, "scale": scale_lines, "rays": ray_lines, "scrub": scrub_lines}
    lines = lines[name](result)
    with replaced(path) as temporary:
        temporary.write_text(before + "\n\n" + "\n".join(lines) + "\n\n" + after)


def _split(path, name):
    """Returns the text before the tables of `bench NAME` and the text after, with the marks."""
    path = Path(path)
    try:
        text = path.read_text() if path.exists() else PAGE
    except (OSError, UnicodeDecodeError) as error:
        raise LeaflightError(f"{path}: cannot read it: {error}.") from None
    begin, end = f"<!-- bench {name} -->", f"<!-- /bench {name} -->"
    before, found, rest = text.partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise LeaflightError(
            f"{path}: there is no place for the tables of bench {name}: write a line {begin} and "
            f"below it a line {end}, or name a file that does not exist."
        )
    return before + begin, end + after


def bake_lines(result):
    """Returns the section of `bench bake`, lines of Markdown."""
    rows = [
        {
            "bake": f"{row['name']} at {row['isovalue']:g}",
            "texels": row["texels"],
            "million rays": row["rays"] / 1e6,
            "bake s": row["bake_seconds"],
            "RMS %": row["rms_percent"],
            "noise %": row["noise_percent"],
            "texture %": row["texture_percent"],
            "noise of the reference %": row["judge_noise_percent"],
            "Cycles s": row["cycles_seconds"],
            "break-even": row["break_even"] or _why(row),
            "vertices": row["vertices"],
            "repetitions": row["repetitions"],
        }
        for row in result["cases"]
    ]
    points = [
        {
            "bake": f"{row['name']} at {row['isovalue']:g}",
            "samples": point["samples"],
            "s": point["seconds"],
            "error %": point["error_percent"],
        }
        for row in result["cases"]
        for point in row["cycles"]
    ]
    return [
        "## Bakes against Cycles",
        "",
        _measured_on(result),
        "",
        "- Each bake has default settings and lights all isosurfaces of its default range. RMS % "
        "is its error against Cycles at one isosurface, as `compare` reports it. *Noise* and "
        "*texture* are parts of it. Their squares add up with those of the reference's noise and "
        "of the mesh.",
        "- *Cycles s* is the time in which Cycles bakes the vertices of this one isosurface to the "
        "same error, without the reference's noise. The mesh is marching cubes at the nodes. "
        "*Break-even* is bake s over Cycles s. For more isosurfaces the bake is faster.",
        "- Cycles is measured at the samples below, against many more of its own samples. Values "
        "between them are interpolated, and none is extrapolated. Blender's start, the setup of "
        "the scene and errors between the vertices do not count.",
        "- Seconds are wall-clock medians. Bake and Cycles take turns, "
        f"{REPETITIONS} times, or fewer if one turn takes minutes (*repetitions*).",
        *absent_text(result["absent"]),
        "",
        *table(rows, BAKE_FORMATS),
        "",
        "*Samples* of Cycles are paths at each corner of a triangle:",
        "",
        *table(points, POINT_FORMATS),
    ]


def _why(row):
    """Returns a text on a missing break-even: the side of the measured points that it is on."""
    ends = row["cycles"][0] if row["outside"] == FEWER else row["cycles"][-1]
    bound = row["bake_seconds"] / ends["seconds"]
    return f"{'above' if row['outside'] == FEWER else 'below'} {bound:.2g}: {row['outside']}"


def scale_lines(result):
    """Returns the section of `bench scale`, lines of Markdown."""
    rows = [
        {
            "bake": row["name"],
            "texels": row["texels"],
            "s": row["seconds"],
            "ns per texel": row["ns_per_texel"],
            "million rays/s": row["rays_per_second"] / 1e6,
            "peak MiB": row["peak_bytes"] / MEBIBYTE,
            "repetitions": row["repetitions"],
        }
        for row in result["cases"]
    ]
    pair = result["threads"]
    return [
        "## How bakes grow",
        "",
        _measured_on(result),
        "",
        "- Each bake has default settings and its own process. The peak is the most memory of "
        "that process, with Python and its modules. Seconds are wall-clock medians of "
        f"{REPETITIONS} bakes in turns, or fewer if one takes minutes.",
        *(
            [
                f"- {pair['nodes']}^3 nodes take {pair['seconds_1_thread']:.2f} s with one thread "
                f"and {pair['seconds_2_threads']:.2f} s with two. That is "
                f"{result['speedup_2_threads']:.2f} times as fast (medians of "
                f"{pair['repetitions']}, in turns)."
            ]
            if pair
            else []
        ),
        "",
        *table(rows, SCALE_FORMATS),
    ]


def ray_lines(result):
    """Returns the section of `bench rays`, lines of Markdown."""
    rows = [
        {
            "isosurface": row["name"],
            "triangles": row["triangles"],
            "million rays/s": row["rays_per_second_intersect"] / 1e6,
            "over Embree's": row["ratio_intersect"],
            "occluded, million rays/s": row["rays_per_second_occluded"] / 1e6,
            "over Embree's ": row["ratio_occluded"],
        }
        for row in result["cases"]
    ]
    first = result["cases"][0] if result["cases"] else {"rays": 0, "repetitions": 0}
    return [
        "## Rays against Embree",
        "",
        _measured_on(result),
        "",
        f"- {first['rays']:,} rays start on the front of each isosurface, with a cosine "
        "distribution, on one thread. Embree's rays hit the contoured mesh (rtcIntersect1 and "
        "rtcOccluded1, a tree of high quality). Ours hit the isosurface of the volume itself, so "
        "a new isovalue needs no tree. Processor seconds, medians of "
        f"{first['repetitions']} turns.",
        *absent_text(result["absent"]),
        "",
        *table(rows, RAY_FORMATS),
    ]


def scrub_lines(result):
    """Returns the section of `bench scrub`, lines of Markdown."""
    rows = [
        {
            "volume": f"{row['name']} at {row['isovalue']:g}",
            "triangles": row["triangles"],
            "ms": row["milliseconds"],
            "VTK ms": row["vtk_milliseconds"],
            "VTK / ours": row["vtk_ratio"],
        }
        for row in result["cases"]
    ]
    inside = [
        {
            "isovalue": row["isovalue"],
            "triangles": row["triangles"],
            "ms": row["whole_ms"],
            "triangles while it moves": row["moving_triangles"],
            "ms while it moves": row["moving_ms"],
        }
        for row in result["blender"]
    ]
    return [
        "## Isovalues",
        "",
        _measured_on(result),
        "",
        "- Times are wall-clock medians of contouring and lookup of the radiance at the vertices. "
        "VTK's FlyingEdges3D and ProbeFilter take turns with ours; the ratio is that of a turn.",
        f"- The second table is of Blender {result['blender'][0]['blender']}, from the slider to "
        "the evaluated mesh, before any drawing.",
        *absent_text(result["absent"]),
        "",
        *table(rows, SCRUB_FORMATS),
        "",
        *table(inside, SCRUB_FORMATS),
    ]


def _measured_on(result):
    machine = result["machine"]
    load = "" if machine["load"] is None else f", load {machine['load']:.1f} before"
    blender = f", {machine['blender']}" if machine.get("blender") else ""
    return (
        f"Measured at commit {result['commit']} on {machine['cores']} cores of "
        f"{machine['processor'] or 'an unknown processor'}, {machine['system']}, "
        f"Python {machine['python']}{blender}{load}."
    )


BAKE_FORMATS = {
    "texels": "{:,}",
    "million rays": "{:.1f}",
    "bake s": "{:.2f}",
    "RMS %": "{:.2f}",
    "noise %": "{:.2f}",
    "texture %": "{:.2f}",
    "noise of the reference %": "{:.2f}",
    "Cycles s": "{:.2f}",
    "break-even": "{:.2f}",
    "vertices": "{:,}",
    "repetitions": "{}",
}
POINT_FORMATS = {"samples": "{:,}", "s": "{:.2f}", "error %": "{:.2f}"}
SCRUB_FORMATS = {
    "isovalue": "{:g}",
    "triangles": "{:,}",
    "ms": "{:.0f}",
    "VTK ms": "{:.0f}",
    "VTK / ours": "{:.2f}",
    "triangles while it moves": "{:,}",
    "ms while it moves": "{:.0f}",
}
SCALE_FORMATS = {
    "texels": "{:,}",
    "s": "{:.2f}",
    "ns per texel": "{:,.0f}",
    "million rays/s": "{:.2f}",
    "peak MiB": "{:.0f}",
    "repetitions": "{}",
}
RAY_FORMATS = {
    "triangles": "{:,}",
    "million rays/s": "{:.2f}",
    "over Embree's": "{:.2f}",
    "occluded, million rays/s": "{:.2f}",
    "over Embree's ": "{:.2f}",
}
