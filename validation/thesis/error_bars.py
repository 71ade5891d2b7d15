# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a table in docs/validation.md: how often reported errors cover the true ones.

Bakes that differ only in their seed are independent samples of one estimate. z is the deviation of
each from the mean of the others, over the reported error. It shows whether that error is true. The
bias, which all seeds share, does not show.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from leaflight import bump_box, load_scene
from leaflight.bake.color_error import rms
from leaflight.io.sources import open_volume
from leaflight.thesis import bake
from leaflight.volume.particles import neuron, nucleons

ROOT = Path(__file__).resolve().parents[2]
# Number of standard errors that contain 95 % of a normal distribution.
QUANTILE = 1.959963984540054


@dataclass(frozen=True, eq=False)
class Coverage:
    """The result. z: of each seed and lit texel, float64 (seeds, texels); true_rms and
    reported_rms: of the errors, over the mean radiance.
    """

    z: np.ndarray
    true_rms: float
    reported_rms: float

    def within(self, quantile=QUANTILE):
        """Returns the share of intervals of +- quantile errors that contain the other seeds'
        mean.
        """
        return float((np.abs(self.z) <= quantile).mean())


def coverage(volume, scene=None, *, seeds=6, **settings):
    """Bakes with each of `seeds` seeds. Raises LeaflightError, Cancelled."""
    values, errors = [], []
    for seed in range(1000, 1000 + seeds):
        grid = bake(volume, scene, seed=seed, **settings).grid
        active = grid.mask().astype(bool)
        values.append(grid.dense("radiance")[active].mean(axis=-1, dtype=np.float64))
        errors.append(np.float64(grid.dense("radiance_error")[active]))
    values, errors = np.array(values), np.array(errors)
    # Texels that are dark with all seeds have no error and no interval.
    lit = values.any(axis=0)
    values, errors = values[:, lit], errors[:, lit]
    # The mean of the others has the error of a bake over sqrt(seeds - 1). Scale the deviation from
    # it to the error of one bake.
    deviations = (values - values.mean(axis=0)) * np.sqrt(seeds / (seeds - 1))
    z = np.divide(deviations, errors, out=np.full_like(errors, np.inf), where=errors > 0)
    z[deviations == 0] = 0
    mean = values.mean()
    return Coverage(z, rms(deviations[..., None]) / mean, rms(errors[..., None]) / mean)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, default=32, help="nodes of the volumes per axis")
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--photons", type=int, default=200_000)
    parser.add_argument("--estimators", nargs="+", default=["gather", "volumetric", "path"])
    parser.add_argument("--volume", help="a file, or a generated volume, to bake instead")
    parser.add_argument("--dims", nargs="+", type=int, help="dims of a raw file, or nodes per axis")
    parser.add_argument("--type", help="type of the values in a raw file")
    parser.add_argument("--isovalues", nargs=2, type=float, help="its isovalue range")
    options = parser.parse_args()
    n = options.nodes
    cases = {
        "bump box": (bump_box(n), load_scene(ROOT / "scenes" / "bump_box.json"), None),
        "neuron": (neuron(n), None, (20.0, 200.0)),
        "nucleons": (nucleons(n)[0], None, (20.0, 170.0)),
    }
    if options.volume:
        volume = open_volume(options.volume, dims=options.dims, type=options.type)
        cases = {Path(options.volume).name: (volume, None, options.isovalues)}
    print("| volume | estimator | texels | within 95 % | true RMS | reported RMS |")
    print("|---|---|---|---|---|---|")
    for name, (volume, scene, isovalues) in cases.items():
        for estimator in options.estimators:
            work = {"seeds": options.seeds, "photons": options.photons, "isovalues": isovalues}
            found = coverage(volume, scene, estimator=estimator, **work)
            print(
                f"| {name} | {estimator} | {found.z.shape[1]} | {100 * found.within():.1f} % "
                f"| {100 * found.true_rms:.1f} % | {100 * found.reported_rms:.1f} % |",
                flush=True,
            )
