# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares cut volumes, baked by default in the Cornell box, with Cycles or our path tracer.

    validation/run cuts_against_cycles [NAME ...] [--data DIR] [--reference path]

prints a row of a Markdown table for each isosurface. *Cut* are the points on the cut faces, where
the data alone are higher than the isovalue.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import leaflight
import numpy as np
import volume_recipes
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of
from leaflight.volume.regions import Box, HalfSpace, changed


@dataclass(frozen=True)
class Case:
    """make(folder): returns (volume, regions), or None without the data."""

    name: str
    make: Callable
    isovalues: tuple


def turned_box(volume, low, high, angle, cut="capped"):
    """Returns the outside of a box within shares of the volume's bounds, turned about z."""
    ends = np.asarray(volume.field().bounds)
    low, high = (ends[0] + np.array(share) * (ends[1] - ends[0]) for share in (low, high))
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) * (0.5 * (high - low))
    matrix[:3, 3] = 0.5 * (low + high)
    return Box(tuple(map(tuple, matrix.tolist())), "outside", cut)


def bump_box(_):
    volume = leaflight.bump_box(100)
    return volume, [HalfSpace((0.5, 0.5, 0.5), (0.8, 0.5, 0.33))]


def brain(folder):
    """Returns Colin27 without a quarter, cut by a turned box."""
    path = folder / "ch2.nii.gz" if folder else Path()
    if not path.is_file():
        return None
    volume = leaflight.read_volume(path)
    return volume, [turned_box(volume, (-0.1, 0.5, 0.4), (0.5, 1.2, 1.2), 0.2)]


def tooth(folder):
    volumes = volume_recipes.tooth(folder, 1)
    if volumes is None:
        return None
    middle = np.mean(volumes[0].field().bounds, axis=0)
    return volumes[0], [HalfSpace(tuple(middle.tolist()), (0.3, -1.0, 0.1))]


def engine(folder):
    path = folder / "engine.vti" if folder else Path()
    if not path.is_file():
        return None
    volume = leaflight.read_volume(path)
    return volume, [turned_box(volume, (0.4, -0.2, 0.3), (1.2, 0.55, 1.2), 0.15)]


CASES = (
    Case("bump box", bump_box, (20.0, 47.0, 100.0)),
    Case("Colin27", brain, (24.5, 45.5, 100.5)),
    Case("tooth", tooth, (500.5, 900.5)),
    Case("engine", engine, (50.5, 150.5)),
)

HEAD = """\
| volume | isovalue | RMS % | of which noise | mean / reference | cut faces, share | RMS % \
| of which noise | mean / reference | seconds |
|---|---|---|---|---|---|---|---|---|---|"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="parts of names (all)")
    parser.add_argument("--data", type=Path, help="folder with the real volumes")
    parser.add_argument("--points", type=int, default=1200, help="points of each place (1200)")
    parser.add_argument("--spp", type=int, default=512, help="paths a point (512)")
    parser.add_argument("--reference", choices=("cycles", "path"), default="cycles")
    options = parser.parse_args()
    print(HEAD)
    for case in CASES:
        if options.names and not any(name in case.name for name in options.names):
            continue
        made = case.make(options.data)
        if made is None:
            print(f"| {case.name} | absent |", flush=True)
            continue
        volume, regions = made
        rows(case, volume, regions, options)


def rows(case, volume, regions, options):
    cut = changed(volume, regions)
    isovalues = leaflight.default_isovalue_range(volume)
    bake = leaflight.bake(cut, isovalues=isovalues, progress=False)
    whole = volume.field()
    for isovalue in case.isovalues:
        side = IsosurfaceSide(bake, isovalue, 0, False)
        trace = side.path_traced if options.reference == "path" else side.by_cycles
        truth = trace(options.points, options.spp, 1, 0, leaflight.Progress())
        baked, exposure = side.baked(truth.points), bake.scene.exposure
        low, high = volume.data_range()
        is_cut = whole.sample(truth.points) > isovalue + 0.02 * (high - low)
        found = errors_of(baked, truth, exposure)
        cells = [case.name, f"{isovalue:g}", *cells_of(found), f"{is_cut.mean():.2f}"]
        if is_cut.any():
            cells += cells_of(errors_of(baked, truth, exposure, is_cut))
        else:
            cells += [""] * 3
        print(f"| {' | '.join(cells)} | {bake.statistics.seconds:.1f} |", flush=True)


def cells_of(found):
    ratio, error = found["mean_ratio"], found["mean_ratio_error"]
    noise = f"{found['reference_noise_percent']:.2f}"
    return [f"{found['rms_percent']:.2f}", noise, f"{ratio:.3f} +- {error:.3f}"]


if __name__ == "__main__":
    main()
