# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks File > Export > Leaflight: the files contain what the viewport shows."""

import importlib.util
import json
import shutil
import sys
from dataclasses import asdict
from pathlib import Path

import bpy
import leaflight
import mathutils
import numpy as np
import pytest
from leaflight.export.export import SUFFIXES
from leaflight.stills.first_view import camera_around_bake
from leaflight.stills.photograph import metered_stops, tone_mapped
from leaflight_addon.compare.stills import rms_percent
from leaflight_addon.export import export_bake
from leaflight_addon.store import cache
from tools import (
    close,
    error_of,
    imported_gltf,
    mesh_arrays,
    render_exr,
    to_world,
    vertices_of,
)

# Side of the square pictures, in pixels.
SIDE = 256


def export(path, **options):
    is_page = Path(path).suffix == ".html"
    operator = bpy.ops.leaflight.export_page if is_page else bpy.ops.leaflight.export
    return operator(filepath=str(path), **options)


def check_gltf_comes_back_by_blenders_own_importer(baked, uncut, tmp_path, monkeypatch):
    baked.leaflight.isovalue = 47.0
    assert export(tmp_path / "box.glb") == {"FINISHED"}
    mesh, colors, corners = imported_gltf(tmp_path / "box.glb", monkeypatch)
    # In the file, y is up; the importer makes it z again.
    vertices, _, radiance = mesh_arrays(baked)
    close(to_world(mesh, vertices_of(mesh)), to_world(baked, vertices), 1e-5)
    # Blender keeps eight bits of sRGB in some versions.
    close(colors, np.clip(radiance, 0, 1)[corners], 0.01)


def check_a_range_is_a_sequence(baked, tmp_path):
    options = {"isovalues": "RANGE", "first": 40.0, "last": 60.0, "count": 3}
    export(tmp_path / "box.glb", **options)
    assert meshes_of(tmp_path / "box.glb") == [f"isovalue {c}" for c in (40, 50, 60)]
    export(tmp_path / "listed.glb", isovalues="LIST", listed="60, 45.5")
    assert meshes_of(tmp_path / "listed.glb") == ["isovalue 60", "isovalue 45.5"]
    # A .ply holds one isosurface, so a range is refused.
    pytest.importorskip("meshio", reason="meshio is not in this Blender")
    assert "one isosurface" in error_of(export, path=tmp_path / "box.ply", **options)
    listed = {"isovalues": "LIST", "listed": "45.5"}
    assert export(tmp_path / "box.ply", **listed) == {"FINISHED"}


def meshes_of(path):
    """Returns the names of the meshes of a .glb."""
    content = path.read_bytes()
    size = int.from_bytes(content[12:16], "little")
    return [mesh["name"] for mesh in json.loads(content[20 : 20 + size])["meshes"]]


def check_paraview_and_amira(baked, tmp_path):
    export(tmp_path / "box.am")
    assert b"define Lattice 24 24 24" in (tmp_path / "box.am").read_bytes()[:200]
    pytest.importorskip("vtkmodules", reason="VTK is not in this Blender")
    export(tmp_path / "box.vti")
    volume = leaflight.read_volume(tmp_path / "box.vti", dataset="radiance", channel=0)
    np.testing.assert_array_equal(volume.values, cache.grid_of(baked).dense("radiance")[..., 0])
    assert volume.values.max() > 0.1


def check_a_web_page_and_stills_of_the_same_view(baked, tmp_path):
    """Checks that the page, the core's still and Blender's picture of the first view are alike."""
    baked.leaflight.isovalue = 47.0
    page = tmp_path / "box.html"
    assert export(page) == {"FINISHED"}
    text = page.read_text()
    assert '"isovalue": 47.0' in text and 'id="leaflight-body"' in text
    assert export(tmp_path / "coarse.html", coarser=1) == {"FINISHED"}
    coarse = (tmp_path / "coarse.html").stat().st_size
    assert coarse < page.stat().st_size - 10_000
    # Without walls, fronts show only baked light, which follows its lamps.
    bake, camera = cache.bake_of(baked), bpy.context.scene.camera
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj not in (baked, camera) and obj.type != "LIGHT"
    view = camera_around_bake(bake, isovalue=47.0)
    right, up, forward = (mathutils.Vector(axis) for axis in view.axes())
    turn = mathutils.Matrix((right, up, -forward)).transposed().to_4x4()
    camera.matrix_world = mathutils.Matrix.Translation(view.position) @ turn
    camera.data.angle = np.radians(view.angle)
    render = render_exr(tmp_path / "box.exr", samples=1, size=SIDE)[..., :3]
    still = leaflight.still(bake, 47.0, view, (SIDE, SIDE), samples=1, walls=False)
    seen = (still[..., 3] == 1) & (render.max(axis=-1) > 0)
    assert seen.sum() > 1000
    exposure = bake.scene.exposure
    assert rms_percent(still[..., :3], render, exposure, seen) <= 3.0
    picture = in_a_browser(page, view)
    # The page compresses highlights, at the exposure that was metered for the bake.
    expected = tone_mapped(render * exposure * 2.0 ** metered_stops(bake))
    shown = linear(picture[..., :3])
    assert rms_percent(shown, expected, 1.0, seen & (picture[..., 3] == 255)) <= 3.0
    assert (picture[..., 3] == 255)[seen].mean() > 0.999


def in_a_browser(page, camera):
    """Returns the picture of a page from a Camera: uint8 [row, column, RGBA]."""
    tests = Path(__file__).resolve().parents[2]
    sys.path += [str(tests / "web"), str(tests / "python")]
    missing = [name for name in ("node", "chromium") if shutil.which(name) is None]
    if missing or importlib.util.find_spec("PIL") is None:
        pytest.skip("the page is not looked at: chromium, nodejs or Pillow is missing here")
    from browser import Browser

    browser = Browser()
    try:
        browser.open(page.as_uri(), {"width": SIDE, "height": SIDE})
        browser.evaluate(f"leaflight.view.orbit.viewpoint = {json.dumps(asdict(camera))}")
        return browser.picture()
    finally:
        browser.end()


def linear(colors):
    """Returns the linear values of uint8 sRGB colors."""
    encoded = colors / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def check_it_needs_a_bake(boxed, tmp_path):
    with pytest.raises(RuntimeError, match="Bake this volume first"):
        export(tmp_path / "box.glb")


def check_sentences(baked, tmp_path):
    assert "is unknown" in error_of(export, path=tmp_path / "box.stl")
    assert "range" in error_of(
        export, path=tmp_path / "x.glb", isovalues="RANGE", first=0.0, last=1e6
    )
    assert "not a list" in error_of(export, path=tmp_path / "x.glb", isovalues="LIST", listed="a")
    try:
        import pxr  # noqa: F401
    except ImportError:
        assert "usd-core, which" in error_of(export, path=tmp_path / "box.usdc")
    assert list(tmp_path.glob("box.*")) == []


def check_the_name_follows_the_format():
    class Operator:
        check = export_bake.LEAFLIGHT_OT_export.check

    operator = Operator()
    for file_type, path, expected in (
        (".vti", "/x/brain.glb", "/x/brain.vti"),
        (".vti", "/x/ch2.5", "/x/ch2.5.vti"),
        (".vti", "/x/brain.vti", "/x/brain.vti"),
    ):
        operator.file_type, operator.filepath = file_type, path
        operator.check(None)
        assert Path(operator.filepath) == Path(expected)
    # All offered formats must be supported.
    assert {item[0] for item in export_bake._FORMATS} <= set(SUFFIXES)


def check_a_blend_is_written_by_the_blenders_that_can_read_it(baked, tmp_path):
    formats = {item[0] for item in export_bake._FORMATS}
    assert (".blend" in formats) == (bpy.app.version >= (5, 0, 0))
    path = tmp_path / "box.blend"
    if ".blend" not in formats:
        assert "needs Blender 5.0 or later" in error_of(export, path=path)
        return
    assert export(path) == {"FINISHED"}
    with bpy.data.libraries.load(str(path)) as (inside, _):
        assert len(inside.volumes) == 1 and "Camera" in inside.objects


def check_it_is_cancelled(baked, tmp_path, monkeypatch):
    """Cancels it during the third of 200 isosurfaces."""
    surface, made = leaflight.Bake.surface, []

    def cancels(bake, isovalue, *options):
        made.append(isovalue)
        if len(made) == 3:
            progress.cancel()
        return surface(bake, isovalue, *options)

    monkeypatch.setattr(leaflight.Bake, "surface", cancels)
    values = np.linspace(31.0, 69.0, 200)
    job = export_bake.ExportJob(baked, tmp_path / "box.glb", values)
    progress = leaflight.Progress()
    with pytest.raises(leaflight.Cancelled):
        job.run(progress)
    assert len(made) == 3
    assert "cancelled" in job.ended() and list(tmp_path.glob("box.*")) == []
