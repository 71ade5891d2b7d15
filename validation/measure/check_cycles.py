# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the bake and the core's path tracer with Cycles, feature by feature: docs/validation.md.

    validation/run check_cycles [NAME ...] [--points N] [--spp N] [--detail N]

prints a row of a Markdown table for each place that is measured: ratios of the mean radiance with
their standard errors, and the errors of the bake as `leaflight compare` reports them.
"""

import argparse
from dataclasses import dataclass, field, replace
from pathlib import Path

import leaflight
import numpy as np
from leaflight import _core
from leaflight.io.sources import open_volume
from leaflight.measure import cycles
from leaflight.measure.sampling import Sampling, Target
from leaflight.measure.truth import Truth, errors_of

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Place:
    """A place to measure: an isosurface of a volume, or a wall, on one side."""

    volume: int = 0
    mesh: str = None
    back: bool = False


ISOSURFACE = Place()
FLOOR = Place(mesh="floor")


@dataclass(frozen=True)
class Case:
    """A bake and the places where it is measured. sources: names of lights; None takes those of the
    scene.
    """

    name: str
    scene: str
    isovalues: tuple
    places: tuple
    sources: tuple = None
    dims: int = 48
    alone: str = None
    settings: dict = field(default_factory=dict)


LIGHTS = ("point", "spot", "even spot", "sun", "disc", "sky")
CASES = (
    Case(
        "walls",
        "cornell.json",
        (10.0, 47.0, 100.0),
        (ISOSURFACE, FLOOR, Place(mesh="back wall")),
        sources=("bump_box",),
    ),
    Case(
        "two fields",
        "nucleons.json",
        (0.2, 0.6),
        (Place(0), Place(1), FLOOR),
        dims=64,
    ),
    Case("mirror", "mirror.json", (47.0, 100.0), (ISOSURFACE, Place(mesh="bottom wall"))),
    Case("glass ball", "caustic.json", (47.0,), (ISOSURFACE, FLOOR)),
    Case("glass isosurface", "glass_isosurface.json", (47.0, 100.0), (FLOOR,)),
    Case("glowing isosurface", "emission.json", (0.2, 0.6), (Place(0), Place(1), FLOOR), dims=64),
    Case("texture", "texture.json", (47.0,), (ISOSURFACE, Place(mesh="far wall"))),
    Case(
        "both sides",
        "both_sides.json",
        (47.0, 100.0),
        (ISOSURFACE, Place(back=True)),
        settings={"both_sides": True},
    ),
    *(Case(name, "lights.json", (47.0,), (ISOSURFACE, FLOOR), alone=name) for name in LIGHTS),
)

# Points per pixel on a mesh. Cycles averages over a pixel, others use its center. On walls, with
# wide pixels, sharp shadows would make a difference.
MESH_POINTS = 4

HEAD = """\
| scene | where | c | path / Cycles | bake / Cycles | RMS % | of which noise | of the mean |
|---|---|---|---|---|---|---|---|"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases (all)")
    parser.add_argument("--points", type=int, default=3000, help="points of each place (3000)")
    parser.add_argument("--spp", type=int, default=1024, help="paths a point (1024)")
    parser.add_argument("--detail", type=int, default=2, help="cuts of a cell (2)")
    options = parser.parse_args()
    unknown = set(options.names) - {case.name for case in CASES}
    if unknown:
        parser.error(f"there is no case {', '.join(sorted(unknown))}")
    print(HEAD)
    for case in CASES:
        if not options.names or case.name in options.names:
            run(case, options.points, options.spp, options.detail)


def run(case, points, spp, detail):
    scene = leaflight.load_scene(ROOT / "scenes" / case.scene)
    if case.alone is not None:
        scene = lit_by(scene, case.alone)
    sources = case.sources or [isosurfaces.source for isosurfaces in scene.isosurfaces]
    volumes = [open_volume(source, dims=[case.dims]) for source in sources]
    walls = any(place.mesh for place in case.places)
    bake = leaflight.bake(volumes, scene, walls=walls, **case.settings)
    for c in case.isovalues:
        for place in case.places:
            print(row(case, bake, c, place, points, spp, detail), flush=True)


def lit_by(scene, name):
    """Returns the scene with only one light, by name, or with only the environment."""
    lights = [light for light in scene.lights if light.name == name]
    environment = scene.environment
    if environment is None or environment.name != name:
        environment = None
    return replace(scene, lights=lights, environment=environment)


def row(case, bake, c, place, points, spp, detail):
    mesh = None if place.mesh is None else bake.mesh_number(place.mesh)
    fields = [volume.field() for volume in bake.volumes]
    target = Target(place.volume, mesh, place.back)
    sampling = Sampling(points if mesh is None else MESH_POINTS * points, spp)
    measured = cycles.measure(bake.scene, fields, c, target, sampling, detail=detail)
    probes, truth = measured.probes, Truth.measured(measured)
    if mesh is None:
        own = bake.isovalue_of(place.volume, c)
        on_isosurface = _core.project_to_isosurface(fields[place.volume], probes.points, own)
        traced = bake.reference(on_isosurface, c, spp, volume=place.volume, back=place.back)
        baked = bake.radiance(probes.points, place.volume, place.back)
    else:
        at = (probes.facets, probes.coordinates)
        traced = bake.mesh_reference(mesh, at, c, spp, back=place.back)
        baked = bake.mesh_radiance(mesh, probes.points, c, place.back)
    by_path = Truth.traced(probes.points, *traced)
    where = place.mesh or bake.scene.isosurfaces[place.volume].name
    errors = errors_of(baked, truth, bake.scene.exposure)
    return (
        f"| {case.name} | {where}{', back' if place.back else ''} | {c:g} "
        f"| {mean_ratio(by_path, truth)} "
        f"| {errors['mean_ratio']:.4f} +- {errors['mean_ratio_error']:.4f} "
        f"| {errors['rms_percent']:.2f} | {errors['reference_noise_percent']:.2f} "
        f"| {100 * errors['relative_rms']:.1f} % |"
    )


def mean_ratio(by_path, truth):
    """Returns the mean radiance of the core's path tracer over that of Cycles, both with noise."""
    errors = errors_of(by_path.radiance, truth, 1.0)
    everywhere = np.ones(len(truth.points), dtype=bool)
    own = by_path.mean_error(everywhere) / by_path.radiance.mean()
    ratio = errors["mean_ratio"]
    return f"{ratio:.4f} +- {np.hypot(errors['mean_ratio_error'], ratio * own):.4f}"
