# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks leaflight.blender, the functions of docs/scripting.md."""

import inspect

import bpy
import leaflight
import numpy as np
import pytest
from leaflight import blender
from tools import assert_shows


@pytest.fixture
def volume(tmp_path):
    path = tmp_path / "bumps.raw"
    leaflight._core.bump_box(24).astype("<f4").tofile(path)
    obj = blender.import_volume(path, dims=(24, 24, 24), value_type="float32")
    obj.leaflight.bake_folder = str(tmp_path / "bakes")
    obj.leaflight.error, obj.leaflight.resolution = 20.0, 24
    return obj


def check_from_a_file_to_a_mesh(volume, tmp_path):
    blender.stage(volume)
    assert bpy.context.scene.camera is not None
    path = blender.bake(volume, (40, 60))
    assert path.is_file() and leaflight.load_bake(path).isovalues == (40.0, 60.0)
    blender.show(volume, 47.0)
    assert_shows(volume, 47.0)
    for shown, isovalue in ((volume, float("nan")), (None, 47.0)):
        with pytest.raises(leaflight.LeaflightError, match="finite isovalue"):
            blender.show(shown, isovalue)
    blender.export(volume, tmp_path / "box.glb")
    blender.export(volume, tmp_path / "seq.glb", [45, 50])
    blender.export(volume, tmp_path / "box.am")
    sizes = [(tmp_path / name).stat().st_size for name in ("box.glb", "seq.glb", "box.am")]
    assert sizes[1] > 1.5 * sizes[0] > 1000 and sizes[2] > 4 * 24**3


def check_a_sweep(volume):
    blender.stage(volume)
    blender.bake(volume, (40, 60))
    blender.animate(volume, np.linspace(41, 59, 4), first_frame=10)
    scene = bpy.context.scene
    assert (scene.frame_start, scene.frame_end) == (10, 13)
    for frame, isovalue in ((10, 41.0), (12, 53.0), (13, 59.0)):
        scene.frame_set(frame)
        assert volume.leaflight.isovalue == pytest.approx(isovalue, abs=1e-4)
        assert_shows(volume, volume.leaflight.isovalue)


def check_a_comparison_returns_its_figures(volume, tmp_path):
    blender.stage(volume)
    blender.bake(volume)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 64
    found = blender.compare(volume, tmp_path / "images", samples=32, baked_samples=4, share=0.5)
    assert (
        0 < found["isosurface_rms_percent"] < 20 and found["isovalue"] == volume.leaflight.isovalue
    )
    # Only the volume's own isosurface is compared.
    blender.add_isosurface(volume, volume.leaflight.isovalue - 20.0, opacity=1.0)
    again = blender.compare(volume, tmp_path / "images", samples=16, baked_samples=4, share=0.5)
    assert again["samples"] == 16 and again["isosurface_pixels"] == found["isosurface_pixels"] > 0
    assert len(volume.children) == 1 and not volume.children[0].hide_render
    picture = bpy.data.images.load(str(next((tmp_path / "images").glob("*_baked.png"))))
    assert tuple(picture.size) == (32, 32)


def check_errors_are_sentences(volume, tmp_path):
    for call, words in (
        (lambda: blender.import_volume(tmp_path / "no.nii"), "no such file"),
        (lambda: blender.export(volume, tmp_path / "x.glb"), "Bake this volume first"),
        (lambda: blender.bake(volume, eror=1.0), 'no bake setting "eror"'),
        (lambda: blender.bake(None), "not a Leaflight volume"),
        (lambda: blender.compare(volume, tmp_path), "Bake this volume first"),
        (lambda: blender.animate(volume, []), "isovalues"),
        (lambda: blender.animate_frames(volume), "only one frame"),
        (lambda: blender.bake_frames(volume), "only one frame"),
        (lambda: blender.bake_frames(None), "not a Leaflight volume"),
    ):
        with pytest.raises(leaflight.LeaflightError, match=words):
            call()


def check_every_function_is_documented():
    public = [f for name, f in vars(blender).items() if inspect.isfunction(f) and name[0] != "_"]
    assert {f.__name__ for f in public} == {
        *("import_volume", "stage", "bake", "show", "animate", "compare", "export"),
        *("add_isosurface", "clip", "animate_frames", "bake_frames"),
    }
    assert all(f.__doc__ for f in public)
