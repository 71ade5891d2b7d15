# SPDX-License-Identifier: GPL-3.0-or-later
"""Splits the error of default bakes into that of direct light and that of all other light.

    validation/run direct_against_paths --data DIR [--cases NAME ...] [--points N] [--spp N]

The cases are those of `validation/run against_cycles`; the core's path tracer is the truth, without
its noise. For direct light alone, walls are black and isosurfaces nearly black, and the exposure
restores the brightness. Prints a row for each isosurface (Markdown).
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of, without

from .judged_bakes import CASES

# Albedo so small that light after two bounces is negligible.
DARK = 1e-3


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, help="folder of real data sets")
    parser.add_argument("--cases", nargs="+", default=[""], help="parts of names (all)")
    parser.add_argument("--points", type=int, default=1200, help="points per isosurface (1200)")
    parser.add_argument("--spp", type=int, default=512, help="paths a point (512)")
    options = parser.parse_args()
    print("| bake | isovalue | all: RMS %, mean % | direct: RMS %, mean % | rest: RMS % |")
    print("|---|---|---|---|---|")
    for case in CASES:
        if any(name in case.name for name in options.cases):
            volumes = case.volumes(options.data, 1.0)
            if volumes is not None:
                rows_of(case, volumes, options)


def rows_of(case, volumes, options):
    baked = bake(volumes, packaged_scene(case.scene) if case.scene else None)
    direct = bake(volumes, darkened(baked.scene), isovalues=baked.isovalues)
    for number, volume in enumerate(volumes):
        name = f"{case.name}: {volume.name}" if len(volumes) > 1 else case.name
        for isovalue in case.isovalues:
            whole, mean = error_of(baked, isovalue, number, options)
            part, direct_mean = error_of(direct, isovalue, number, options)
            print(
                f"| {name} | {isovalue:g} | {whole:.2f}, {mean} | {part:.2f}, {direct_mean} "
                f"| {without(whole, part):.2f} |",
                flush=True,
            )


def darkened(scene):
    """Returns the scene with almost no indirect light."""
    return replace(
        scene,
        isosurfaces=[replace(look, albedo=scaled(look.albedo, DARK)) for look in scene.isosurfaces],
        meshes=[replace(mesh, albedo=(0.0, 0.0, 0.0)) for mesh in scene.meshes],
        exposure=scene.exposure / DARK,
    )


def scaled(ramp, factor):
    """Returns a color, or the stops of a ramp, times a factor."""
    if isinstance(ramp[0], (int, float)):
        return tuple(factor * channel for channel in ramp)
    return [(place, tuple(factor * channel for channel in color)) for place, color in ramp]


def error_of(baked, isovalue, volume, options):
    """Returns (RMS error in percent without the noise of the paths, deviation of the mean as
    text).
    """
    side = IsosurfaceSide(baked, isovalue, volume)
    truth = side.path_traced(options.points, options.spp, 1, 0, None)
    errors = errors_of(side.baked(truth.points), truth, baked.scene.exposure)
    ratio = errors["mean_ratio"]
    mean = "dark" if ratio is None or not np.isfinite(ratio) else f"{100 * (ratio - 1):+.1f}"
    return without(errors["rms_percent"], errors["reference_noise_percent"]), mean
