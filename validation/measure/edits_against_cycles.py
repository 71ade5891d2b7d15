# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares isosurfaces that another volume colors, and volumes that are cut, with Cycles.

    validation/run edits_against_cycles colors|cuts [NAME ...] [--data DIR] [--points N] [--spp N]

prints a row of a Markdown table for each isosurface. With colors it also prints one for each white
wall beside a ball with a red and a blue half. Cycles interpolates colors between vertices; the bake
has the color of the point. Their difference counts as an error of the bake. *Cut faces* are the
points where the data alone are higher than the isovalue.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import leaflight
import numpy as np
import volume_recipes
from leaflight import Volume, gradient_of
from leaflight.io.scene_file import cornell_box
from leaflight.measure.sampling import Sampling
from leaflight.measure.sides import IsosurfaceSide, MeshSide
from leaflight.measure.truth import errors_of
from leaflight.scene.volume_texture import VolumeTexture, sign_texture, texture_of
from leaflight.volume.label_field import without_sign
from leaflight.volume.regions import Box, HalfSpace, changed


@dataclass(frozen=True)
class Case:
    """An edited volume.

    volumes: a recipe (volume_recipes.py)
    edit: returns (volume, VolumeTexture or regions) of the volumes
    """

    name: str
    volumes: Callable
    edit: Callable
    isovalues: tuple


def by_gradient(tooth):
    """Returns a tooth, colored by the length of its gradient, up to 400 values a voxel."""
    return tooth, texture_of(gradient_of(tooth), "VIRIDIS", (0.0, 400.0 / min(tooth.spacing)))


def by_potential(density):
    """Returns an electron density, colored by the solution of Poisson's equation for it."""
    values = density.values.astype(np.float64)
    waves = np.meshgrid(*(np.fft.fftfreq(n) for n in values.shape), indexing="ij")
    square = sum(np.square(wave) for wave in waves)
    square[0, 0, 0] = np.inf
    potential = np.fft.ifftn(np.fft.fftn(values) / square).real.astype(np.float32)
    return density, texture_of(replace(density, values=potential), "CET_D1")


def by_second(density, potential):
    return density, texture_of(potential, "CET_D1", (-0.06, 0.06))


def by_sign(orbital):
    """Returns both lobes of an orbital, |h|, colored by the sign of h."""
    return without_sign(orbital), sign_texture(orbital)


def brain_and_regions(_, fineness):
    recipe = volume_recipes.together(*map(volume_recipes.read, ("ch2bet.nii.gz", "aal.nii.gz")))
    return recipe(volume_recipes.COLIN27.parent, fineness)


def by_label(brain, regions):
    """Returns a brain, colored by the regions of an atlas."""
    random = np.random.default_rng(1)
    colors = [(0.0, (0.8, 0.8, 0.8))]
    for label in range(1, int(regions.values.max()) + 1):
        colors.append((float(label), tuple(random.uniform(0.1, 0.9, 3).tolist())))
    return brain, VolumeTexture((regions,), colors, nearest=True)


def channels(nodes):
    """Returns the sum of three generated channels, as by a microscope, and the channels."""
    axis = np.linspace(-1.0, 1.0, nodes)
    random = np.random.default_rng(3)
    values = np.zeros((3, nodes, nodes, nodes), np.float32)
    for channel in values:
        for x, y, z in random.uniform(-0.7, 0.7, (12, 3)):
            planes = (axis - z)[:, None, None] ** 2, (axis - y)[:, None] ** 2, (axis - x) ** 2
            channel += 200.0 * np.exp(-sum(planes) / 0.03).astype(np.float32)
    place = {"spacing": 2.0 / (nodes - 1), "origin": -1.0, "name": "cells"}
    return [Volume(each, **place) for each in (values.sum(axis=0), *values)]


def by_channels(whole, *channels):
    return whole, texture_of(channels, value_range=(-20.0, 160.0))


def outside_of_box(low, high, angle, cut="capped"):
    """Returns an edit that cuts a box out, within shares of the volume's bounds, turned about z."""

    def edit(volume):
        ends = np.asarray(volume.field().bounds)
        corners = [ends[0] + np.array(share) * (ends[1] - ends[0]) for share in (low, high)]
        c, s = np.cos(angle), np.sin(angle)
        matrix = np.eye(4)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        matrix[:3, :3] = turn * (0.5 * (corners[1] - corners[0]))
        matrix[:3, 3] = 0.5 * (corners[0] + corners[1])
        return volume, [Box(tuple(map(tuple, matrix.tolist())), "outside", cut)]

    return edit


def half(normal):
    """Returns an edit that cuts a volume through the middle of its bounds."""

    def edit(volume):
        middle = np.mean(volume.field().bounds, axis=0)
        return volume, [HalfSpace(tuple(middle.tolist()), normal)]

    return edit


BUMP_BOX = volume_recipes.generated(leaflight.bump_box, 100)
ENGINE = volume_recipes.read("engine.vti")
DENSITY = volume_recipes.electron_density
COLORS = (
    Case("tooth by gradient", volume_recipes.tooth, by_gradient, (500.5, 900.5)),
    Case("electron density by potential", DENSITY, by_potential, (1.0, 1.5)),
    Case("caffeine by potential", volume_recipes.caffeine, by_second, (0.002, 0.01, 0.05)),
    Case("orbital by sign", volume_recipes.orbital, by_sign, (0.02, 0.1)),
    Case("brain by region", brain_and_regions, by_label, (45.5, 70.5)),
    Case(
        "microscopy by channel",
        volume_recipes.generated(channels, 72),
        by_channels,
        (60.0, 120.0),
    ),
)
BRAIN_BOX = outside_of_box((-0.1, 0.5, 0.4), (0.5, 1.2, 1.2), 0.2)
ENGINE_BOX = outside_of_box((0.4, -0.2, 0.3), (1.2, 0.55, 1.2), 0.15)
CUTS = (
    Case("bump box", BUMP_BOX, half((0.8, 0.5, 0.33)), (20.0, 47.0, 100.0)),
    Case("Colin27", volume_recipes.colin27, BRAIN_BOX, (24.5, 45.5, 100.5)),
    Case("tooth", volume_recipes.tooth, half((0.3, -1.0, 0.1)), (500.5, 900.5)),
    Case("engine", ENGINE, ENGINE_BOX, (50.5, 150.5)),
)

COLUMNS = "RMS % | of which noise | mean / Cycles"
HEADS = {
    "colors": f"volume and its color | isovalue | {COLUMNS} | white RMS % | seconds | its seconds",
    "cuts": f"volume | isovalue | {COLUMNS} | cut faces, share | {COLUMNS} | seconds",
    "walls": "white wall | red / blue | by Cycles | mean / Cycles: red | green | blue",
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=("colors", "cuts"))
    parser.add_argument("names", nargs="*", metavar="NAME", help="parts of names (all)")
    parser.add_argument("--data", type=Path, help="folder with the real volumes")
    parser.add_argument("--points", type=int, default=1200, help="points of each place (1200)")
    parser.add_argument("--spp", type=int, default=512, help="paths a point (512)")
    options = parser.parse_args()
    is_colored = options.kind == "colors"
    cases = COLORS if is_colored else CUTS
    print_head(options.kind)
    for case in cases:
        if not options.names or any(name in case.name for name in options.names):
            volumes = case.volumes(options.data, 1)
            if volumes is None:
                print(f"| {case.name} | absent |", flush=True)
            else:
                volume, edit = case.edit(*volumes)
                (color_rows if is_colored else cut_rows)(case, volume, edit, options)
    if is_colored and (not options.names or "walls" in options.names):
        wall_rows(options)


def print_head(kind):
    print(f"| {HEADS[kind]} |\n|{'---|' * (HEADS[kind].count('|') + 1)}")


def baked(volume, edit, scene, **options):
    """Returns a bake with a VolumeTexture, or with regions and the range from before."""
    if isinstance(edit, VolumeTexture):
        return leaflight.bake(volume, scene.colored_by(edit), progress=False, **options)
    isovalues = leaflight.default_isovalue_range(volume)
    cut = changed(volume, edit)
    return leaflight.bake(cut, scene, isovalues=isovalues, progress=False, **options)


def measured(side, options):
    """Returns (Truth, radiance of the bake at its points)."""
    truth = side.by_cycles(Sampling(options.points, options.spp, 1), leaflight.Progress())
    return truth, side.baked(truth.points)


def cells_of(bake, truth, radiance, mask=None):
    """Returns the cells under COLUMNS."""
    found = errors_of(radiance, truth, bake.scene.exposure, mask)
    ratio, error = found["mean_ratio"], found["mean_ratio_error"]
    noise = f"{found['reference_noise_percent']:.2f}"
    return [f"{found['rms_percent']:.2f}", noise, f"{ratio:.3f} +- {error:.3f}"]


def print_row(*cells):
    print(f"| {' | '.join(cells)} |", flush=True)


def color_rows(case, volume, texture, options):
    scene = cornell_box()
    white = replace(scene.isosurfaces[0], albedo=(0.8, 0.8, 0.8))
    colored = baked(volume, texture, scene)
    plain = leaflight.bake(volume, replace(scene, isosurfaces=[white]), progress=False)
    seconds = [f"{bake.statistics.seconds:.1f}" for bake in (colored, plain)]
    for isovalue in case.isovalues:
        found, by_white = (
            cells_of(bake, *measured(IsosurfaceSide(bake, isovalue), options))
            for bake in (colored, plain)
        )
        print_row(case.name, f"{isovalue:g}", *found, by_white[0], *seconds)


def cut_rows(case, volume, regions, options):
    bake = baked(volume, regions, cornell_box())
    low, high = volume.data_range()
    for isovalue in case.isovalues:
        truth, radiance = measured(IsosurfaceSide(bake, isovalue), options)
        is_cut = volume.field().sample(truth.points) > isovalue + 0.02 * (high - low)
        on_cut = cells_of(bake, truth, radiance, is_cut) if is_cut.any() else [""] * 3
        cells = [*cells_of(bake, truth, radiance), f"{is_cut.mean():.2f}", *on_cut]
        print_row(case.name, f"{isovalue:g}", *cells, f"{bake.statistics.seconds:.1f}")


def wall_rows(options):
    axis = np.linspace(-1.0, 1.0, 48, dtype=np.float32)
    square = axis**2 + axis[:, None] ** 2 + axis[:, None, None] ** 2
    ball = Volume(100.0 - 60.0 * np.sqrt(square), spacing=2.0 / 47, origin=-1.0, name="ball")
    halves = replace(ball, values=np.broadcast_to((axis > 0).astype(np.uint8), square.shape))
    colors = [(0.0, (0.9, 0.05, 0.05)), (1.0, (0.05, 0.05, 0.9))]
    scene = cornell_box()
    white = [replace(mesh, albedo=(0.8, 0.8, 0.8)) for mesh in scene.meshes]
    texture = texture_of(halves, colors, nearest=True)
    bake = baked(ball, texture, replace(scene, meshes=white), walls=True)
    print()
    print_head("walls")
    for name, back in (("beside red", False), ("beside blue", True)):
        side = MeshSide(bake, "right wall" if back else "left wall", 55.0, back)
        truth, radiance = measured(side, options)
        found, expected = (
            np.average(each, axis=0, weights=truth.weights) for each in (radiance, truth.radiance)
        )
        ratios = [f"{ratio:.3f}" for ratio in found / expected]
        print_row(name, f"{found[0] / found[2]:.3f}", f"{expected[0] / expected[2]:.3f}", *ratios)
