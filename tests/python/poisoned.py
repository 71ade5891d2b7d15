# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads files twice, in memory that holds two different patterns.

Values that differ were never written. The GNU C library fills allocated memory with
MALLOC_PERTURB_, in the process that reads and in those that it starts. NumPy, the arrays of volumes
and all libraries allocate there. NumPy itself reuses arrays of less than a kilobyte, so
numpy.empty() is filled here.
"""

import hashlib
import json
import os
import sys

import leaflight
import numpy as np
from leaflight.volume.memory import new_voxels
from waiting import run_python

# Two bytes that differ in each bit.
PATTERNS = (0x55, 0xAA)
# Name in place of a file, for a small and a large array that are never filled.
UNWRITTEN = "unwritten"


def answers(files):
    """Reads files [path, options of read_volume]; returns a list of texts for each pattern.

    A text is a hash of the volume behind "read ", or the sentence that refuses the file.
    """
    return [_answers(pattern, files) for pattern in PATTERNS]


def _answers(pattern, files):
    # Python's own allocator does not write the pattern.
    variables = {"PYTHONMALLOC": "malloc", "MALLOC_PERTURB_": str(pattern ^ 0xFF)}
    wanted = json.dumps([[str(path), options] for path, options in files])
    done = run_python(__file__, variables=variables, input=wanted)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def _answer(path, options):
    if path == UNWRITTEN:
        return [
            sorted({hex(byte) for byte in array.tolist()})
            for count in (100, 5000, 1 << 20)
            for array in (np.empty(count, np.uint8), new_voxels([count], np.uint8))
        ]
    try:
        volume = leaflight.read_volume(path, progress=False, **options)
    except leaflight.LeaflightError as error:
        return str(error)
    facts = (volume.values.dtype.str, volume.values.shape, volume.index_to_world.tolist())
    digest = hashlib.sha256(repr((facts, volume.unit, volume.notes)).encode())
    digest.update(np.ascontiguousarray(volume.values).data)
    return f"read {digest.hexdigest()}"


def _filled_empty(shape, dtype=float, *rest, **options):
    array = np.asarray(_EMPTY(shape, dtype, *rest, **options))
    if not array.dtype.hasobject:
        array.reshape(-1, order="A").view(np.uint8)[...] = int(os.environ["MALLOC_PERTURB_"]) ^ 0xFF
    return array


_EMPTY = np.empty
if __name__ == "__main__":
    np.empty = _filled_empty
    print(json.dumps([_answer(path, options) for path, options in json.load(sys.stdin)]))
