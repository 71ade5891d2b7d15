# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake takes: seconds of a processor, the most memory held, and bytes of a file."""

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Cost:
    """seconds: of a processor, all threads together; rays: None where not known; peak: the most
    bytes that the whole process held meanwhile; file: bytes of the file, None without one.
    """

    seconds: float
    rays: int
    peak: int
    file: int


def measured(work):
    """Returns (Bake, Cost) of work(), which bakes."""
    _forget_peak()
    start = time.process_time()
    baked = work()
    seconds = time.process_time() - start
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        path = Path(folder) / "bake.vdb"
        baked.save(path)
        size = path.stat().st_size
    statistics = baked.statistics
    return baked, Cost(seconds, statistics.rays, statistics.peak_memory_bytes, size)


def _forget_peak():
    """Resets the peak of the process's memory, if Linux allows it."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        pass
