# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares isosurfaces that another volume colors with Cycles, which has the colors on the mesh.

    validation/run colors_against_cycles [--data DIR] [--points N] [--spp N]

prints a row of a Markdown table for each isosurface, and one for each white wall beside a ball with
a red and a blue half. Cycles interpolates colors between vertices;
the bake has the color of the point. Their difference counts as an error of the bake.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import leaflight
import numpy as np
import volume_recipes
from leaflight import Volume, gradient_of, read_volume
from leaflight.io.scene_file import cornell_box
from leaflight.measure.sides import MeshSide
from leaflight.scene.volume_texture import VolumeTexture, sign_texture, texture_of
from leaflight.volume.lobes import without_sign

TEMPLATES = volume_recipes.COLIN27.parent


@dataclass(frozen=True)
class Case:
    """make(folder): returns (volume, VolumeTexture), or None without the data."""

    name: str
    make: Callable
    isovalues: tuple


def by_gradient(folder):
    """Returns a tooth, colored by the length of its gradient, up to 400 values a voxel."""
    volumes = volume_recipes.tooth(folder, 1)
    if volumes is None:
        return None
    limits = 0.0, 400.0 / min(volumes[0].spacing)
    return volumes[0], texture_of(gradient_of(volumes[0]), "VIRIDIS", limits)


def by_potential(folder):
    """Returns an electron density, colored by the solution of Poisson's equation for it."""
    volumes = volume_recipes.electron_density(folder, 1)
    if volumes is None:
        return None
    values = volumes[0].values.astype(np.float64)
    waves = np.meshgrid(*(np.fft.fftfreq(n) for n in values.shape), indexing="ij")
    square = sum(np.square(wave) for wave in waves)
    square[0, 0, 0] = np.inf
    potential = np.fft.ifftn(np.fft.fftn(values) / square).real.astype(np.float32)
    return volumes[0], texture_of(replace(volumes[0], values=potential), "CET_D1")


def by_sign(folder):
    """Returns both lobes of an orbital, |h|, colored by the sign of h."""
    volumes = volume_recipes.orbital(folder, 1)
    if volumes is None:
        return None
    return without_sign(volumes[0]), sign_texture(volumes[0])


def by_label(_):
    """Returns a brain, colored by the regions of an atlas."""
    brain, regions = TEMPLATES / "ch2bet.nii.gz", TEMPLATES / "aal.nii.gz"
    if not (brain.exists() and regions.exists()):
        return None
    labels = read_volume(str(regions))
    count = int(labels.values.max())
    random = np.random.default_rng(1)
    colors = [(0.0, (0.8, 0.8, 0.8))]
    colors += [(float(i), tuple(random.uniform(0.1, 0.9, 3).tolist())) for i in range(1, count + 1)]
    return read_volume(str(brain)), VolumeTexture((labels,), colors, nearest=True)


def by_channels(_):
    """Returns a generated stack of three channels, as by a microscope, lit where their sum is."""
    axis = np.linspace(-1.0, 1.0, 72)
    random = np.random.default_rng(3)
    channels = []
    for _ in range(3):
        values = np.zeros((72, 72, 72), np.float32)
        for x, y, z in random.uniform(-0.7, 0.7, (12, 3)):
            square = (
                (axis[None, None, :] - x) ** 2
                + (axis[None, :, None] - y) ** 2
                + (axis[:, None, None] - z) ** 2
            )
            values += 200.0 * np.exp(-square / 0.03).astype(np.float32)
        channels.append(Volume(values, spacing=2.0 / 71, origin=-1.0, name="cells"))
    whole = replace(channels[0], values=sum(channel.values for channel in channels))
    return whole, texture_of(channels, value_range=(-20.0, 160.0))


CASES = (
    Case("tooth by gradient", by_gradient, (500.5, 900.5)),
    Case("electron density by potential", by_potential, (1.0, 1.5)),
    Case("orbital by sign", by_sign, (0.02, 0.1)),
    Case("brain by region", by_label, (45.5, 70.5)),
    Case("microscopy by channel", by_channels, (60.0, 120.0)),
)

HEAD = """\
| volume and its color | isovalue | RMS % | of which noise | white RMS % | mean / Cycles \
| seconds | white seconds |
|---|---|---|---|---|---|---|---|"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="parts of names (all)")
    parser.add_argument("--data", type=Path, help="folder with the real volumes")
    parser.add_argument("--points", type=int, default=1200, help="points of each place (1200)")
    parser.add_argument("--spp", type=int, default=512, help="paths a point (512)")
    options = parser.parse_args()
    print(HEAD)
    for case in CASES:
        if options.names and not any(name in case.name for name in options.names):
            continue
        made = case.make(options.data)
        if made is None:
            print(f"| {case.name} | absent |", flush=True)
            continue
        volume, texture = made
        rows(case, volume, texture, options)
    if not options.names or "walls" in options.names:
        wall_rows(options)


def rows(case, volume, texture, options):
    colored, plain = (
        leaflight.bake(volume, scene_with(each), progress=False) for each in (texture, None)
    )
    sampling = {"points": options.points, "spp": options.spp, "reference": "cycles", "seed": 1}
    for isovalue in case.isovalues:
        found, white = (
            leaflight.compare(bake, isovalue, progress=False, **sampling)
            for bake in (colored, plain)
        )
        print(
            f"| {case.name} | {isovalue:g} | {found['rms_percent']:.2f} "
            f"| {found['reference_noise_percent']:.2f} | {white['rms_percent']:.2f} "
            f"| {found['mean_ratio']:.3f} +- {found['mean_ratio_error']:.3f} "
            f"| {colored.statistics.seconds:.1f} | {plain.statistics.seconds:.1f} |",
            flush=True,
        )


HEAD_OF_WALLS = """
| white wall | red / blue | by Cycles | mean / Cycles: red | green | blue |
|---|---|---|---|---|---|"""


def wall_rows(options):
    axis = np.linspace(-1.0, 1.0, 48, dtype=np.float32)
    square = axis**2 + axis[:, None] ** 2 + axis[:, None, None] ** 2
    ball = Volume(100.0 - 60.0 * np.sqrt(square), spacing=2.0 / 47, origin=-1.0, name="ball")
    halves = replace(ball, values=np.broadcast_to((axis > 0).astype(np.uint8), square.shape))
    colors = [(0.0, (0.9, 0.05, 0.05)), (1.0, (0.05, 0.05, 0.9))]
    scene = scene_with(texture_of(halves, colors, nearest=True))
    white = [replace(mesh, albedo=(0.8, 0.8, 0.8)) for mesh in scene.meshes]
    bake = leaflight.bake(ball, replace(scene, meshes=white), walls=True, progress=False)
    print(HEAD_OF_WALLS)
    for name, back in (("beside red", False), ("beside blue", True)):
        side = MeshSide(bake, "right wall" if back else "left wall", 55.0, back)
        truth = side.by_cycles(options.points, options.spp, 1, 0, None)
        found, expected = (
            np.average(radiance, axis=0, weights=truth.weights)
            for radiance in (side.baked(truth.points), truth.radiance)
        )
        ratios = " | ".join(f"{ratio:.3f}" for ratio in found / expected)
        both = f"{found[0] / found[2]:.3f} | {expected[0] / expected[2]:.3f}"
        print(f"| {name} | {both} | {ratios} |", flush=True)


def scene_with(texture):
    """Returns the Cornell box with isosurfaces of albedo 0.8, or with a texture."""
    scene = cornell_box()
    if texture is not None:
        return scene.colored_by(texture)
    isosurfaces = replace(scene.isosurfaces[0], albedo=(0.8, 0.8, 0.8))
    return replace(scene, isosurfaces=[isosurfaces])
