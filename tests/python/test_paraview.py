# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the state of ParaView beside a .vti in ParaView itself, on the screen that Xvfb makes."""

import ast
import shutil
import subprocess
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.io.images import display_colors
from leaflight.stills.first_view import camera_around_bake, default_isovalue_of
from PIL import Image
from waiting import HANG

pytest.importorskip("vtkmodules", reason="VTK (python3-vtk9) is not installed")
SIZE = (200, 200)
# Draws the state at its own isovalue and at another one.
DRAW = """
import runpy, sys
state, first, second, isovalue = sys.argv[1:]
made = runpy.run_path(state)
view = made["view"]
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [0.0, 0.0, 1.0]
from paraview.simple import SaveScreenshot
SaveScreenshot(first, view, ImageResolution=[%d, %d])
made["isosurface"].Isosurfaces = [float(isovalue)]
SaveScreenshot(second, view, ImageResolution=[%d, %d])
""" % (*SIZE, *SIZE)


def test_the_state_names_its_file_and_an_isovalue(box_bake, tmp_path):
    leaflight.export(box_bake, tmp_path / "a 'box'.vti")
    text = (tmp_path / "a 'box'_paraview.py").read_text()
    constants = {n.value for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Constant)}
    assert {"a 'box'.vti", str(tmp_path), default_isovalue_of(box_bake)} <= constants


@pytest.mark.slow
def test_paraview_shows_the_lit_isosurface(tmp_path):
    if not (shutil.which("pvbatch") and shutil.which("xvfb-run")):
        pytest.skip("ParaView is not installed; Debian's takes the place of python3-vtk9")
    volume = leaflight.bump_box(40)
    bake = leaflight.bake(volume, leaflight.cornell_box(), error=5.0, progress=False)
    leaflight.export(bake, tmp_path / "box.vti")
    (tmp_path / "draw.py").write_text(DRAW)
    isovalues = (default_isovalue_of(bake), 120.0)
    pictures = [tmp_path / "first.png", tmp_path / "second.png"]
    # Without -noreset, the screen restarts when ParaView has looked for OpenGL.
    screen = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 640x480x24 -noreset"]
    command = [*screen, "pvbatch", tmp_path / "draw.py", tmp_path / "box_paraview.py", *pictures]
    command = [str(word) for word in (*command, isovalues[1])]
    subprocess.run(command, check=True, timeout=HANG)
    camera = camera_around_bake(bake, isovalue=isovalues[0])
    alone = replace(bake, scene=replace(bake.scene, meshes=[]))
    for isovalue, path in zip(isovalues, pictures):
        seen = np.asarray(Image.open(path).convert("RGB")).astype(float)
        still = leaflight.still(alone, isovalue, camera, SIZE, samples=1)
        expected = display_colors(still[..., :3], bake.scene.exposure)
        drawn, filled = (seen != (0, 0, 255)).any(axis=-1), still[..., 3] == 1
        assert (drawn != filled).mean() < 0.01 and filled.mean() > 0.1
        off = (seen - expected)[drawn & filled] / 255
        assert np.sqrt((off**2).mean()) < 0.03
