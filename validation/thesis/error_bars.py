# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a table in docs/validation.md: how often reported errors cover the true ones."""

import argparse
from pathlib import Path

from leaflight import bump_box, load_scene
from leaflight.io.sources import open_volume
from leaflight.volume.particles import neuron, nucleons

from .coverage import coverage

ROOT = Path(__file__).resolve().parents[2]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
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
            found = coverage(
                volume,
                scene,
                seeds=options.seeds,
                estimator=estimator,
                photons=options.photons,
                isovalues=isovalues,
            )
            print(
                f"| {name} | {estimator} | {found.z.shape[1]} | {100 * found.within():.1f} % "
                f"| {100 * found.true_rms:.1f} % | {100 * found.reported_rms:.1f} % |",
                flush=True,
            )
