# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests an exported .blend in a Blender without the add-on: its isovalue moves by a driver."""

import leaflight
import numpy as np
import pytest
from driver import Blender
from leaflight.export.blend import grids_of
from outcomes import refused

ISOVALUES = (40.0, 60.0, 90.0, 120.0, 150.0)

# Drives the isovalue by the frame. Stores each isosurface and wall with its light.
MOVE = """
import bpy, numpy as np, sys, time
blend, results, *isovalues = sys.argv[sys.argv.index("--") + 1:]
isovalues = list(map(float, isovalues))
bpy.ops.wm.open_mainfile(filepath=blend)
assert not hasattr(bpy.types.Object, "leaflight"), "the add-on is enabled"
scene, shown = bpy.context.scene, bpy.context.object
modifier = shown.modifiers["Leaflight"]
(slider,) = (
    item for item in modifier.node_group.interface.items_tree if item.name == "Isovalue"
)
found = {"range": (slider.min_value, slider.max_value), "seconds": []}
rest = f'["{slider.identifier}"]'
if hasattr(modifier, "properties"):
    rest = f".properties.inputs.{slider.identifier}.value"
shown["isovalue"] = 0.0
for frame, isovalue in enumerate(isovalues, 1):
    shown["isovalue"] = isovalue
    shown.keyframe_insert('["isovalue"]', frame=frame)
driver = shown.driver_add(f'modifiers["Leaflight"]{rest}').driver
driver.type = "AVERAGE"
target = driver.variables.new().targets[0]
target.id, target.data_path = shown, '["isovalue"]'

def arrays(name, obj):
    geometry = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()
    mesh = geometry.mesh
    for key, values, path in (
        ("vertices", mesh.vertices, "co"),
        ("radiance", mesh.attributes["radiance"].data, "vector"),
        ("normals", mesh.vertex_normals, "vector"),
    ):
        found[f"{name} {key}"] = np.empty((len(values), 3), np.float32)
        values.foreach_get(path, found[f"{name} {key}"].ravel())

for frame, isovalue in enumerate(isovalues, 1):
    start = time.perf_counter()
    scene.frame_set(frame)
    bpy.context.evaluated_depsgraph_get()
    found["seconds"].append(time.perf_counter() - start)
    arrays(f"{isovalue:g}", shown)
    for wall in scene.objects:
        if wall.type == "MESH" and wall.modifiers:
            arrays(f"{isovalue:g} {wall.name}", wall)
found["lights"] = [obj.name for obj in scene.objects if obj.type == "LIGHT"]
found["camera"] = np.array(scene.camera.matrix_world)
np.savez(results, **found)
"""


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """Returns a Blender without the add-on."""
    return Blender(tmp_path_factory.mktemp("bare"))


@pytest.fixture(scope="module")
def bake():
    return leaflight.bake(
        leaflight.bump_box(48), isovalues=(20.0, 180.0), error=10.0, walls=True, resolution=48
    )


def moved(bare, bake, folder, isovalues=ISOVALUES):
    """Exports a bake; returns the arrays of its moved .blend."""
    assert leaflight.export(bake, folder / "box.blend") == {}
    script = folder / "move.py"
    script.write_text(MOVE)
    bare.run("--python", script, "--", folder / "box.blend", folder / "found.npz", *isovalues)
    return np.load(folder / "found.npz")


def rms(differences):
    return float(np.sqrt(np.mean(np.square(differences))))


def nearest(points, among):
    """Returns the number of the nearest of some points for each of others."""
    return np.array([np.argmin(np.sum((among - point) ** 2, axis=1)) for point in points])


def test_isovalue_moves_without_the_addon(bare, bake, tmp_path):
    if bare.about["version"] < [5, 0]:
        pytest.skip("this Blender has no volume grids in Geometry Nodes")
    found = moved(bare, bake, tmp_path)
    np.testing.assert_allclose(found["range"], bake.isovalues)
    assert list(found["lights"]) == [light.name for light in bake.scene.lights]
    exposure, voxel = bake.scene.exposure, bake.volume.index_to_world[0, 0]
    for isovalue in ISOVALUES:
        surface, name = bake.surface(isovalue), f"{isovalue:g}"
        vertices, normals = found[f"{name} vertices"], found[f"{name} normals"]
        at = nearest(vertices, surface.vertices)
        distances = np.linalg.norm(vertices - surface.vertices[at], axis=1)
        assert len(vertices) > 500 and np.quantile(distances, 0.99) < voxel
        # Fronts face lower values, as ours do.
        assert np.mean(np.sum(normals * surface.normals[at], axis=1) > 0.0) > 0.97
        shown = np.clip(found[f"{name} radiance"] * exposure, 0, 1)
        expected = np.clip(surface.radiance[at] * exposure, 0, 1)
        assert expected.std() > 0.05 and rms(shown - expected) < 0.025
        # Light of another isovalue is wrong here.
        for number, mesh in enumerate(bake.scene.meshes):
            light = found[f"{name} {mesh.name} radiance"] * exposure
            baked = bake.walls.radiance(number, isovalue) * exposure
            assert rms(light - baked) < 0.004
    dark, bright = (bake.walls.radiance(0, isovalue) for isovalue in (ISOVALUES[0], ISOVALUES[-1]))
    assert rms(dark - bright) * exposure > 0.02


def test_grids_beside_it_are_the_bake(bare, bake, tmp_path):
    if bare.about["version"] < [5, 0]:
        pytest.skip("this Blender has no volume grids in Geometry Nodes")
    leaflight.export(bake, tmp_path / "box.blend")
    assert leaflight.load_bake(grids_of(tmp_path / "box.blend")).id == bake.id
    relit = bake.relit({bake.scene.lights[0].name: 0.25})
    refused("changed lamps", leaflight.export, relit, tmp_path / "relit.blend")
    assert len(list(tmp_path.iterdir())) == 2


def test_older_blenders_are_refused(bare, bake, tmp_path):
    if bare.about["version"] >= [5, 0]:
        pytest.skip("this Blender has volume grids in Geometry Nodes")
    refused(
        "writing .blend needs Blender 5.0 or later",
        leaflight.export,
        bake,
        tmp_path / "box.blend",
    )
    assert list(tmp_path.iterdir()) == []


def test_its_slider_is_dragged_in_a_window(bare, bake, tmp_path):
    if bare.about["version"] < [5, 0]:
        pytest.skip("this Blender has no volume grids in Geometry Nodes")
    if bare.no_window():
        pytest.skip(bare.no_window())
    leaflight.export(bake, tmp_path / "box.blend")
    seen = bare.in_window("drag_blend.py", tmp_path / "box.blend")["steps"]
    isovalues, vertices = np.transpose(seen)
    assert len(set(isovalues)) > 5 and len(set(vertices)) > 5
    # The mouse crosses part of a slider that shows the whole range.
    assert 0.05 < np.ptp(isovalues) / np.ptp(bake.isovalues) < 0.5
