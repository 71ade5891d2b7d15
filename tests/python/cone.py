# SPDX-License-Identifier: GPL-3.0-or-later
"""A volume whose bakes are noisy before they are anything else, and bakes that are stopped."""

import leaflight
import numpy as np

# Texels on each axis of cone(16), so fine that what they miss is far below their noise.
FINE = 31


def cone(nodes: int, is_open: bool = False, dimensions: int = 3) -> leaflight.Volume:
    """Its isosurfaces are balls, or half balls, whose light is smooth: texels miss little of it."""
    axis = np.linspace(-1, 1, nodes)
    first, *others = np.meshgrid(*[axis] * dimensions, indexing="ij")
    squares = (first - is_open) ** 2 + sum(other**2 for other in others)
    values = 100 * (1 - np.sqrt(squares))
    return leaflight.Volume(
        values.astype(np.float32), np.diag([1 / (nodes - 1)] * dimensions + [1.0]), "cone"
    )


def stopping(passes):
    """Returns (arguments of a bake that is stopped after so many passes, the bakes of these)."""
    progress, seen = leaflight.Progress(), []

    def look(baked):
        seen.append(baked)
        if len(seen) == passes:
            progress.stop()

    return {"on_pass": look, "progress": progress}, seen
