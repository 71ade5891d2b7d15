# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenVDB files from elsewhere, read by a process of their own.

OpenVDB trusts what it reads: a damaged file can end the process that opens it, or keep it busy for
hours. This one has limits of time and memory, and what it does, Blender survives.
"""

import json
import math
import os
import subprocess
import sys
import threading
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError

# Seconds of a processor for any file, and bytes that are read in one more.
LEAST_SECONDS = 60
BYTES_PER_SECOND = 1e6
# A processor is not always there for us alone.
WAIT = 5
_MOST_VOXELS = 2**31 - 1
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
_CHILD += "from leaflight.io.apart import child; child()"


def read_vdb_volume(path, grid):
    """(values float32 [z, y, x], index_to_world, name) of a scalar grid. Raises LeaflightError."""
    with _Process(path, "volume", grid) as process:
        answer = process.answer()
        shape = tuple(answer["shape"])
        if len(shape) != 3 or not 0 < math.prod(shape) <= _MOST_VOXELS:
            raise process.died()
        values = np.empty(shape, np.float32)
        process.fill(values)
    return values, np.array(answer["index_to_world"]), answer["name"]


def check_bake(path):
    """Raises LeaflightError where reading the file as a bake fails, in whatever way."""
    with _Process(path, "bake") as process:
        process.answer()


class _Process:
    def __init__(self, path, *job):
        self.path = path
        size = Path(path).stat().st_size
        self.seconds = math.ceil(LEAST_SECONDS + size / BYTES_PER_SECOND)
        job = json.dumps([str(path), self.seconds, *job])
        hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)
        try:
            self._process = subprocess.Popen(
                [_python(), "-c", _CHILD, json.dumps(sys.path), job],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                creationflags=hidden,
            )
        except OSError as error:
            raise LeaflightError(
                f"{path}: the process that is to read it cannot start: {error.strerror}; close "
                "other programs and try again."
            ) from None
        self._timer = threading.Timer(WAIT * self.seconds, self._process.kill)

    def __enter__(self):
        self._timer.start()
        return self

    def __exit__(self, *_):
        self._timer.cancel()
        self._process.kill()
        self._process.stdout.close()
        self._process.wait()

    def answer(self):
        """What the process says; its refusals are raised."""
        try:
            answer = json.loads(self._process.stdout.readline(1 << 20))
        except ValueError:
            raise self.died() from None
        if "error" in answer:
            raise LeaflightError(answer["error"])
        return answer

    def fill(self, values):
        left = memoryview(values).cast("B")
        while left:
            count = self._process.stdout.readinto(left)
            if not count:
                raise self.died()
            left = left[count:]

    def died(self):
        return LeaflightError(
            f"{self.path}: this OpenVDB file is damaged, or needs too much memory or more than "
            f"{self.seconds} s: the process that read it did not live to its end; fetch the file "
            "again."
        )


def _python():
    """The interpreter: where Python is part of a program, sys.executable may be another one."""
    names = ("bin/python{}.{}", "bin/python3", "bin/python.exe", "python.exe")
    for name in names:
        path = Path(sys.prefix, name.format(*sys.version_info))
        if path.is_file():
            return str(path)
    return sys.executable


def child():
    """Does one job and answers with a line of JSON, behind it the voxels."""
    path, seconds, kind, *options = json.loads(sys.argv[2])
    _limit(seconds)
    path, out = Path(path), sys.stdout.buffer
    try:
        if kind == "bake":
            _core.read_bake(path)
            answer, values = {}, b""
        else:
            values, index_to_world, name = _core.read_vdb_volume(path, *options)
            answer = {
                "shape": values.shape,
                "index_to_world": index_to_world.tolist(),
                "name": name,
            }
    except LeaflightError as error:
        answer, values = {"error": str(error)}, b""
    out.write(json.dumps(answer).encode() + b"\n")
    out.write(values)
    out.flush()
    # What libraries do at the end of a process does not matter any more.
    os._exit(0)


def _limit(seconds):
    try:
        import resource
    except ImportError:
        return  # Windows: the time is limited by who waits.
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for what, most in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (most, hard))
