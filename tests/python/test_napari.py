# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the plugin in napari itself, with a window of Qt."""

import os
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight.io.images import display_colors

MANIFEST = Path(leaflight.__file__).with_name("napari.yaml")


@pytest.fixture
def viewer():
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    napari = pytest.importorskip("napari", reason="napari of PyPI is not installed")
    npe2 = pytest.importorskip("npe2")
    manifest = npe2.PluginManifest.from_file(MANIFEST)
    manifest.validate_imports()
    manager = npe2.PluginManager.instance()
    manager.register(manifest)
    viewer = napari.Viewer(show=False)
    yield viewer
    viewer.close()
    manager.unregister("leaflight")


def test_a_bake_opens_and_its_isovalue_moves(viewer, tmp_path):
    bake = leaflight.bake(leaflight.bump_box(16), error=20, progress=False)
    bake.save(tmp_path / "box.vdb")
    # The file has the light in half precision.
    bake = leaflight.load_bake(tmp_path / "box.vdb")
    (layer,) = viewer.open(tmp_path / "box.vdb", plugin="leaflight")
    assert layer.name == "bump_box"
    _, widget = viewer.window.add_plugin_dock_widget("leaflight", "Isovalue")
    slider = widget[0]
    np.testing.assert_allclose((slider.min, slider.max), bake.isovalues, rtol=1e-6)
    for isovalue in (47.0, 90.0):
        slider.value = isovalue
        surface = bake.surface(slider.value)
        np.testing.assert_array_equal(layer.data[0], surface.vertices[:, ::-1])
        colors = display_colors(surface.radiance, bake.scene.exposure) / 255
        np.testing.assert_allclose(layer.vertex_colors[:, :3], colors, atol=1e-6)


def test_other_files_are_left_to_others(tmp_path):
    pytest.importorskip("magicgui", reason="napari of PyPI is not installed")
    from leaflight.export.napari_plugin import reader_of

    (tmp_path / "cloud.vdb").write_bytes(b"no grids")
    assert reader_of(str(tmp_path / "cloud.vdb")) is None
    assert reader_of(str(tmp_path / "head.nii.gz")) is None and reader_of(["a.vdb"]) is None
