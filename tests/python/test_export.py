# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests files for other programs, each read back by another library."""

import json
import re
import struct
import sys
from dataclasses import replace

import leaflight
import meshio
import numpy as np
import pytest
import vtk_files
from leaflight import Surface
from leaflight.export.blend import _walls
from leaflight.export.point_grid import point_grid
from leaflight.export.ply import display_colors, write_ply
from outcomes import refused

ISOVALUES = (40.0, 47.0, 60.0)


@pytest.fixture(scope="module")
def finer(bump_scene):
    """Returns a bake with texels half as wide as voxels, and with backs."""
    settings = {"isovalues": (30, 70), "resolution": 23, "error": 5.0, "both_sides": True}
    return leaflight.bake(leaflight.bump_box(12), bump_scene, **settings)


@pytest.fixture(scope="module")
def surface(box_bake):
    return box_bake.surface(47.0)


def srgb(linear):
    """Returns the sRGB values of 8-bit images."""
    linear = np.clip(linear, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return 255 * encoded


def read_vti(path):
    image = vtk_files.read("XMLImageData", path)
    return image, vtk_files.numbers_of(image.GetPointData())


def test_vti_holds_values_and_radiance(box_bake, tmp_path):
    vtk_files.vtk()
    assert leaflight.export(box_bake, tmp_path / "box.vti") == {}
    image, arrays = read_vti(tmp_path / "box.vti")
    assert image.GetDimensions() == (20, 20, 20)
    np.testing.assert_array_equal(arrays["value"], box_bake.volume.values.ravel())
    grid = box_bake.grid
    np.testing.assert_array_equal(arrays["radiance"], grid.dense("radiance").reshape(-1, 3))
    np.testing.assert_array_equal(arrays["radiance_error"], grid.dense("radiance_error").ravel())
    exposed = srgb(arrays["radiance"] * box_bake.scene.exposure)
    assert arrays["color"].dtype == np.uint8 and arrays["color"].max() > 100
    assert np.abs(arrays["color"] - exposed).max() < 0.51
    # Points must be at the world positions of the voxels.
    for number in (0, 21, 7999):
        index = (number % 20, number // 20 % 20, number // 400, 1)
        place = box_bake.volume.index_to_world @ index
        np.testing.assert_allclose(image.GetPoint(number), place[:3], atol=1e-6)
    assert image.GetFieldData().GetAbstractArray("bake_id").GetValue(0) == box_bake.id


def test_vti_contoured_and_probed_by_vtk_shows_the_lit_isosurface(finer, tmp_path):
    """Checks what a user of ParaView does: a contour of the value, colored by the radiance."""
    vtk = vtk_files.vtk()
    map_coordinates = pytest.importorskip("scipy.ndimage").map_coordinates

    leaflight.export(finer, tmp_path / "finer.vti")
    image, arrays = read_vti(tmp_path / "finer.vti")
    assert image.GetDimensions() == (23, 23, 23) and "radiance_back" in arrays
    contour = vtk.vtkContourFilter()
    contour.SetInputData(image)
    contour.SetInputArrayToProcess(0, 0, 0, 0, "value")
    contour.SetValue(0, 47.0)
    contour.Update()
    mesh = contour.GetOutput()
    points = vtk_files.numpy_of(mesh.GetPoints().GetData())
    found = vtk_files.numbers_of(mesh.GetPointData())["radiance"]
    # Compare the radiance of the texels. The box is 22 texel spacings wide.
    radiance = finer.grid.dense("radiance")
    places = 22 * points.T[::-1]
    expected = np.stack([map_coordinates(radiance[..., k], places, order=1) for k in range(3)], -1)
    assert len(points) > 300 and expected.mean() > 0.01
    np.testing.assert_allclose(found, expected, atol=2e-3 * expected.max())


def test_a_sheared_volume_is_refused_as_vti_and_placed_by_amira(box_bake, tmp_path):
    vtk_files.vtk()
    matrix = box_bake.volume.index_to_world.copy()
    matrix[0, 1] = 0.01
    sheared = replace(box_bake, volumes=[replace(box_bake.volume, index_to_world=matrix)])
    refused("is sheared", leaflight.export, sheared, tmp_path / "box.vti")
    leaflight.export(sheared, tmp_path / "box.am")
    text = (tmp_path / "box.am").read_bytes()[:600].decode("latin1")
    numbers = re.search(r"TransformationMatrix (.+),", text)[1].split()
    np.testing.assert_allclose(np.array(numbers, float).reshape(4, 4).T, matrix, rtol=1e-6)


def test_amira_holds_four_bytes_a_texel(finer, tmp_path):
    """Checks the layout of the format: AmiraMesh's header, then the bytes, x fastest."""
    leaflight.export(finer, tmp_path / "finer.am")
    head, _, data = (tmp_path / "finer.am").read_bytes().partition(b"\n@1\n")
    lines = head.decode("ascii").splitlines()
    assert lines[0] == "# AmiraMesh BINARY-LITTLE-ENDIAN 2.1"
    assert lines[1] == "define Lattice 23 23 23" and "Lattice { byte[4] Data } @1" in lines
    pixels = np.frombuffer(data[:-1], np.uint8).reshape(23, 23, 23, 4)
    assert (pixels[..., 3] == 255).all()
    exposed = srgb(finer.grid.dense("radiance") * finer.scene.exposure)
    assert exposed.max() > 100 and np.abs(pixels[..., :3] - exposed).max() < 0.51
    box = re.search(r"BoundingBox (.+),", head.decode())[1].split()
    np.testing.assert_allclose(np.array(box, float), [0, 1, 0, 1, 0, 1], atol=1e-6)


def test_where_texels_are_wider_the_points_are_voxels(bump_scene):
    settings = {"isovalues": (30, 70), "resolution": 10, "error": 5.0}
    bake = leaflight.bake(leaflight.bump_box(20), bump_scene, **settings)
    grid = point_grid(bake)
    assert grid.radiance.shape == (20, 20, 20, 3)
    np.testing.assert_array_equal(grid.values, bake.volume.values)
    index = np.array([7, 5, 9])
    point = bake.volume.index_to_world @ [*index, 1]
    expected = bake.radiance(point[None, :3])[0]
    np.testing.assert_allclose(grid.radiance[9, 5, 7], expected, rtol=1e-5)


def test_between_voxels_values_are_those_of_the_field(finer):
    grid = point_grid(finer)
    index = np.random.default_rng(3).integers(1, 22, (50, 3))
    points = (np.c_[index, np.ones(50)] @ grid.index_to_world.T)[:, :3]
    expected = finer.volume.field().sample(points)
    np.testing.assert_allclose(grid.values[tuple(index.T[::-1])], expected, atol=1e-4)


def test_vtp(box_bake, surface, tmp_path):
    vtk_files.vtk()
    written = leaflight.export(box_bake, tmp_path / "box.vtp", [47.0])[47.0]
    mesh = vtk_files.read("XMLPolyData", tmp_path / "box.vtp")
    data = vtk_files.numbers_of(mesh.GetPointData())
    points = vtk_files.numpy_of(mesh.GetPoints().GetData())
    np.testing.assert_array_equal(points, written.vertices)
    triangles = vtk_files.numpy_of(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    np.testing.assert_array_equal(triangles, written.triangles)
    np.testing.assert_array_equal(data["radiance"], written.radiance)
    normals = vtk_files.numpy_of(mesh.GetPointData().GetNormals())
    np.testing.assert_array_equal(normals, written.normals)
    assert mesh.GetFieldData().GetArray("isovalue").GetValue(0) == 47.0
    np.testing.assert_array_equal(written.vertices, surface.vertices)


def test_ply(box_bake, surface, tmp_path):
    leaflight.export(box_bake, tmp_path / "box.ply", [47.0])
    mesh = meshio.read(tmp_path / "box.ply")
    np.testing.assert_array_equal(mesh.points, surface.vertices)


def test_glb(box_bake, surface, tmp_path):
    trimesh = pytest.importorskip("trimesh", reason="trimesh of PyPI is not installed")
    leaflight.export(box_bake, tmp_path / "box.glb", [47.0])
    scene = trimesh.load(tmp_path / "box.glb", process=False)
    (mesh,) = scene.geometry.values()
    np.testing.assert_array_equal(mesh.vertices, surface.vertices)
    np.testing.assert_array_equal(mesh.faces, surface.triangles)
    np.testing.assert_allclose(mesh.vertex_normals, surface.normals, atol=1e-5)
    np.testing.assert_array_equal(mesh.vertex_attributes["_RADIANCE"], surface.radiance)
    # The world's z axis becomes the y axis, which is up in glTF.
    v = surface.vertices
    turned = np.stack([v[:, 0], v[:, 2], -v[:, 1]], axis=1)
    np.testing.assert_allclose(scene.bounds, [turned.min(axis=0), turned.max(axis=0)], atol=1e-5)
    # Trimesh stores colors of a mesh with a material as an attribute.
    linear = np.clip(surface.radiance * box_bake.scene.exposure, 0, 1)
    colors = mesh.visual.vertex_attributes["color"]
    assert linear.max() > 0.2
    np.testing.assert_allclose(colors, np.c_[linear, np.ones(len(linear))], atol=1e-6)


def gltf_of(path):
    """Returns (JSON, a function that reads an accessor by its number) of a .glb."""
    content = path.read_bytes()
    magic, version, length, size, kind = struct.unpack("<4sIII4s", content[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    assert length % 4 == size % 4 == 0
    document, body = json.loads(content[20 : 20 + size]), content[28 + size :]
    assert document["buffers"] == [{"byteLength": len(body)}]

    def array(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        part = body[view["byteOffset"] :][: view["byteLength"]]
        rows = np.frombuffer(part, kind).reshape(accessor["count"], -1)
        if "min" in accessor:
            np.testing.assert_array_equal(rows.min(axis=0), np.float32(accessor["min"]))
        return rows

    return document, array


def test_glb_colors_are_linear_and_unlit(box_bake, surface, tmp_path):
    leaflight.export(box_bake, tmp_path / "box.glb", [47.0])
    file, array = gltf_of(tmp_path / "box.glb")
    (primitive,) = file["meshes"][0]["primitives"]
    colors = array(primitive["attributes"]["COLOR_0"])
    linear = np.clip(surface.radiance * box_bake.scene.exposure, 0, 1)
    assert linear.max() > 0.2
    np.testing.assert_allclose(colors[:, :3], linear, atol=1e-6)
    assert (colors[:, 3] == 1).all()
    np.testing.assert_array_equal(array(primitive["attributes"]["POSITION"]), surface.vertices)
    np.testing.assert_array_equal(array(primitive["indices"])[:, 0], surface.triangles.ravel())
    material = file["materials"][primitive["material"]]
    assert "KHR_materials_unlit" in material["extensions"]
    assert file["extensionsUsed"] == ["KHR_materials_unlit"] and "animations" not in file


def test_a_sequence_as_glb_shows_one_isovalue_at_a_time(box_bake, tmp_path):
    leaflight.export(box_bake, tmp_path / "box.glb", ISOVALUES)
    file, array = gltf_of(tmp_path / "box.glb")
    (animation,) = file["animations"]
    assert [mesh["name"] for mesh in file["meshes"]] == [f"isovalue {c:g}" for c in ISOVALUES]

    def shown(time):
        nodes = []
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times, scales = array(sampler["input"])[:, 0], array(sampler["output"])
            assert channel["target"]["path"] == "scale" and sampler["interpolation"] == "STEP"
            key = max(np.searchsorted(times, time, side="right") - 1, 0)
            if scales[key].all():
                nodes.append(file["nodes"][channel["target"]["node"]]["name"])
        return nodes

    for frame, isovalue in enumerate(ISOVALUES):
        assert shown(0.1 * frame + 0.05) == [f"isovalue {isovalue:g}"]
    # Without the animation, the first isosurface is visible.
    shown_first = [node["name"] for node in file["nodes"][1:] if "scale" not in node]
    assert shown_first == ["isovalue 40"]


@pytest.mark.parametrize("suffix", ["usda", "usdc", "usd"])
def test_usd(box_bake, surface, tmp_path, suffix):
    pytest.importorskip("pxr", reason="usd-core of PyPI is not installed")
    from pxr import Usd, UsdGeom, UsdShade

    path = tmp_path / f"box.{suffix}"
    leaflight.export(box_bake, path, [47.0])
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Leaflight/isosurface"))
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    np.testing.assert_array_equal(np.array(mesh.GetPointsAttr().Get()), surface.vertices)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    np.testing.assert_array_equal(corners, surface.triangles)
    colors = np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor").Get())
    np.testing.assert_allclose(colors, surface.radiance * box_bake.scene.exposure, rtol=1e-6)
    material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
    assert material.GetSurfaceOutput().HasConnectedSource()
    assert list(tmp_path.iterdir()) == [path]


def test_a_sequence_as_usd_has_a_time_sample_each(box_bake, tmp_path):
    pytest.importorskip("pxr", reason="usd-core of PyPI is not installed")
    from pxr import Usd, UsdGeom

    surfaces = leaflight.export(box_bake, tmp_path / "box.usdc", ISOVALUES)
    stage = Usd.Stage.Open(str(tmp_path / "box.usdc"))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Leaflight/isosurface"))
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (1, 3)
    for frame, (isovalue, surface) in enumerate(surfaces.items(), start=1):
        assert mesh.GetPrim().GetAttribute("isovalue").Get(frame) == isovalue
        np.testing.assert_array_equal(np.array(mesh.GetPointsAttr().Get(frame)), surface.vertices)


def test_sentences(box_bake, tmp_path):
    for name, isovalues, words in (
        ("x.obj", None, ".vti, .am, .blend, .vtp, .ply, .glb, .usda"),
        ("x.ply", (40.0, 47.0), "holds one isosurface"),
        ("x.am", (40.0,), "all isosurfaces"),
        ("x.ply", (400.0,), "outside the baked range"),
        ("nowhere/x.ply", (47.0,), "cannot write"),
    ):
        refused(re.escape(words), leaflight.export, box_bake, tmp_path / name, isovalues)
    assert list(tmp_path.iterdir()) == []


def test_an_absent_library_is_named_before_any_work(box_bake, tmp_path, monkeypatch):
    for suffix, module, word in (
        (".vtp", "vtkmodules", "python3-vtk9"),
        (".usdc", "pxr", "pip install usd-core"),
        (".ply", "meshio", "python3-meshio"),
    ):
        for name in [name for name in sys.modules if name.partition(".")[0] == module]:
            monkeypatch.delitem(sys.modules, name)
        for own in ("vtk_files", "usd"):
            monkeypatch.delitem(sys.modules, f"leaflight.export.{own}", raising=False)
        monkeypatch.setitem(sys.modules, module, None)
        monkeypatch.setattr(leaflight.Bake, "surface", lambda *_: pytest.fail("worked in vain"))
        path = tmp_path / f"x{suffix}"
        said = refused(re.escape(word), leaflight.export, box_bake, path, [47.0])
        assert said.count(".") < 8 and "\n" not in said


def test_the_command(cli, box_file, tmp_path):
    out = tmp_path / "box.ply"
    printed = cli.runs("export", box_file, "--isovalue", 47, "--out", out, "--json")
    assert '"isovalue": 47.0' in printed and len(meshio.read(out).points) > 100
    two = ("--isovalue", 40, 47, "--out", tmp_path / "two.ply")
    cli.refuses("(--isovalue)", "export", box_file, *two)
    assert list(tmp_path.iterdir()) == [out]


@pytest.fixture
def tetrahedron():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    radiance = np.array([[0, 0, 0], [0.25, 0.5, 1], [1, 2, 4], [9, 0, 1e-6]], dtype=np.float32)
    return Surface(vertices, normals, triangles, radiance, 0.1)


def test_round_trip(tmp_path, tetrahedron):
    path = tmp_path / "mesh.ply"
    write_ply(path, tetrahedron, exposure=0.5)
    mesh = meshio.read(path)
    np.testing.assert_array_equal(mesh.points, tetrahedron.vertices)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], tetrahedron.triangles)
    data = mesh.point_data
    radiance = np.stack([data[f"radiance_{c}"] for c in "rgb"], axis=1)
    np.testing.assert_array_equal(radiance, tetrahedron.radiance)
    assert radiance.dtype == np.float32
    colors = np.stack([data[c] for c in ("red", "green", "blue")], axis=1)
    assert colors.dtype == np.uint8
    np.testing.assert_array_equal(colors, display_colors(tetrahedron.radiance, 0.5))
    np.testing.assert_array_equal(data["nz"], tetrahedron.normals[:, 2])
    assert list(tmp_path.iterdir()) == [path]


def test_display_colors():
    # 0.5 is sRGB 188, 0.001 on the linear part is 12.92 * 0.255 = 3.
    radiance = np.array([[0, 0.25, 0.5], [7.0, 0.0005, -1]])
    np.testing.assert_array_equal(display_colors(radiance, 2.0), [[0, 188, 255], [255, 3, 0]])


def test_errors_leave_nothing(tmp_path, tetrahedron):
    for path in (tmp_path / "mesh.obj", tmp_path / "nowhere" / "mesh.ply", tmp_path):
        refused(".", write_ply, path, tetrahedron, exposure=1)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_mirrors_among_walls_have_no_baked_light_in_blend(bump_scene):
    first, *others = bump_scene.meshes
    scene = replace(bump_scene, meshes=[replace(first, scattering="mirror"), *others])
    bake = leaflight.bake(leaflight.bump_box(12), scene, error=20.0, resolution=8, walls=True)
    objects, light = _walls(bake)
    assert sorted(light) == [f"light{number}" for number in range(1, len(objects))]
