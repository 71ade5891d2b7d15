# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes one isosurface into its vertices by Cycles, and measures error and seconds.

The reference is Cycles with many more samples, at the same vertices with other seeds. The noise of
the reference is known from its spread and subtracted.
"""

from dataclasses import dataclass

import numpy as np
from leaflight import _core
from leaflight.measure.cycles import bake_vertices
from leaflight.measure.truth import Truth, errors_of, without
from leaflight.scene.scene import isovalue_at

# Approximate number of triangle corners at a vertex. Cycles bakes each corner, and a vertex gets
# their mean.
CORNERS = 6
# Independent passes of the reference, whose spread gives its noise.
REFERENCE_PASSES = 4
LEAST_REFERENCE_SAMPLES = 2
# Results for an error that no two measured points enclose.
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
        # This is the smallest measured error.
        return float(costs[np.argmin(errors)]), None
    first = int(np.argmax(above[:-1] != above[1:]))
    ends = slice(first, first + 2)
    order = np.argsort(errors[ends])
    x, y = np.log(errors[ends][order]), np.log(costs[ends][order])
    return float(np.exp(np.interp(np.log(error), x, y))), None


@dataclass(frozen=True, eq=False)
class Peer:
    """One isosurface for Cycles; scene, isovalue: of a Bake with one volume.

    mesh: (vertices, normals, triangles) by marching cubes, without the bake's split edges; most:
    upper bound on the samples of a pass.
    """

    scene: object
    isovalue: float
    mesh: tuple
    most: int

    @classmethod
    def of(cls, bake, isovalue, most_paths):
        """Returns the Peer of an isosurface. most_paths: upper bound of a pass, over all
        corners.
        """
        mesh = _core.contour(bake.volume.field(), isovalue_at(bake.scene, 0, isovalue))
        return cls(bake.scene, isovalue, mesh, max(2, most_paths // mesh[2].size))

    @property
    def vertices(self):
        return len(self.mesh[0])

    def reference(self, samples):
        """Returns (Truth of REFERENCE_PASSES passes with this number of samples, error of one
        pass).

        The error is RMS in percent, as everywhere here.
        """
        passes = [(samples, k) for k in range(REFERENCE_PASSES)]
        found = self._baked(passes).radiance
        truth = Truth.of_passes(self.mesh[0], np.ones(self.vertices), found)
        noise = errors_of(truth.radiance, truth, self.scene.exposure)["reference_noise_percent"]
        return truth, noise * np.sqrt(REFERENCE_PASSES)

    def measured(self, counts, repetition, truth):
        """Returns (errors, seconds) of passes with these counts of samples, float64 (n,) each.

        Seconds are wall-clock time, without Blender's start and its building of the scene; a
        warm-up pass precedes them. Seeds differ from the reference's and between repetitions.
        """
        seed = REFERENCE_PASSES + repetition
        found = self._baked([(count, seed) for count in (counts[0], *counts)])
        errors = [self._error(one, truth) for one in found.radiance[1:]]
        return np.array(errors), found.seconds[1:]

    def reference_samples(self, error, noise, paths):
        """Returns the number of samples per pass of the reference, for about this error.

        noise: RMS error in percent of a point with this many paths.
        """
        wanted = paths / CORNERS * (noise / max(error, 1e-9)) ** 2
        return int(np.clip(round(wanted), min(LEAST_REFERENCE_SAMPLES, self.most), self.most))

    def counts(self, error, samples, error_of_samples):
        """Returns sample counts around the one with which Cycles should have the error.

        error_of_samples: predicts the error of a number of samples.
        """
        wanted = samples * (error_of_samples / max(error, 1e-9)) ** 2
        middle = int(np.clip(round(wanted), 1, self.most))
        return sorted({max(1, middle // 2), middle, min(2 * middle, self.most)})

    def _baked(self, passes):
        return bake_vertices(self.scene, self.isovalue, self.mesh, passes)

    def _error(self, radiance, truth):
        found = errors_of(radiance, truth, self.scene.exposure)
        return without(found["rms_percent"], found["reference_noise_percent"])
