# SPDX-License-Identifier: GPL-3.0-or-later
"""How often something is measured: five times, or as often as five minutes allow."""

import math

REPETITIONS = 5
PATIENCE_SECONDS = 300.0


def repetitions(seconds):
    """Returns how often to measure work of this many seconds, at least once."""
    return max(1, min(REPETITIONS, math.ceil(PATIENCE_SECONDS / max(seconds, 1e-9))))
