# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench scale`: how seconds and memory of a bake grow with its size, and fall with threads."""

import os
from dataclasses import dataclass

import numpy as np

from .own_process import bake_bump_box
from .repetitions import repetitions


@dataclass(frozen=True)
class ScaleEffort:
    """sizes: nodes a side; threads_size: of what is baked with one thread and with two;
    often(seconds): see repetitions.py.
    """

    sizes: tuple = (16, 32, 48, 64, 96, 128)
    threads_size: int = 64
    often: object = repetitions


QUICK_SCALE = ScaleEffort((8, 12), 8, lambda _: 1)


def measure_scale(effort, run, *, seed=0, threads=0):
    """Measures bakes of bump boxes with the default settings, each in a separate process.

    Returns a dict of these entries. Times are medians by the clock.
    cases: by size, dicts of name, nodes, texels, rays, seconds, ns_per_texel, rays_per_second,
        peak_bytes (the peak of the whole process, with Python) and repetitions
    speedup_2_threads: seconds of one thread over seconds of two, which take turns; None on a
        machine with one core
    threads: a dict of nodes, seconds_1_thread, seconds_2_threads, repetitions

    run(work, label) returns work(progress). Raises LeaflightError, Cancelled.
    """

    def baked(nodes, threads):
        label = f"bench: bump box, {nodes}^3" + (f", threads: {threads}" if threads else "")
        return run(lambda progress: bake_bump_box(nodes, seed, threads, progress), label)

    runs = _in_turns(effort.sizes, lambda nodes: baked(nodes, threads), effort.often)
    cases = [_case(nodes, found) for nodes, found in runs.items()]
    pair = None
    if (os.cpu_count() or 1) > 1:
        both = _in_turns((1, 2), lambda n: baked(effort.threads_size, n), effort.often)
        one, two = (_median(both[n], "seconds") for n in (1, 2))
        pair = {
            "nodes": effort.threads_size,
            "seconds_1_thread": one,
            "seconds_2_threads": two,
            "repetitions": len(both[1]),
        }
    return {
        "cases": cases,
        "speedup_2_threads": pair and pair["seconds_1_thread"] / pair["seconds_2_threads"],
        "threads": pair,
    }


def _in_turns(items, work, often):
    """Returns the results of work(item) by item; the items take turns.

    often(seconds): how often an item's turn comes, all of which have the first.
    """
    runs = {item: [work(item)] for item in items}
    wanted = {item: often(found["seconds"]) for item, (found,) in runs.items()}
    for turn in range(1, max(wanted.values())):
        for item in items:
            if turn < wanted[item]:
                runs[item].append(work(item))
    return runs


def _case(nodes, found):
    seconds, texels, rays = _median(found, "seconds"), found[0]["texels"], found[0]["rays"]
    return {
        "name": f"bump box, {nodes}^3",
        "nodes": nodes,
        "texels": texels,
        "rays": rays,
        "seconds": seconds,
        "ns_per_texel": 1e9 * seconds / texels,
        "rays_per_second": rays / seconds,
        "peak_bytes": max(one["peak_bytes"] for one in found),
        "repetitions": len(found),
    }


def _median(found, name):
    return float(np.median([one[name] for one in found]))
