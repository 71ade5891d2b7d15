# SPDX-License-Identifier: GPL-3.0-or-later
"""validation/bench: what is measured, with how much work, and the sentences about it."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

from leaflight._core import LeaflightError
from leaflight.progress_bar import run_with_progress
from leaflight.volume.setting_error import SettingError
from leaflight_command.shared_options import Parser, threads_options
from .bakes import QUICK_BAKES, BakeEffort, measure_bakes
from .interpolation import FEWER
from .machine import commit, machine
from .page import check_page, write_page
from .rays import KINDS, QUICK_RAYS, RayEffort, measure_rays
from .scale import QUICK_SCALE, ScaleEffort, measure_scale
from .scrub import QUICK_SCRUB, ScrubEffort, measure_scrub


# Options that not every benchmark has a use for.
_OF = {"only": ("bake",), "data": ("bake", "rays", "scrub")}


def make_parser():
    parser = Parser(
        prog="bench",
        parents=[threads_options()],
        description="Measures how fast bakes are, with Cycles beside them.",
    )
    parser.add_argument(
        "what",
        choices=("bake", "scale", "rays", "scrub"),
        help="bake: against Cycles to the same error; scale: by size and threads; rays: against "
        "Embree; scrub: isovalues against VTK, and in Blender",
    )
    parser.add_argument("--quick", action="store_true", help="tiny, to see that it works")
    parser.add_argument(
        "--data", metavar="DIR", help="folder of real volumes, which are left out without it"
    )
    parser.add_argument("--only", metavar="TEXT", help="bakes with this in their name")
    parser.add_argument("--out", metavar="FILE.md", help="document to write the tables into")
    parser.finish()
    return parser


def run_bench(options, run=run_with_progress):
    """Runs the benchmark that the options name; returns its result and the sentences about it.

    run: called as run(work, label), which returns work(progress). Raises LeaflightError, Cancelled.
    """
    for name, benchmarks in _OF.items():
        if getattr(options, name) is not None and options.what not in benchmarks:
            raise SettingError(f"This has no meaning for bench {options.what}; leave it out.", name)
    if options.out is not None:
        if options.quick:
            raise SettingError(
                "What is measured quickly is not worth writing down; leave out one of the two.",
                "quick",
                "out",
            )
        if options.only is not None:
            raise SettingError(
                "The table of some bakes would replace that of all; leave out one of the two.",
                "only",
                "out",
            )
        check_page(options.out, options.what)
    measure = {"bake": _bake, "scale": _scale, "rays": _rays, "scrub": _scrub}[options.what]
    result, sentences = measure(options, run)
    if options.out is not None:
        write_page(options.out, options.what, result)
        sentences.append(f"{options.out}: the tables of bench {options.what} are new")
    return result, sentences


def _bake(options, run):
    if options.data is not None and not Path(options.data).is_dir():
        raise LeaflightError(
            f"{options.data}: there is no such folder; give that of the data sets."
        )
    effort = QUICK_BAKES if options.quick else BakeEffort()
    if options.only is not None:
        chosen = tuple(case for case in effort.cases if options.only in case.name)
        if not chosen:
            names = ", ".join(case.name for case in effort.cases)
            raise SettingError(f'No bake has "{options.only}" in its name: {names}.', "only")
        effort = replace(effort, cases=chosen)
    origin = {"machine": {**machine(), "blender": _blender()}, "commit": commit()}
    work = {"seed": options.seed, "threads": options.threads}
    rows, absent = measure_bakes(effort, run, folder=options.data, **work)
    return {**origin, "cases": rows, "absent": absent}, [
        *(_bake_sentence(row) for row in rows),
        *([f"absent, hence left out: {'; '.join(absent)} (--data)"] if absent else []),
    ]


def _bake_sentence(row):
    if row["outside"] is None:
        peer = f"Cycles {row['cycles_seconds']:.2f} s, break-even {row['break_even']:.2f}"
    else:
        end = row["cycles"][0 if row["outside"] == FEWER else -1]
        peer = (
            f"for Cycles it takes {row['outside']} ({end['samples']}: "
            f"{end['error_percent']:.2f} % in {end['seconds']:.2f} s)"
        )
    return (
        f"{row['name']} at {row['isovalue']:g}: {row['bake_seconds']:.2f} s, "
        f"{row['rms_percent']:.2f} %; {peer}; repetitions: {row['repetitions']}"
    )


def _scale(options, run):
    effort = QUICK_SCALE if options.quick else ScaleEffort()
    origin = {"machine": machine(), "commit": commit()}
    result = measure_scale(effort, run, seed=options.seed, threads=options.threads)
    speedup = result["speedup_2_threads"]
    return {**origin, **result}, [
        *(
            f"{row['name']}: {row['seconds']:.2f} s, {row['ns_per_texel']:.0f} ns a texel, "
            f"{row['rays_per_second'] / 1e6:.2f} million rays/s, "
            f"{row['peak_bytes'] / 2**20:.0f} MiB; repetitions: {row['repetitions']}"
            for row in result["cases"]
        ),
        *([f"two threads are {speedup:.2f} times as fast as one"] if speedup else []),
    ]


def _rays(options, run):
    effort = QUICK_RAYS if options.quick else RayEffort()
    origin = {"machine": machine(), "commit": commit()}
    rows, absent = measure_rays(effort, run, folder=options.data)
    least = min((row[f"ratio_{kind}"] for row in rows for kind in KINDS), default=None)
    return {**origin, "cases": rows, "min_ratio": least, "absent": absent}, [
        *(
            f"{row['name']}: {row['rays_per_second_intersect'] / 1e6:.2f} million rays/s, "
            f"{row['ratio_intersect']:.2f} of Embree's; whether anything is hit "
            f"{row['rays_per_second_occluded'] / 1e6:.2f}, {row['ratio_occluded']:.2f}"
            for row in rows
        ),
        *([f"absent, hence left out: {'; '.join(absent)} (--data)"] if absent else []),
    ]


def _scrub(options, run):
    effort = QUICK_SCRUB if options.quick else ScrubEffort()
    origin = {"machine": machine(), "commit": commit()}
    work = {"seed": options.seed, "threads": options.threads}
    result = measure_scrub(effort, run, folder=options.data, **work)
    return {**origin, **result}, [
        *(
            f"{row['name']} at {row['isovalue']:g}: {row['triangles']} triangles, "
            f"{row['milliseconds']:.0f} ms, VTK {row['vtk_milliseconds']:.0f} ms, "
            f"{row['vtk_ratio']:.2f} times ours"
            for row in result["cases"]
        ),
        *(
            f"in Blender {row['blender']} at {row['isovalue']:g}: {row['whole_ms']:.0f} ms to "
            f"{row['triangles']} triangles; while it moves {row['moving_ms']:.0f} ms, "
            f"{row['moving_triangles']} triangles"
            for row in result["blender"]
        ),
        *([f"absent: {'; '.join(result['absent'])} (--data)"] if result["absent"] else []),
    ]


def _blender():
    """Returns the version of Blender on the search path. Raises LeaflightError without one."""
    blender = shutil.which("blender")
    if blender is None:
        raise LeaflightError(
            "bench bake holds bakes against Cycles, and there is no Blender on the search path: "
            "install the Debian package blender."
        )
    done = subprocess.run([blender, "--version"], capture_output=True, text=True)
    return next(iter(done.stdout.splitlines()), None)
