# SPDX-License-Identifier: GPL-3.0-or-later
"""At what cost an error is reached, read between measured points and never beyond them."""

import numpy as np

# Place of an error that no two measured points enclose.
FEWER = "fewer samples than measured"
MORE = "more samples than measured"


def cost_at(error, errors, costs):
    """Returns (cost, outside): the cost at an error, log-linear between two measured points.

    errors, costs: (n,), above 0, in the order of their samples, fewest first. Errors fall, apart
    from chance: the first two neighbors that enclose the error count. If none do, cost is None and
    outside is FEWER or MORE, the samples that this error needs. Otherwise outside is None.
    """
    errors, costs = np.float64(errors), np.float64(costs)
    if not (error > 0 and error >= errors.min()):
        return None, MORE
    if error > errors.max():
        return None, FEWER
    above = errors >= error
    if above.all() or len(errors) == 1:
        # The least error itself.
        return float(costs[np.argmin(errors)]), None
    first = int(np.argmax(above[:-1] != above[1:]))
    ends = slice(first, first + 2)
    order = np.argsort(errors[ends])
    x, y = np.log(errors[ends][order]), np.log(costs[ends][order])
    return float(np.exp(np.interp(np.log(error), x, y))), None
