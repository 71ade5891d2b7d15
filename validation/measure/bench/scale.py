# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench scale`: how time and memory of a bake grow with its size, and shrink with threads."""

import multiprocessing
import os
import re
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.volume.volume import bump_box
from written import table

from .page import REPETITIONS, measured_on, repetitions

MEBIBYTE = 2**20
# Nodes per axis: of the sizes, and of the bakes with one and two threads.
SIZES, THREADS_SIZE = (16, 32, 48, 64, 96, 128), 64
QUICK_SIZES, QUICK_THREADS_SIZE = (8, 12), 8


def scale_section(options):
    """Returns lines of Markdown about bakes of bump boxes with the default settings."""
    sizes, of_pair = (SIZES, THREADS_SIZE)
    often = repetitions
    if options.quick:
        sizes, of_pair, often = QUICK_SIZES, QUICK_THREADS_SIZE, lambda _: 1
    runs = in_turns(sizes, lambda nodes: bake_bump_box(nodes, 0), often)
    pair = []
    if (os.cpu_count() or 1) > 1:
        both = in_turns((1, 2), lambda threads: bake_bump_box(of_pair, threads), often)
        one, two = (_median(both[threads], "seconds") for threads in (1, 2))
        pair = [
            f"- {of_pair}^3 nodes take {one:.2f} s with one thread and {two:.2f} s with two. That "
            f"is {one / two:.2f} times as fast (medians of {len(both[1])}, in turns)."
        ]
    return [
        "## How bakes grow",
        "",
        measured_on(),
        "",
        "- Each bake has default settings and its own process. The peak is the most memory of "
        "that process, with Python and its modules. Seconds are wall-clock medians of "
        f"{REPETITIONS} bakes in turns, or fewer if one takes minutes.",
        *pair,
        "",
        *table([_row(nodes, found) for nodes, found in runs.items()]),
    ]


def in_turns(items, work, often):
    """Returns the results of work(item) by item; the items alternate.

    often(seconds): number of repetitions of an item, after the first.
    """
    runs = {item: [work(item)] for item in items}
    wanted = {item: often(found["seconds"]) for item, (found,) in runs.items()}
    for turn in range(1, max(wanted.values())):
        for item in items:
            if turn < wanted[item]:
                runs[item].append(work(item))
    return runs


def bake_bump_box(nodes, threads):
    """Returns seconds, rays, texels and peak memory of a bake in another process.

    A fork would start with this process's memory, and with locks of other threads.
    """
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_bake, nodes, threads).result()


def _bake(nodes, threads):
    scene = packaged_scene("bump_box.json")
    statistics = bake(bump_box(nodes), scene, threads=threads, progress=False).statistics
    # The peak in the statistics includes the process that started this one, because exec keeps it.
    peak = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())
    found = {name: getattr(statistics, name) for name in ("seconds", "rays", "texels")}
    return {**found, "peak": 1024 * int(peak[1])}


def _row(nodes, found):
    seconds, texels, rays = _median(found, "seconds"), found[0]["texels"], found[0]["rays"]
    return {
        "bake": f"bump box, {nodes}^3",
        "texels": f"{texels:,}",
        "s": f"{seconds:.2f}",
        "ns per texel": f"{1e9 * seconds / texels:,.0f}",
        "million rays/s": f"{rays / seconds / 1e6:.2f}",
        "peak MiB": f"{max(one['peak'] for one in found) / MEBIBYTE:.0f}",
        "repetitions": f"{len(found)}",
    }


def _median(found, name):
    return float(np.median([one[name] for one in found]))
