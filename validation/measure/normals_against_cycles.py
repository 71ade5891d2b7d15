# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the core's path tracer with Cycles by the angle between normals and triangles.

    validation/run normals_against_cycles VOLUME ISOVALUE [ISOVALUE ...] [--points N] [--spp N]

Nothing is baked. Each isosurface has a row for each range of the angle between the smooth normal
and the triangle's. A row contains the RMS difference of the colors in percent, and its share of all
squared differences (docs/validation.md).
"""

import argparse

import numpy as np
from leaflight import _core
from leaflight.bake.bake import placed
from leaflight.bake.color_error import rms_percent
from leaflight.io.sources import open_volume
from leaflight.measure import cycles
from leaflight.measure.sampling import Sampling
from leaflight.scene.on_mesh import positions
from leaflight.scene.scene import core_scene

SHARES = (0.0, 0.5, 0.75, 0.9, 1.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volume", help="a file, or a generated volume")
    parser.add_argument("isovalues", nargs="+", type=float, metavar="ISOVALUE")
    parser.add_argument("--points", type=int, default=1500, help="points per isosurface (1500)")
    parser.add_argument("--spp", type=int, default=1024, help="paths a point (1024)")
    options = parser.parse_args()
    volumes, scene, isovalue_range = placed([open_volume(options.volume)], None, None)
    print("| isovalue | angle | RMS % | of the squares |\n|---|---|---|---|")
    for isovalue in options.isovalues:
        angle, traced, truth = at_points(volumes[0], scene, isovalue_range, isovalue, options)
        whole = rms_percent(traced, truth, scene.exposure)
        print(f"| {isovalue:g} | all | {whole:.2f} | |")
        bounds = np.quantile(angle, SHARES)
        for low, high in zip(bounds[:-1], bounds[1:]):
            here = (angle >= low) & (angle <= high)
            rms = rms_percent(traced[here], truth[here], scene.exposure)
            print(
                f"| | {low:.0f} to {high:.0f} degrees | {rms:.2f} "
                f"| {here.mean() * (rms / whole) ** 2:.2f} |",
                flush=True,
            )


def at_points(volume, scene, isovalue_range, isovalue, options):
    """Returns angles in degrees (n,) and radiance (n, 3) by the path tracer and by Cycles, at mesh
    points.
    """
    field = volume.field()
    sampling = Sampling(options.points, options.spp)
    measured = cycles.measure(scene, [field], isovalue, sampling=sampling)
    probes = measured.probes
    on_isosurface = _core.project_to_isosurface(field, probes.points, isovalue)
    core = core_scene(scene, [field], isovalue_range)
    traced, _ = _core.reference(core, on_isosurface, isovalue, options.spp, seed=1)

    vertices, normals, triangles = _core.contour(field, isovalue)
    a, b, c = (np.float64(vertices[corner]) for corner in triangles[probes.facets].T)
    flat = np.cross(b - a, c - a)
    smooth = positions(normals, triangles, probes.facets, probes.coordinates)
    cosine = (flat * smooth).sum(axis=1) / (
        np.linalg.norm(flat, axis=1) * np.linalg.norm(smooth, axis=1)
    )
    return np.degrees(np.arccos(np.clip(cosine, -1, 1))), traced, measured.passes.mean(axis=0)
