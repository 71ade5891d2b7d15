# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests `leaflight render`: frames of a .blend, rendered by workers without a window."""

import os
import subprocess
import sys

import leaflight
import numpy as np
import pytest
from PIL import Image

pytest.importorskip("distributed")

pytestmark = pytest.mark.slow

MAKE = """
import bpy, sys
from leaflight import blender
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
box = blender.import_volume(sys.argv[-2])
blender.stage(box)
blender.bake(box, (30, 110), error=8.0)
blender.animate(box, [40, 55, 70, 85, 100])
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising = 4, False
scene.render.resolution_x, scene.render.resolution_y = 96, 64
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""


@pytest.fixture(scope="module")
def animated(blender, tmp_path_factory):
    if blender.about["module"]:
        pytest.skip("This Blender is a Python module, which starts without the preferences.")
    folder = tmp_path_factory.mktemp("animated")
    nibabel = pytest.importorskip("nibabel")
    values = leaflight.bump_box(16).values.transpose()
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), folder / "box.nii")
    blend = folder / "box.blend"
    blender.run("--python-expr", MAKE, "--", folder / "box.nii", blend)
    return blend


def render(blender, *arguments):
    package = os.path.dirname(os.path.dirname(leaflight.__file__))
    return subprocess.run(
        [sys.executable, "-m", "leaflight_command", "render", *map(str, arguments)],
        env={**blender.environment, "PYTHONPATH": package},
        capture_output=True,
        text=True,
        timeout=blender.hang,
    )


def test_frames_and_a_video(blender, animated, tmp_path):
    video, folder = tmp_path / "box.mp4", tmp_path / "box_frames"
    done = render(blender, animated, "--out", video, "--workers", 2)
    assert done.returncode == 0, done.stderr
    names = [f"{number:04}.png" for number in range(1, 6)]
    assert sorted(os.listdir(folder)) == names
    pictures = [np.asarray(Image.open(folder / name).convert("RGB")) for name in names]
    assert all(picture.shape == (64, 96, 3) and picture.mean() > 20 for picture in pictures)
    assert len({picture.tobytes() for picture in pictures}) == 5
    assert b"ftyp" in video.read_bytes()[:16]
    # A second run renders only missing frames, with the same result.
    (folder / names[2]).unlink()
    done = render(blender, animated, "--out", folder, "--frames", 2, 4)
    assert done.returncode == 0 and "3 frames, 2 of them" in done.stdout
    np.testing.assert_array_equal(
        np.asarray(Image.open(folder / names[2]).convert("RGB")), pictures[2]
    )
    # After a change of the .blend, all frames are rendered again.
    os.utime(animated)
    done = render(blender, animated, "--out", folder, "--frames", 1, 1)
    assert "1 frames, 0 of them" in done.stdout


def test_sentences(blender, animated, tmp_path):
    broken = tmp_path / "broken.blend"
    broken.write_bytes(b"no blend")
    for arguments, sentence in (
        ((tmp_path / "none.blend", "--out", tmp_path), "no such file"),
        ((animated, "--out", tmp_path, "--blender", "/no/blender"), "cannot be started"),
        ((animated, "--out", tmp_path, "--frames", 5, 2), "is empty"),
        ((animated, "--out", broken), "cannot make this folder"),
    ):
        done = render(blender, *arguments)
        assert done.returncode == 2 and sentence in done.stderr
        assert len(done.stderr.splitlines()) == 1
    assert render(blender, broken, "--out", tmp_path).returncode == 2
