# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- NAME DATA WORK OUT.

Renders a picture of docs/gallery.md: isosurfaces colored by another volume, and cut ones. DATA
holds real volumes, and WORK the files of make_molecule.py.
"""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
import mathutils
import numpy as np
import tifffile
from leaflight import blender
from leaflight_addon.importing import channels
from leaflight_addon.show import display

sys.path.append(str(Path(__file__).parent))

from rendering import empty_scene, rendered, turn
from sheets import save_webp

BRAINS = Path("/usr/share/mricron/templates")
SAMPLES = 24
ERROR, SECONDS = 2.0, 50.0
# Stops of exposure above that of the stage.
EXPOSURE = 0.6


@dataclass(frozen=True)
class Figure:
    """A picture.

    make: Function of DATA and WORK. Imports and returns the volume.
    isovalue, isovalues: Isovalue and isovalue range.
    turn: Rotation of the volume about x, y, z in degrees. zoom: Factor on the camera's angle.
    rise: Degrees by which the camera looks down more.
    resolution: Texels along the longest side; 0 is the default.
    is_cut: True cuts the data by a new clip box, at the corner nearest to the camera.
    look: A preset of the isosurface. size: Width and height in pixels.
    """

    make: Callable
    isovalue: float
    isovalues: tuple
    turn: tuple = (0.0, 0.0, 0.0)
    rise: float = 0.0
    zoom: float = 1.0
    resolution: int = 0
    is_cut: bool = False
    has_bar: bool = False
    look: str = ""
    size: tuple = (1280, 800)


def main():
    name, *folders = sys.argv[-4:]
    data, work, out = map(Path, folders)
    figure = FIGURES[name]
    empty_scene()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = figure.size
    obj = figure.make(data, work)
    for each in scene.objects:
        turn(each, *figure.turn)
    blender.show(obj, figure.isovalue)
    blender.stage(obj)
    if figure.is_cut:
        bpy.ops.leaflight.add_clip_box()
        bpy.ops.leaflight.cut_data(cut="capped")
        # The box would still cut the shown isosurface, along the same faces.
        obj.leaflight_look.box = None
    if figure.look:
        bpy.ops.leaflight.isosurface_preset(preset=figure.look)
    frame(obj, figure.rise, figure.zoom)
    limits = {"error": ERROR, "use_time_limit": True, "time_limit": SECONDS}
    if figure.resolution:
        limits |= {"use_resolution": True, "resolution": figure.resolution}
    blender.bake(obj, isovalues=figure.isovalues, light_walls=True, bake_folder=str(work), **limits)
    blender.show(obj, figure.isovalue)
    if figure.has_bar:
        bpy.ops.leaflight.add_color_bar()
    scene.view_settings.exposure += EXPOSURE
    picture = rendered(work / f"{name}.png", figure.size, SAMPLES)
    save_webp(picture, out / f"{name}.webp")
    print("docs/images", name)


def frame(obj, rise, zoom):
    """Moves the camera up around the volume by degrees, and narrows its angle by a factor."""
    camera = bpy.context.scene.camera
    middle = sum(
        (obj.matrix_world @ mathutils.Vector(c) for c in obj.bound_box), mathutils.Vector()
    )
    middle /= 8
    right = camera.matrix_world.to_3x3().col[0]
    turn = mathutils.Matrix.Rotation(math.radians(-rise), 4, right)
    around = mathutils.Matrix.Translation(middle)
    camera.matrix_world = around @ turn @ around.inverted() @ camera.matrix_world
    camera.data.angle /= zoom


def color(obj, other, kind="", limits=None, colors=""):
    """Colors a volume by another one, which is hidden."""
    settings = obj.leaflight
    settings.texture_volume = other
    if other is not None:
        other.hide_render = True
        other.hide_set(True)
    if kind:
        settings.texture_kind = kind
    if colors:
        settings.texture_map = colors
    if limits:
        settings.texture_low, settings.texture_high = limits
    display.select(bpy.context, [obj], obj)
    return obj


def density(_, work):
    obj = blender.import_volume(work / "caffeine_density.cube")
    obj.name = "electron density"
    other = blender.import_volume(
        work / "caffeine_potential.cube", size_from="SAME", partner=obj.name, both_signs=False
    )
    other.name = "potential (Hartree/e)"
    obj.leaflight.texture_reverse = True
    return color(obj, other, "", (-0.06, 0.06), "CET_D1")


def cells(_, work):
    """Generates cells of random colors as a stack of three channels, as in a Brainbow mouse."""
    count, random = 112, np.random.default_rng(5)
    axis = np.linspace(-1.0, 1.0, count, dtype=np.float32)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    values, places = np.zeros((3, count, count, count), np.float32), []
    while len(places) < 40:
        place = random.uniform((-0.74, -0.74, -0.4), (0.74, 0.74, 0.5))
        is_far = all(np.linalg.norm(place - other) > 0.3 for other in places)
        if is_far and np.linalg.norm(place * (1.0, 1.0, 1.0 if place[2] > 0 else 0.5)) < 0.74:
            places.append(place)
    for place in places:
        axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
        radii = random.uniform(0.16, 0.24, 3)
        away = np.stack([x - place[0], y - place[1], z - place[2]], axis=-1) @ (axes / radii)
        cell = 1.0 / (1.0 + np.exp(9.0 * (np.linalg.norm(away, axis=-1) - 1.0)))
        hue = random.dirichlet((0.45, 0.45, 0.45))
        values = np.maximum(values, cell * (hue / hue.max())[:, None, None, None])
    path = work / "cells.tif"
    stack = np.rint(255 * values).astype(np.uint8).transpose(1, 0, 2, 3)
    tifffile.imwrite(path, stack, imagej=True, metadata={"axes": "ZCYX"})
    obj = blender.import_volume(
        path, channels=[i < 3 for i in range(channels.MOST)], as_rgb=True, smooth=0.7
    )
    obj.leaflight.texture_high = 150.0
    return obj


def regions(_, work):
    """Colin27's head within the labels of an atlas, in their colors."""
    obj = blender.import_volume(BRAINS / "ch2.nii.gz", smooth=0.7)
    labels = blender.import_volume(BRAINS / "aal.nii.gz", size_from="SAME", partner=obj.name)
    label_map = labels.leaflight.texture_volume
    labels.hide_render = True
    labels.hide_set(True)
    display.select(bpy.context, [obj], obj)
    bpy.ops.leaflight.mask_data(label_map=label_map.name)
    return color(obj, label_map, "LABELS")


def orbital(_, work):
    return blender.import_volume(work / "caffeine_homo.cube")


def tooth(data, _, **options):
    return blender.import_volume(
        data / "tooth16.raw",
        dims=(103, 94, 161),
        value_type="uint16",
        endian="big",
        smooth=1.0,
        **options,
    )


def tooth_by_gradient(data, work):
    obj = tooth(data, work)
    obj.leaflight.texture_kind = "GRADIENT"
    return obj


def head(_, work):
    obj = blender.import_volume(BRAINS / "ch2.nii.gz", smooth=1.2)
    blender.show(obj, 45.5)
    bpy.ops.leaflight.clean_data(kind="dust", voxels=1000)
    return obj


def brain(_, work):
    return blender.import_volume(BRAINS / "ch2bet.nii.gz", smooth=0.8)


def engine(data, _):
    return blender.import_volume(data / "engine.vti", smooth=0.7)


FIGURES = {
    "density_by_potential": Figure(
        density, 0.004, (0.003, 0.005), (0, 0, 20), 30, 1.0, has_bar=True
    ),
    "microscopy": Figure(cells, 100.0, (80.0, 120.0), (0, 0, 0), 12, 1.2),
    "brain_regions": Figure(regions, 60.0, (50.0, 75.0), (0, 0, 0), 5, 1.25),
    "orbital": Figure(orbital, 0.025, (0.02, 0.03), (0, 0, 0), 18, 1.0),
    "tooth_by_gradient": Figure(
        tooth_by_gradient, 700.0, (600.0, 800.0), (0, 0, 0), 8, 1.25, has_bar=True
    ),
    "head_cut": Figure(head, 60.0, (52.0, 68.0), (0, 0, 60), 14, 1.2, 112, is_cut=True),
    "first": Figure(
        brain, 70.0, (60.0, 80.0), (0, 0, -35), 14, 1.3, look="SKIN", size=(1920, 1080)
    ),
    "engine_cut": Figure(engine, 60.0, (45.0, 80.0), (0, 0, 0), 12, 1.1, 112, is_cut=True),
}

if __name__ == "__main__":
    main()
