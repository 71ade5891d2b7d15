# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that tries damaged files on one target until its time is over.

    worker.py TARGET FOLDER SEED SECONDS COUNT

The current file is FOLDER/trying, so that it survives a crash of this process. The last line on
stdout is JSON: {"tried", "accepted", "slowest"}.
"""

import faulthandler
import json
import random
import resource
import signal
import sys
import time
from pathlib import Path

from mutate import mutated
from targets import BY_NAME, check, seeds_of

# Limits for one file of at most a megabyte, in seconds and bytes.
MOST_SECONDS = 60
MOST_MEMORY = 1 << 30


def main(name, folder, seed, seconds, count):
    target, folder = BY_NAME[name], Path(folder)
    seeds = seeds_of(target, folder)
    for data in seeds:
        assert check(target, folder, data, good=True)
    trying = folder / "trying"
    start, chance = time.monotonic(), random.Random(f"{name} {seed}")
    tried = accepted = 0
    slowest = 0.0
    faulthandler.enable()
    signal.signal(
        signal.SIGALRM, lambda *_: faulthandler.dump_traceback(sys.__stderr__) or sys.exit(3)
    )
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    while time.monotonic() - start < float(seconds) and tried < int(count):
        data = mutated(seeds, chance)
        trying.write_bytes(data)
        begin = time.monotonic()
        signal.alarm(MOST_SECONDS)
        accepted += check(target, folder, data)
        signal.alarm(0)
        slowest = max(slowest, time.monotonic() - begin)
        tried += 1
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        assert 1024 * grown < MOST_MEMORY, f"{grown // 1024} MB for {len(data)} bytes"
    trying.unlink(missing_ok=True)
    print(json.dumps({"tried": tried, "accepted": accepted, "slowest": round(slowest, 2)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
