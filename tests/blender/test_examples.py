# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the scripts of examples/ on small volumes."""

from pathlib import Path

import leaflight
import numpy as np
import pytest
from PIL import Image

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    """Writes two scans and an unreadable file."""
    nibabel = pytest.importorskip("nibabel")
    folder = tmp_path_factory.mktemp("scans")
    for name, n in (("left", 20), ("right", 24)):
        values = leaflight.bump_box(n).values.transpose()
        nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), folder / f"{name}.nii.gz")
    (folder / "notes.txt").write_text("not a volume")
    return folder


def test_a_sweep_becomes_a_video(blender, scans, tmp_path):
    out = tmp_path / "sweep.mp4"
    arguments = ["--isovalues", 30, 100, "--frames", 6, "--error", 5, "--size", 96, 64]
    output = blender.run(
        *("--python", EXAMPLES / "sweep_to_video.py", "--", scans / "left.nii.gz"),
        *("--out", out, "--samples", 4, *arguments),
    )
    assert f"Wrote {out}" in output and "Baked into" in output
    frames = tmp_path / "frames"
    frames.mkdir()
    # Let Blender read the result.
    read = f"""
import bpy
scene = bpy.context.scene
scene.sequence_editor_create()
strips = getattr(scene.sequence_editor, "strips", None) or scene.sequence_editor.sequences
strip = strips.new_movie("sweep", {str(out)!r}, 1, 1)
print("DURATION", strip.frame_final_duration)
scene.frame_start, scene.frame_end = 1, 6
scene.render.resolution_x, scene.render.resolution_y = 96, 64
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "PNG"
scene.render.filepath = {str(frames / "f")!r}
bpy.ops.render.render(animation=True)
"""
    assert "DURATION 6" in blender.run("--python-expr", read)
    pictures = [np.asarray(Image.open(path).convert("RGB"), float) for path in frames.iterdir()]
    assert len(pictures) == 6 and all(picture.shape == (64, 96, 3) for picture in pictures)
    assert all(20 < picture.mean() < 230 for picture in pictures)
    assert len({picture.tobytes() for picture in pictures}) == 6


def test_a_folder_of_scans_becomes_stills(blender, scans, tmp_path):
    out = tmp_path / "stills"
    script = (
        "import sys, runpy\n"
        f"sys.argv = ['blender', '--', {str(scans)!r}, '--out', {str(out)!r}, "
        "'--size', '64', '--samples', '4', '--error', '5']\n"
        "try:\n"
        f"    runpy.run_path({str(EXAMPLES / 'folder_to_stills.py')!r}, run_name='__main__')\n"
        "except SystemExit as end:\n"
        "    print('STATUS', end.code)\n"
    )
    output = blender.run("--python-expr", script)
    assert "STATUS 1" in output and "Left out:" in output and "notes.txt" in output
    assert sorted(path.name for path in out.iterdir()) == ["left.png", "right.png"]
    for path in out.iterdir():
        picture = np.asarray(Image.open(path).convert("RGB"), float)
        assert picture.shape == (64, 64, 3) and 20 < picture.mean() < 230 and picture.std() > 10
