# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how a bake scales with workers: time and traffic of 1, 2 and 4, for docs/validation.md.

    validation/run workers [--dims 100] [--link MBIT]

Each worker has one thread. --link: as root, puts each into a separate network, joined by links of
this many megabits per second (iproute2).
"""

import argparse
import os
import signal
import statistics
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "build" / "release" / "python"

COUNTS = (1, 2, 4)
REPETITIONS = 3
BRIDGE, HOST = "leafbridge", "10.213.0.1"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dims", type=int, default=100, help="nodes of the bump box's sides (100)")
    parser.add_argument("--link", type=float, metavar="MBIT", help="megabits a second")
    options = parser.parse_args()
    # Exit normally, so that networks are removed.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    import leaflight
    from distributed import Client

    volume = leaflight.bump_box(options.dims)
    seconds = {count: [] for count in (0, *COUNTS)}
    moved, ids, peak = {}, set(), {}
    for _ in range(REPETITIONS):
        for count in seconds:
            with ExitStack() as opened:
                workers = None
                if count:
                    workers = opened.enter_context(started(count, options.link))
                    before = traffic(workers.client, options.link)
                start = time.perf_counter()
                bake = leaflight.bake(volume, threads=1, workers=workers)
                seconds[count].append(time.perf_counter() - start)
                print(f"{count} workers: {seconds[count][-1]:.1f} s", file=sys.stderr, flush=True)
                ids.add(bake.id)
                if count:
                    moved[count] = traffic(workers.client, options.link) - before
                    peak[count] = max(workers.client.run(peak_bytes).values())
                    assert isinstance(workers.client, Client) and not workers.lost
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


def traffic(client, link):
    """Returns the bytes that were sent over the links, or through the loopback."""
    name = BRIDGE if link else "lo"
    folder = Path("/sys/class/net") / name / "statistics"
    return sum(int((folder / f"{way}_bytes").read_text()) for way in ("rx", "tx"))


@contextmanager
def started(count, link):
    from leaflight.cluster.workers import Workers

    if not link:
        with Workers(count) as workers:
            yield workers
        return
    with networks(count, link) as address, Workers(scheduler=address) as workers:
        workers.client.wait_for_workers(count, timeout=60)
        yield workers


@contextmanager
def networks(count, megabits):
    """Yields a Dask scheduler here, and workers in networks of their own; its address."""
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
    processes = []
    ip("link", "add", BRIDGE, "type", "bridge")
    try:
        ip("addr", "add", f"{HOST}/24", "dev", BRIDGE)
        ip("link", "set", BRIDGE, "up")
        scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", HOST]
        processes.append(start([*scheduler, "--port", "8786", "--no-dashboard"], environment))
        for k in range(count):
            name, inner, outer = f"isosurface{k}", f"leafin{k}", f"leafout{k}"
            ip("netns", "add", name)
            ip("link", "add", outer, "type", "veth", "peer", "name", inner, "netns", name)
            ip("link", "set", outer, "master", BRIDGE, "up")
            ip("-n", name, "addr", "add", f"10.213.0.{k + 2}/24", "dev", inner)
            ip("-n", name, "link", "set", inner, "up")
            ip("-n", name, "link", "set", "lo", "up")
            shape = ["tbf", "rate", f"{megabits}mbit", "latency", "50ms"]
            # Allow this much per tick of the kernel's clock, of which there are 250 per second.
            shape += ["burst", f"{max(1, megabits / 100):g}mbit"]
            run("tc", "qdisc", "add", "dev", outer, "root", *shape)
            run("ip", "netns", "exec", name, "tc", "qdisc", "add", "dev", inner, "root", *shape)
            worker = ["ip", "netns", "exec", name, sys.executable]
            worker += ["-m", "distributed.cli.dask_worker", f"tcp://{HOST}:8786", "--nthreads", "1"]
            worker += ["--memory-limit", "0", "--no-dashboard", "--local-directory", "/tmp"]
            processes.append(start(worker, environment))
        yield f"tcp://{HOST}:8786"
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait()
        for k in range(count):
            # The system removes links of a deleted network only after some time.
            subprocess.run(["ip", "link", "del", f"leafout{k}"], capture_output=True)
            subprocess.run(["ip", "netns", "del", f"isosurface{k}"], capture_output=True)
        ip("link", "del", BRIDGE)


def start(command, environment):
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def ip(*arguments):
    run("ip", *arguments)


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
