# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the values of volumes that color isosurfaces, in files for other programs."""

import leaflight
import meshio
import numpy as np
import pytest
import vtk_files
from leaflight import Volume, texture_of
from leaflight.export.gltf import LACKING
from leaflight.export.point_grid import point_grid
from leaflight.io.scene_file import cornell_box
from leaflight.scene.volume_texture import VolumeTexture, identifiers, named_values

NODES = 12
WHITE = [(0.0, (1.0, 1.0, 1.0))]
ISOVALUE = 47.0


def along_x(name, nodes=NODES, scale=1.0):
    """Returns a Volume whose values are scale * x over the left three quarters of the box."""
    values = np.broadcast_to(np.linspace(0.0, 0.75, nodes, dtype=np.float32), (nodes,) * 3)
    matrix = np.diag([0.75 / (nodes - 1), 1 / (nodes - 1), 1 / (nodes - 1), 1.0])
    return Volume(np.ascontiguousarray(scale * values), matrix, name)


TEXTURES = {
    "one": lambda: texture_of(along_x("Electric potential")),
    "three": lambda: texture_of([along_x(name, scale=s) for name, s in zip("ABC", (1, 2, 3))]),
}


@pytest.fixture(scope="module", params=TEXTURES)
def bake(request):
    scene = cornell_box().colored_by(TEXTURES[request.param]())
    return leaflight.bake(leaflight.bump_box(NODES), scene, isovalues=(30, 70), error=5.0)


def expected(bake):
    """Returns {name: values} of the isosurface by their formula, and a mask without values."""
    x = bake.surface(ISOVALUE).vertices[:, 0]
    absent = x > 0.75 * (1 + 0.5 / (NODES - 1))
    x = np.where(absent, np.nan, np.minimum(x, 0.75))
    assert 0.05 < absent.mean() < 0.5
    if len(bake.scene.isosurfaces[0].texture.channels) == 1:
        return {"Electric_potential": x}
    return {"A": x, "B": 2 * x, "C": 3 * x}


def check(found, bake, names=lambda name: name, absent=np.nan):
    """Checks arrays by the names that a format gives them."""
    for name, values in expected(bake).items():
        values = np.where(np.isnan(values), absent, values)
        np.testing.assert_allclose(np.ravel(found[names(name)]), values, atol=1e-6)


def test_gltf(bake, tmp_path):
    trimesh = pytest.importorskip("trimesh", reason="trimesh of PyPI is not installed")
    leaflight.export(bake, tmp_path / "box.glb", [ISOVALUE])
    (mesh,) = trimesh.load(tmp_path / "box.glb", process=False).geometry.values()
    check(mesh.vertex_attributes, bake, lambda name: f"_{name.upper()}", LACKING)
    colors = mesh.visual.vertex_attributes["color"][:, :3]
    radiance = bake.radiance(mesh.vertices)
    np.testing.assert_allclose(colors, np.clip(radiance * bake.scene.exposure, 0, 1), atol=1e-4)


def test_usd(bake, tmp_path):
    pytest.importorskip("pxr", reason="usd-core of PyPI is not installed")
    from pxr import Usd, UsdGeom

    leaflight.export(bake, tmp_path / "box.usdc", [ISOVALUE, 50.0])
    stage = Usd.Stage.Open(str(tmp_path / "box.usdc"))
    primvars = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/Leaflight/isosurface"))
    found = {name: primvars.GetPrimvar(name).Get(1) for name in expected(bake)}
    check(found, bake)
    (name, *_) = expected(bake)
    count = len(bake.surface(50.0).vertices)
    assert len(primvars.GetPrimvar(name).Get(2)) == count
    assert primvars.GetPrimvar(name).GetInterpolation() == "vertex"


def test_ply_and_vtp(bake, tmp_path):
    leaflight.export(bake, tmp_path / "box.ply", [ISOVALUE])
    check(meshio.read(tmp_path / "box.ply").point_data, bake)
    vtk_files.vtk()
    leaflight.export(bake, tmp_path / "box.vtp", [ISOVALUE])
    mesh = vtk_files.read("XMLPolyData", tmp_path / "box.vtp")
    check(vtk_files.numbers_of(mesh.GetPointData()), bake)


def test_vti(bake, tmp_path):
    vtk_files.vtk()
    leaflight.export(bake, tmp_path / "box.vti")
    (name, *_) = expected(bake)
    volume = leaflight.read_volume(tmp_path / "box.vti", dataset=name)
    x = np.linspace(0.0, 1.0, volume.values.shape[2])
    found = volume.values[3, 5]
    assert np.isnan(found[-1]) and not np.isnan(found[0])
    has_values = ~np.isnan(found)
    np.testing.assert_allclose(found[has_values], np.minimum(x, 0.75)[has_values], atol=1e-6)


def test_light_at_the_points_of_a_grid_has_their_color(bake):
    grid = point_grid(bake)
    index = np.argwhere((grid.values > 31.0) & (grid.values < 69.0))[::97]
    points = (np.c_[index[:, ::-1], np.ones(len(index))] @ grid.index_to_world.T)[:, :3]
    found, expected = grid.radiance[tuple(index.T)], bake.radiance(points)
    assert len(index) > 50 and np.ptp(expected, axis=0).max() > 0.1
    np.testing.assert_allclose(found, expected, atol=0.03 * expected.max())


def test_without_a_texture_files_have_no_other_values(box_bake, tmp_path):
    leaflight.export(box_bake, tmp_path / "box.ply", [ISOVALUE])
    colors, radiance = ("red", "green", "blue"), ("radiance_r", "radiance_g", "radiance_b")
    names = {"nx", "ny", "nz", *colors, *radiance}
    assert set(meshio.read(tmp_path / "box.ply").point_data) == names


@pytest.mark.parametrize("nearest", [False, True])
def test_values_are_those_of_the_core(nearest):
    """Checks points inside, at the border, outside and next to NaN, by colors equal to values."""
    rng = np.random.default_rng(4)
    values = rng.random((4, 5, 6)).astype(np.float32)
    values[2, 2, 2] = np.nan
    matrix = np.diag([0.3, -0.2, 0.5, 1.0])
    matrix[:3, :3] += 0.05
    matrix[:3, 3] = (1.0, 2.0, 3.0)
    gray = [(0.0, (0.0, 0.0, 0.0)), (1.0, (1.0, 1.0, 1.0))]
    texture = VolumeTexture((Volume(values, matrix, "v"),), gray, nearest)
    index = rng.uniform(-0.8, 5.8, (3000, 3))
    points = index @ matrix[:3, :3].T + matrix[:3, 3]
    found, colors = named_values(texture, points)["v"], texture.at(points)[:, 0]
    assert np.isnan(found).any() and not np.isnan(found).all()
    np.testing.assert_allclose(np.nan_to_num(found, nan=1.0), colors, atol=1e-6)


def test_labels_keep_their_numbers():
    labels = np.zeros((4, 4, 4), np.uint16)
    labels[..., 2:] = 1007
    texture = VolumeTexture((Volume(labels, name="labels"),), WHITE, nearest=True)
    points = np.array([[1.4, 0, 0], [1.6, 0, 0], [4.0, 0, 0]])
    np.testing.assert_array_equal(named_values(texture, points)["labels"], [0, 1007, np.nan])


def test_names_are_different_identifiers():
    names = ("Größe", "3rd", "脳", "Radiance", "a b", "A-B", "radiance 2")
    values = {name: np.full(1, float(i)) for i, name in enumerate(names)}
    found = identifiers(values, ["radiance"])
    expected = ["Gr_e", "value_3rd", "value", "Radiance_2", "a_b", "A_B_2", "radiance_2_2"]
    assert list(found) == expected and [each[0] for each in found.values()] == list(range(7))
    twice = texture_of([along_x("t")] * 3)
    assert list(named_values(twice, np.zeros((1, 3)))) == ["t", "t_2", "t_3"]
