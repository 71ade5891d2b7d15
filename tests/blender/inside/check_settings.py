# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that undo, redo, saving and both render engines keep each display setting of a volume."""

import bpy
import nibabel
import numpy as np
import pytest
from blends import reopened
from leaflight import blender
from mathutils import Vector
from tools import add_camera, add_light, close, render_exr

SIZE = 48
ENGINES = ("CYCLES", "EEVEE")


@pytest.fixture
def patient(tmp_path):
    """Returns a baked volume like a head: a wrinkled ball with a speck beside it, in bytes."""
    z, y, x = np.mgrid[:24, :22, :20].astype(np.float32)
    wrinkles = 0.4 * np.sin(2.5 * x) * np.sin(2.5 * y) * np.sin(2.5 * z)
    ball = 9.0 + wrinkles - np.sqrt((x - 9) ** 2 + (y - 10) ** 2 + (z - 12.5) ** 2)
    speck = 1.6 - np.sqrt((x - 16) ** 2 + (y - 3) ** 2 + (z - 3) ** 2)
    values = np.clip(20.0 * np.maximum(ball, speck) + 60.0, 0, 255).astype(np.uint8)
    image = nibabel.Nifti1Image(values.T, np.diag([10.0, 10.0, 10.0, 1.0]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, tmp_path / "head.nii")
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "head.nii"))
    obj = bpy.context.object
    settings = obj.leaflight
    settings.bake_folder = str(tmp_path / "bakes")
    settings.isovalue, settings.low, settings.high = 80.5, 40.5, 200.5
    settings.error, settings.resolution = 20.0, 24
    add_camera((0.0, -6.0, 1.0), (np.pi / 2, 0.0, 0.0), orthographic=3.0)
    add_light("SUN", rotation=(0.6, 0.4, 0.0), energy=2.0)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    return obj


def _slices(obj):
    obj.leaflight_look.slice_axes = (False, True, False)
    obj.leaflight_look.slice_places[1] = 0.1


def _cut(obj):
    bpy.ops.leaflight.add_clip_box()
    box = obj.leaflight_look.box
    box.location = obj.matrix_world @ Vector((10.0, 0.0, 20.0))
    bpy.context.view_layer.update()


def _cut_in_colors(obj):
    _cut(obj)
    obj.leaflight_look.cut_colors = "MAGMA"


def _color_bar(obj):
    obj.leaflight.texture_kind = "HEIGHT"
    bpy.ops.leaflight.add_color_bar()


def _look(key):
    return lambda _obj: bpy.ops.leaflight.isosurface_preset(preset=key)


SETTINGS = {
    "isovalue": lambda obj: setattr(obj.leaflight, "isovalue", 150.5),
    "up": lambda obj: setattr(obj.leaflight_orientation, "up", "NEG_X"),
    "front": lambda obj: setattr(obj.leaflight_orientation, "front", "POS_X"),
    "turn": lambda _obj: bpy.ops.leaflight.turn_volume(way="ROLL"),
    "smooth": lambda _obj: bpy.ops.leaflight.smooth(amount="2"),
    "smooth normals": lambda _obj: bpy.ops.leaflight.smooth(what="smooth_normals", amount="3"),
    "dust": lambda obj: setattr(obj.leaflight_look, "dust", 8.0),
    "gloss": lambda obj: setattr(obj.leaflight_look, "gloss", 1.0),
    "opacity": lambda obj: setattr(obj.leaflight_look, "opacity", 0.5),
    "clay": _look("CLAY"),
    "viridis": _look("VIRIDIS"),
    "another isosurface": lambda obj: blender.add_isosurface(obj, 50.5, 0.5, (0.9, 0.2, 0.1)),
    "slices": _slices,
    "cut": _cut,
    "cut in colors": _cut_in_colors,
    "scale bar": lambda _obj: bpy.ops.leaflight.add_scale_bar(),
    "letters": lambda _obj: bpy.ops.leaflight.add_letters(),
    "color bar": _color_bar,
    "cube": lambda _obj: bpy.ops.leaflight.add_orientation_cube(),
}


def _pictures(folder):
    """Returns one picture for each render engine."""
    pictures = {}
    for engine in ENGINES:
        pictures[engine] = render_exr(folder / "picture.exr", engine, samples=4, size=SIZE)[..., :3]
    return pictures


def _assert_alike(ours, theirs):
    for engine in ENGINES:
        close(ours[engine], theirs[engine], 1e-3)


@pytest.mark.parametrize("name", SETTINGS)
def check_a_setting_stays_through_undo_redo_and_files_in_both_engines(patient, tmp_path, name):
    before = _pictures(tmp_path)
    bpy.ops.ed.undo_push(message="before")
    SETTINGS[name](patient)
    bpy.ops.ed.undo_push(message=name)
    after = _pictures(tmp_path)
    for engine in ENGINES:
        assert np.abs(after[engine] - before[engine]).max() > 0.02, engine
    bpy.ops.ed.undo()
    _assert_alike(_pictures(tmp_path), before)
    bpy.ops.ed.redo()
    _assert_alike(_pictures(tmp_path), after)
    reopened(tmp_path / "scene.blend")
    _assert_alike(_pictures(tmp_path), after)
