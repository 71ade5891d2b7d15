# SPDX-License-Identifier: GPL-3.0-or-later
"""A small volume in a cone of light, whose bakes err mainly by noise, and bakes that stop early."""

import leaflight
import numpy as np

# Texels per axis of cone(16). They are so fine that texture error is far below the noise.
FINE = 31


def cone(nodes: int, is_open: bool = False, dimensions: int = 3) -> leaflight.Volume:
    """Returns balls, or half balls, with smooth light, so that texels miss little of it."""
    axis = np.linspace(-1, 1, nodes)
    first, *others = np.meshgrid(*[axis] * dimensions, indexing="ij")
    squares = (first - is_open) ** 2 + sum(other**2 for other in others)
    values = 100 * (1 - np.sqrt(squares))
    return leaflight.Volume(
        values.astype(np.float32), np.diag([1 / (nodes - 1)] * dimensions + [1.0]), "cone"
    )


def stopping(passes):
    """Returns (arguments of a bake that stops after this many passes, a list of its passes)."""
    progress, seen = leaflight.Progress(), []

    def look(baked):
        seen.append(baked)
        if len(seen) == passes:
            progress.stop()

    return {"on_pass": look, "progress": progress}, seen
