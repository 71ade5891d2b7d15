# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how a bake scales with workers: time and traffic of 1, 2 and 4, for docs/validation.md.

    validation/run workers [--dims 100]

Each worker has one thread.
"""

import argparse
import os
import statistics
import sys
import time
from contextlib import nullcontext
from pathlib import Path

COUNTS = (1, 2, 4)
REPETITIONS = 3


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dims", type=int, default=100, help="nodes of the bump box's sides (100)")
    options = parser.parse_args()
    import leaflight
    from leaflight.cluster.workers import Workers

    volume = leaflight.bump_box(options.dims)
    seconds = {count: [] for count in (0, *COUNTS)}
    moved, ids, peak = {}, set(), {}
    for _ in range(REPETITIONS):
        for count in seconds:
            with Workers(count) if count else nullcontext() as workers:
                before = traffic()
                start = time.perf_counter()
                bake = leaflight.bake(volume, threads=1, workers=workers)
                seconds[count].append(time.perf_counter() - start)
                print(f"{count} workers: {seconds[count][-1]:.1f} s", file=sys.stderr, flush=True)
                ids.add(bake.id)
                if count:
                    moved[count] = traffic() - before
                    peak[count] = max(workers.client.run(peak_bytes).values())
                    assert not workers.lost
    assert len(ids) == 1, "the bakes differ"
    alone = statistics.median(seconds[0])
    print(f"{os.cpu_count()} cores, bump box of {options.dims}^3, one thread each")
    print("| workers | s | against one process | efficiency | MB moved | MB a worker |")
    print("|---|---|---|---|---|---|")
    print(f"| none | {alone:.2f} | 1 | | | |")
    for count in COUNTS:
        s = statistics.median(seconds[count])
        cores = min(count, os.cpu_count() or 1)
        print(
            f"| {count} | {s:.2f} | {alone / s:.2f} | {100 * alone / s / cores:.0f} % of {cores} "
            f"cores | {moved[count] / 1e6:.0f} | {peak[count] / 1e6:.0f} |"
        )


def peak_bytes():
    """Returns the peak memory of this process in bytes. ru_maxrss would include its parent."""
    lines = open("/proc/self/status").read().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def traffic():
    """Returns the bytes that were sent through the loopback."""
    folder = Path("/sys/class/net/lo/statistics")
    return sum(int((folder / f"{way}_bytes").read_text()) for way in ("rx", "tx"))
