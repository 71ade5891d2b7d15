# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts processor seconds of a bake and of its workers, for docs/validation.md.

    validation/run workers [--volume FILE | --dims 100] [--workers 2 16] [--walls]

Each worker has one thread. Processor seconds of the bake's process show what stays in it, whatever
the number of processors here.
"""

import argparse
import os
import sys
import time
from contextlib import nullcontext
from pathlib import Path


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--volume", help="file of a volume, instead of a bump box")
    parser.add_argument("--dims", type=int, default=100, help="nodes of the bump box's sides (100)")
    parser.add_argument("--workers", type=int, nargs="+", default=[2, 16])
    parser.add_argument("--walls", action="store_true", help="also light the walls")
    options = parser.parse_args()
    import leaflight
    from leaflight.cluster.workers import Workers

    if options.volume:
        volume = leaflight.read_volume(options.volume)
    else:
        volume = leaflight.bump_box(options.dims)
    name = options.volume and Path(options.volume).name or f"bump box of {options.dims}^3"
    print(f"{name}, {os.cpu_count()} cores, one thread a worker")
    print("| workers | s | processor s of the bake | share | of all workers | MB moved | MB each |")
    print("|---|---|---|---|---|---|---|")
    ids, alone = set(), None
    for count in (0, *options.workers):
        with Workers(count) if count else nullcontext() as workers:
            before, moved, used = seconds(), traffic(), workers and sum_of(workers, seconds)
            start = time.perf_counter()
            bake = leaflight.bake(volume, walls=options.walls, workers=workers)
            wall, own = time.perf_counter() - start, seconds() - before
            alone = alone or own
            ids.add(bake.id)
            others = peak = moved_megabytes = 0
            if count:
                assert not workers.lost, f"{workers.lost} parts were lost"
                others = sum_of(workers, seconds) - used
                moved_megabytes = (traffic() - moved) / 1e6
                peak = max(workers.client.run(peak_bytes).values()) / 1e6
        print(
            f"| {count or 'none'} | {wall:.1f} | {own:.1f} | {100 * own / alone:.0f} % "
            f"| {others:.1f} | {moved_megabytes:.0f} | {peak:.0f} |",
            flush=True,
        )
    if len(ids) != 1:
        sys.exit("workers: the bakes differ.")


def seconds():
    """Returns the processor seconds of this process; the bake's process also runs the scheduler."""
    return time.process_time()


def sum_of(workers, measure):
    return sum(workers.client.run(measure).values())


def peak_bytes():
    """Returns the peak memory of this process in bytes. ru_maxrss would include its parent."""
    lines = open("/proc/self/status").read().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def traffic():
    """Returns the bytes that were sent through the loopback."""
    folder = Path("/sys/class/net/lo/statistics")
    return sum(int((folder / f"{way}_bytes").read_text()) for way in ("rx", "tx"))
