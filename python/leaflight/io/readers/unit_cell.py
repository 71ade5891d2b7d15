# SPDX-License-Identifier: GPL-3.0-or-later
"""Unit cells of crystals, from the lengths of edges and the angles between them."""

from collections.abc import Sequence

import numpy as np

from ...arrays import Array


def cell_axes(sizes: Sequence[float] | Array, angles: Sequence[float]) -> Array:
    """Returns the edges a, b and c, in columns: a along x, b in the plane of x and y.

    angles: alpha, beta and gamma in degrees. Old files use 0 for right angles.
    """
    cosines = [np.cos(np.radians(angle or 90.0)) for angle in angles]
    alpha, beta, gamma = [0.0 if abs(cosine) < 1e-9 else float(cosine) for cosine in cosines]
    sine = np.sqrt(1 - gamma**2)
    lean = (alpha - beta * gamma) / sine
    edges = [[1, gamma, beta], [0, sine, lean], [0, 0, np.sqrt(1 - beta**2 - lean**2)]]
    return np.array(edges, np.float64) * sizes
