# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files: what they hold, how they fit a volume, and what is wrong with a bad one."""

import copy
import json

import numpy as np
import pytest

import leaflight
from leaflight import LeaflightError, Volume, fit_scene, load_scene
from leaflight.scene import core_scene, scene_from_json, scene_to_json


@pytest.fixture(params=["cornell.json", "bump_box.json"])
def shipped(request, root):
    return load_scene(root / "scenes" / request.param)


def brick(scale=1.0, offset=(0.0, 0.0, 0.0)):
    """A volume of 4 x 6 x 11 nodes whose x axis is mirrored."""
    matrix = np.diag([-scale, scale, scale, 1.0])
    matrix[:3, 3] = offset
    values = np.random.default_rng(5).random((11, 6, 4), dtype=np.float32)
    return Volume(values, matrix, "brick")


def corners(description):
    return np.concatenate([mesh.vertices for mesh in description.meshes])


def test_default_scene_is_the_shipped_cornell_box(root):
    shipped = load_scene(root / "scenes" / "cornell.json")
    assert scene_to_json(leaflight.cornell_box()) == scene_to_json(shipped)


def test_cornell_box_is_open_towards_the_viewer():
    box = leaflight.cornell_box()
    albedo = {mesh.name: mesh.albedo for mesh in box.meshes}
    assert set(albedo) == {"floor", "ceiling", "back wall", "left wall", "right wall"}
    assert albedo["left wall"][0] > 3 * max(albedo["left wall"][1:])
    assert albedo["right wall"][1] > 2 * albedo["right wall"][0]
    front = corners(box)[:, 1].min()
    assert not any((mesh.vertices[:, 1] == front).all() for mesh in box.meshes)
    (light,) = box.lights
    normal = np.cross(light.edge_u, light.edge_v)
    assert normal[2] < 0 and normal[0] == normal[1] == 0


def test_bump_box_scene_shines_along_y(bump_scene):
    (light,) = bump_scene.lights
    normal = np.cross(light.edge_u, light.edge_v)
    assert normal[1] > 0 and normal[0] == normal[2] == 0
    points = corners(bump_scene)
    assert (points.min(axis=0) < 0).all() and (points.max(axis=0) > 1).all()


def test_json_round_trip(shipped):
    text = scene_to_json(shipped)
    assert scene_to_json(scene_from_json(text)) == text


@pytest.mark.parametrize("scale, offset", [(1, (0, 0, 0)), (1e-3, (5, -7, 3)), (1e4, (0, 9, 0))])
def test_box_coordinates_fit_any_volume(scale, offset):
    volume = brick(scale, offset)
    fitted = fit_scene(leaflight.cornell_box(), volume)
    bounds = np.asarray(volume.field().bounds)
    points = corners(fitted)
    assert fitted.coordinates == "world"
    assert (points.min(axis=0) < bounds[0]).all() and (points.max(axis=0) > bounds[1]).all()
    # One scale for all axes, from the longest side (z, 10 steps).
    box = corners(leaflight.cornell_box())
    np.testing.assert_allclose(np.ptp(points, axis=0), 5 * scale * np.ptp(box, axis=0), rtol=1e-4)
    light = fitted.lights[0]
    below, above = light.corner[2] - bounds[1][2], points[:, 2].max() - light.corner[2]
    assert below > 0 and above > 0


def test_world_coordinates_stay(bump_scene):
    assert fit_scene(bump_scene, brick()) is bump_scene


def test_shipped_scenes_are_accepted_by_the_core(shipped):
    volume = leaflight.bump_box(8)
    core_scene(fit_scene(shipped, volume), volume.field(), (20.0, 90.0))


GOOD = {
    "name": "room",
    "coordinates": "world",
    "leaf_albedo": [0.5, 0.5, 0.5],
    "exposure": 1,
    "meshes": [
        {
            "name": "floor",
            "albedo": [1, 0.5, 0],
            "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            "faces": [[0, 1, 2, 3]],
        }
    ],
    "lights": [
        {
            "name": "lamp",
            "corner": [0, 0, 1],
            "edge_u": [1, 0, 0],
            "edge_v": [0, -1, 0],
            "radiance": [1, 2, 3],
        }
    ],
}

BAD = [
    (["leaf_albedo"], [0.5, 1.5, 0.5], "leaf_albedo.*between 0 and 1"),
    (["leaf_albedo"], [float("nan"), 0.5, 0.5], "leaf_albedo.*finite"),
    (["leaf_albedo"], 0.5, "leaf_albedo.*three numbers"),
    (["exposure"], 0, "exposure.*positive"),
    (["exposure"], "bright", "exposure"),
    (["exposure"], 10**400, "exposure"),
    (["coordinates"], "moon", "coordinates"),
    (["name"], None, "name.*text"),
    (["meshes"], {}, "meshes.*list"),
    (["meshes", 0], "floor", "mesh 1.*object"),
    (["meshes", 0, "albedo"], [0, -0.1, 0], 'mesh "floor".*albedo'),
    (["meshes", 0, "vertices"], [[0, 0], [1, 0], [1, 1]], 'mesh "floor".*vertices'),
    (["meshes", 0, "vertices"], [[0, 0, 0], [1, 0]], 'mesh "floor".*vertices'),
    (["meshes", 0, "vertices", 0, 0], float("inf"), 'mesh "floor".*vertices.*finite'),
    (["meshes", 0, "faces"], [[0, 1, 4]], 'mesh "floor".*faces.*0..3'),
    (["meshes", 0, "faces"], [[0, 1]], 'mesh "floor".*faces'),
    (["meshes", 0, "faces"], [[0, 1, 1.5]], 'mesh "floor".*faces'),
    (["lights", 0, "radiance"], [-1, 0, 0], 'light "lamp".*radiance.*not negative'),
    (["lights", 0, "edge_v"], [2, 0, 0], 'light "lamp".*parallel'),
    (["lights", 0, "edge_v"], [0, 0, 0], 'light "lamp".*zero'),
    (["lights", 0, "edge_v"], [1, 1, 0], 'light "lamp".*right angles'),
    (["lights", 0, "corner"], "here", 'light "lamp".*corner'),
    (["lights", 0, "power"], 60, 'light "lamp".*unknown key "power"'),
]


@pytest.mark.parametrize("place, value, sentence", BAD)
def test_bad_scene_names_the_object(place, value, sentence):
    data = copy.deepcopy(GOOD)
    target = data
    for key in place[:-1]:
        target = target[key]
    target[place[-1]] = value
    with pytest.raises(LeaflightError, match=sentence) as caught:
        scene_from_json(json.dumps(data), "room.json")
    message = str(caught.value)
    assert message.startswith("room.json: ") and message.endswith(".") and "\n" not in message


@pytest.mark.parametrize("key", sorted(GOOD))
def test_missing_key(key):
    data = {name: value for name, value in GOOD.items() if name != key}
    with pytest.raises(LeaflightError, match=f'room.json: the key "{key}" is missing'):
        scene_from_json(json.dumps(data), "room.json")


@pytest.mark.parametrize("text", ["", "{", "[]", "[" * 100_000])
def test_text_that_is_no_scene(text):
    with pytest.raises(LeaflightError, match="room.json"):
        scene_from_json(text, "room.json")


def test_missing_scene_file(tmp_path):
    with pytest.raises(LeaflightError, match="cannot read the scene file"):
        load_scene(tmp_path / "nowhere.json")
