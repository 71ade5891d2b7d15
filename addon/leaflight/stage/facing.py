# SPDX-License-Identifier: GPL-3.0-or-later
"""From where a volume wants to be looked at: its patient's face, where its file tells of one."""

import math

import leaflight
import numpy as np

from ..store import source_files

# Readers turn a patient's coordinates, whichever way the file counts them, towards right, front
# and up.
_FRONT = (0.0, 1.0, 0.0)


def quarter_turns(obj):
    """How often a stage, open towards -y, turns by 90 degrees about z to face a volume's front.

    Counterclockwise, 0 to 3; 0 where the file tells of no front.
    """
    if not _is_patient(obj.leaflight):
        return 0
    x, y, _ = np.array(obj.matrix_world, np.float64)[:3, :3] @ _FRONT
    if math.hypot(x, y) == 0:
        return 0
    return round((math.degrees(math.atan2(y, x)) + 90.0) / 90.0) % 4


def _is_patient(settings):
    try:
        path = source_files.path_of(settings)
        return source_files.probe(path, **source_files.choices_of(settings)).patient
    except leaflight.LeaflightError:
        # It is gone, or the volume was never in a file.
        return False
