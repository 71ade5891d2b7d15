# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests scene files: their contents, and the errors of bad ones."""

import base64
import copy
import json
import math
import zlib
from dataclasses import fields, is_dataclass

import leaflight
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from leaflight import _core, load_scene
from leaflight.io.scene_file import scene_from_json, scene_to_json
from leaflight.scene.lights import AreaLight, Cone, PointLight, SunLight
from leaflight.scene.scene import Environment, Isosurfaces, Mesh, SceneDescription
from outcomes import refused, written
from PIL import Image

PIXELS = base64.b64encode(zlib.compress(bytes(24))).decode()
FLOOR = {"name": "floor", "albedo": [1, 0.5, 0], "faces": [[0, 1, 2, 3]]}
FLOOR["vertices"] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
WALL = {"name": "wall", "albedo": [1, 1, 1], "scattering": "glass", "ior": 1.3}
WALL |= {"vertices": [[0, 0, 0], [1, 0, 0], [0, 0, 1]], "faces": [[0, 1, 2]], "emission": [0, 0, 1]}
WALL |= {"texture": {"width": 2, "height": 1, "pixels": PIXELS}, "uv": [[[0, 0], [1, 0], [0, 1]]]}
LAMP = {"name": "lamp", "corner": [0, 0, 1], "edge_u": [1, 0, 0], "edge_v": [0, -1, 0]}
LAMP |= {"radiance": [1, 2, 3], "ellipse": True}
BULB = {"name": "bulb", "type": "point", "position": [0, 0, 1], "intensity": [1, 1, 1]}
SPOT = {**BULB, "name": "spot", "type": "spot", "radius": 0.1, "axis": [0, 0, -3]}
SPOT |= {"angle": 60, "blend": 0.2, "cosine_falloff": True}
SUN = {"name": "sun", "type": "sun", "direction": [3, 0, -4], "irradiance": [1, 1, 1], "angle": 0.5}
GOOD = {
    "name": "room",
    "coordinates": "world",
    "isosurface_albedo": [0.5, 0.5, 0.5],
    "exposure": 1,
    "meshes": [FLOOR, WALL],
    "lights": [LAMP, BULB, SPOT, SUN],
    "environment": {"radiance": [0.1, 0.2, 0.3], "rotation": 90},
}
BLACK, WHITE = [0, 0, 0], [1, 1, 1]

BAD = [
    (["isosurface_albedo"], [0.5, 1.5, 0.5], "isosurface_albedo.*between 0 and 1"),
    (["isosurface_albedo"], [float("nan"), 0.5, 0.5], "isosurface_albedo.*finite"),
    (["isosurface_albedo"], 0.5, "isosurface_albedo.*three numbers"),
    (["isosurface_albedo"], [], "isosurface_albedo.*three numbers"),
    (["isosurface_albedo"], [[1, BLACK], [1, WHITE]], "isosurface_albedo.*ascend"),
    (["isosurface_albedo"], [[1, BLACK], [2, [1, 1, 7]]], "stop 2 of.*_albedo.*between 0 and 1"),
    (["isosurface_albedo"], [[1, BLACK], ["high", WHITE]], "stop 2 of.*_albedo.*isovalue"),
    (["isosurface_albedo"], [[1, BLACK], 2], "isosurface_albedo.*list of"),
    (["isosurface_emission"], [-1, 0, 0], "isosurface_emission.*not negative"),
    (["isosurface_scattering"], "velvet", "isosurface_scattering.*glass.*velvet"),
    (["isosurface_ior"], 0, "isosurface_ior.*0.1..10"),
    (["capped"], 1, "capped.*true or false"),
    (["volumes"], [], "is unknown"),
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
    (["meshes", 0, "vertices", 0, 0], float("nan"), 'mesh "floor".*vertices.*finite'),
    (["meshes", 0, "faces"], [], 'mesh "floor".*faces.*empty'),
    (["meshes", 0, "faces"], [[0, 1, 4]], 'mesh "floor".*faces.*0..3'),
    (["meshes", 0, "faces"], [[0, 1]], 'mesh "floor".*faces'),
    (["meshes", 0, "faces"], [[0, 1, 1.5]], 'mesh "floor".*faces'),
    (["meshes", 0, "scattering"], "velvet", 'mesh "floor".*scattering.*velvet'),
    (["meshes", 0, "ior"], -1, 'mesh "floor".*ior'),
    (["meshes", 0, "emission"], [0, 0, -1], 'mesh "floor".*emission.*not negative'),
    (["meshes", 0, "uv"], [[[0, 0]] * 4], 'mesh "floor".*"uv" also needs "texture"'),
    (["meshes", 0, "texture"], "wood.png", 'mesh "floor".*"texture" also needs "uv"'),
    (["meshes", 1, "uv"], [[[0, 0]] * 4], 'mesh "wall".*uv.*each of its corners'),
    (["meshes", 1, "uv"], [], 'mesh "wall".*uv.*each face'),
    (["meshes", 1, "uv"], [[[0, 0, 0]] * 3], 'mesh "wall".*uv.*two numbers'),
    (["meshes", 1, "uv"], [[[0, 0], [0, "x"], [0, 0]]], 'mesh "wall".*uv.*numbers'),
    (["meshes", 1, "texture"], "nowhere.png", 'mesh "wall".*nowhere.png: there is no such'),
    (["meshes", 1, "texture"], "wood.gif", 'mesh "wall".*wood.gif.*choose one of'),
    (["meshes", 1, "texture"], 7, 'mesh "wall": texture.*object'),
    (["meshes", 1, "texture", "width"], 3, 'mesh "wall": texture.*does not hold 9'),
    (["meshes", 1, "texture", "width"], 10**9, 'mesh "wall": texture.*width'),
    (["meshes", 1, "texture", "pixels"], "nonsense", 'mesh "wall": texture.*pixels'),
    (["lights", 0, "radiance"], [-1, 0, 0], 'light "lamp".*radiance.*not negative'),
    (["lights", 0, "edge_v"], [2, 0, 0], 'light "lamp".*parallel'),
    (["lights", 0, "edge_v"], [0, 0, 0], 'light "lamp".*zero'),
    (["lights", 0, "edge_v"], [1, 1, 0], 'light "lamp".*right angles'),
    (["lights", 0, "corner"], "here", 'light "lamp".*corner'),
    (["lights", 0, "power"], 60, 'light "lamp".*key "power" is unknown'),
    (["lights", 0, "type"], "laser", 'light "lamp".*type.*laser'),
    (["lights", 0, "ellipse"], "yes", 'light "lamp".*ellipse'),
    (["lights", 1, "intensity"], [0, -1, 0], 'light "bulb".*intensity.*not negative'),
    (["lights", 1, "radius"], -1, 'light "bulb".*radius'),
    (["lights", 1, "axis"], [0, 0, 1], 'light "bulb".*key "axis" is unknown'),
    (["lights", 2, "axis"], [0, 0, 0], 'light "spot".*axis.*zero'),
    (["lights", 2, "angle"], 0, 'light "spot".*angle.*above 0'),
    (["lights", 2, "angle"], 181, 'light "spot".*angle.*0..180'),
    (["lights", 2, "blend"], 1.1, 'light "spot".*blend'),
    (["lights", 3, "angle"], 180, 'light "sun".*angle.*below 180'),
    (["lights", 3, "irradiance"], [0, 0], 'light "sun".*irradiance'),
    (["environment", "radiance"], [0, 0, -1], "environment.*radiance"),
    (["environment", "image"], "nowhere.exr", "environment.*nowhere.exr"),
    (["environment", "rotation"], "left", "environment.*rotation"),
    (["environment", "world_to_image"], [[1, 0, 0]] * 3, "environment.*world_to_image"),
    (["environment", "strength"], 1, "environment.*is unknown"),
]
BAD_VOLUMES = [
    ([], "at least one volume"),
    ([{"name": "a"}], 'volume "a".*albedo.*missing'),
    ([{"name": "a", "albedo": [1, 1, 2]}], 'volume "a".*albedo'),
    ([{"name": "a", "albedo": [1, 1, 1], "isovalues": [3, 3]}], 'volume "a".*isovalues'),
    ([{"name": "a", "albedo": [1, 1, 1], "source": 3}], 'volume "a".*source'),
    ([{"name": "a", "albedo": [1, 1, 1], "side": "in"}], 'volume "a".*key "side" is unknown'),
]


@pytest.fixture
def good():
    return copy.deepcopy(GOOD)


@pytest.mark.parametrize("place, value, sentence", BAD)
def test_bad_scene_names_the_object(good, place, value, sentence):
    target = good
    for key in place[:-1]:
        target = target[key]
    target[place[-1]] = value
    assert_refused(good, sentence)


@pytest.mark.parametrize("volumes, sentence", BAD_VOLUMES)
def test_bad_volume_is_named(good, volumes, sentence):
    del good["isosurface_albedo"]
    assert_refused(good | {"volumes": volumes}, sentence)


def assert_refused(data, sentence):
    message = refused(sentence, scene_from_json, json.dumps(data), "room.json")
    assert message.startswith("room.json: ") and message.endswith(".") and "\n" not in message


@pytest.mark.parametrize(
    "key", ["coordinates", "exposure", "isosurface_albedo", "lights", "meshes", "name"]
)
def test_missing_key(good, key):
    del good[key]
    assert_refused(good, f'the key "{key}" is missing')


@pytest.mark.parametrize("text", ["", "{", "[]", "[" * 100_000])
def test_text_that_is_no_scene(text):
    refused("room.json", scene_from_json, text, "room.json")


def test_missing_scene_file(tmp_path):
    refused("cannot read", load_scene, tmp_path / "nowhere.json")


def test_what_a_scene_holds(good):
    scene = scene_from_json(json.dumps(good))
    (isosurfaces,) = scene.isosurfaces
    assert isosurfaces.albedo == (0.5, 0.5, 0.5) and isosurfaces.scattering == "diffuse"
    floor, wall = scene.meshes
    np.testing.assert_array_equal(floor.triangles, [[0, 1, 2], [0, 2, 3]])
    assert floor.texture is None and floor.uv is None
    assert wall.texture.shape == (1, 2, 3) and wall.uv.shape == (1, 3, 2)
    assert wall.scattering == "glass" and wall.ior == 1.3
    lamp, bulb, spot, sun = scene.lights
    assert isinstance(lamp, AreaLight) and lamp.ellipse
    assert isinstance(bulb, PointLight) and bulb.radius == 0 and bulb.cone is None
    assert spot.cone.axis == (0, 0, -1) and spot.cone.angle == pytest.approx(math.pi / 3)
    assert isinstance(sun, SunLight) and sun.direction == pytest.approx((0.6, 0, -0.8))
    assert sun.angle == pytest.approx(math.radians(0.5))
    # The image is rotated by 90 degrees: its colors along -y are now seen along +x.
    to_image = np.array(scene.environment.world_to_image)
    np.testing.assert_allclose(to_image @ [1, 0, 0], [0, -1, 0], atol=1e-15)


def test_volumes_of_a_scene(good, tmp_path):
    del good["isosurface_albedo"]
    stops = [[10, [0, 0, 0]], [20, [1, 1, 1]]]
    good["volumes"] = [
        {"name": "bone", "albedo": stops, "source": "head.nii", "isovalues": [1, 2]},
        {"name": "skin", "albedo": [1, 0, 0], "source": "lapr:1", "capped": True},
    ]
    path = written(tmp_path / "scene.json", json.dumps(good))
    bone, skin = load_scene(path).isosurfaces
    assert bone.albedo == [(10, (0, 0, 0)), (20, (1, 1, 1))] and bone.isovalues == (1, 2)
    assert bone.source == str(tmp_path / "head.nii") and not bone.capped
    assert skin.source == "lapr:1" and skin.capped and skin.isovalues is None


def test_images_are_relative_to_the_file(good, tmp_path):
    pixels = np.zeros((2, 3, 3), dtype=np.uint8)
    pixels[0] = 255
    pixels[1, 0] = (188, 0, 0)
    Image.fromarray(pixels).save(tmp_path / "wood.png")
    sky = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    _core.write_exr(str(tmp_path / "sky.exr"), sky)
    good["meshes"][1]["texture"] = "wood.png"
    good["environment"]["image"] = "sky.exr"
    path = written(tmp_path / "scene.json", json.dumps(good))
    scene = load_scene(path)
    texture = scene.meshes[1].texture
    # The texture is linear, with the bottom row first.
    assert texture.dtype == np.float32 and (texture[1] == 1).all()
    np.testing.assert_allclose(texture[0, 0], [0.503, 0, 0], atol=1e-3)
    np.testing.assert_array_equal(scene.environment.image, sky[::-1])


NAMES = st.text(max_size=8)
SIZES = st.floats(0, 1e6, allow_subnormal=False)
SHARES = st.floats(0, 1, allow_subnormal=False)
PLACES = st.tuples(*[st.floats(-1e6, 1e6)] * 3)
LIGHT = st.tuples(SIZES, SIZES, SIZES)
ALBEDO = st.tuples(SHARES, SHARES, SHARES)
SCATTERING = st.sampled_from(["diffuse", "mirror", "glass"])
IOR = st.floats(0.1, 10)
UNIT = PLACES.map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)
UNIT = UNIT.map(lambda v: tuple((v / np.linalg.norm(v)).tolist()))
ANGLE = st.floats(1e-6, 3.14)
RNG = np.random.default_rng(3)


def ramps(colors):
    stops = st.lists(st.tuples(st.floats(-1e9, 1e9), colors), min_size=1, max_size=4)
    ascending = stops.map(lambda all: sorted({x: color for x, color in all}.items()))
    return colors | ascending


@st.composite
def images(draw):
    shape = (draw(st.integers(1, 5)), draw(st.integers(1, 5)), 3)
    return RNG.random(shape, dtype=np.float32)


@st.composite
def meshes(draw):
    count = draw(st.integers(1, 6))
    textured = draw(st.booleans())
    return Mesh(
        draw(NAMES),
        RNG.normal(size=(5, 3)).astype(np.float32),
        RNG.integers(0, 5, (count, 3)).astype(np.uint32),
        draw(ALBEDO),
        draw(SCATTERING),
        draw(IOR),
        draw(LIGHT),
        draw(images()) if textured else None,
        RNG.random((count, 3, 2)).astype(np.float32) if textured else None,
    )


@st.composite
def area_lights(draw):
    u, v = np.linalg.qr(RNG.normal(size=(3, 3)))[0][:2]
    edges = tuple(u.tolist()), tuple((3 * v).tolist())
    return AreaLight(draw(NAMES), draw(PLACES), *edges, draw(LIGHT), draw(st.booleans()))


RANGES = st.tuples(SIZES, SIZES).filter(lambda pair: pair[0] < pair[1])
ISOSURFACES = st.builds(
    Isosurfaces,
    *(NAMES, ramps(ALBEDO), ramps(LIGHT), SCATTERING, IOR, st.none() | RANGES, st.booleans()),
    st.none() | st.sampled_from(["lapr:0", "head.nii"]),
)
CONES = st.builds(Cone, UNIT, ANGLE, SHARES, st.booleans())
LIGHTS = (
    area_lights()
    | st.builds(PointLight, NAMES, PLACES, SIZES, LIGHT, st.none() | CONES)
    | st.builds(SunLight, NAMES, UNIT, LIGHT, ANGLE)
)
MATRICES = st.floats(-3, 3).map(
    lambda a: ((math.cos(a), math.sin(a), 0.0), (-math.sin(a), math.cos(a), 0.0), (0.0, 0.0, 1.0))
)
SCENES = st.builds(
    SceneDescription,
    NAMES,
    st.lists(ISOSURFACES, min_size=1, max_size=3),
    st.floats(1e-3, 1e3),
    st.lists(meshes(), max_size=2),
    st.lists(LIGHTS, max_size=3),
    st.none() | st.builds(Environment, NAMES, LIGHT, st.none() | images(), MATRICES),
    st.sampled_from(["world", "box"]),
)


@given(SCENES)
def test_round_trip(scene):
    text = scene_to_json(scene)
    again = scene_from_json(text)
    assert_same(again, scene)
    assert scene_to_json(again) == text


def assert_same(value, expected):
    assert type(value) is type(expected) or isinstance(value, (list, tuple))
    if is_dataclass(expected):
        for field in fields(expected):
            if field.name == "angle":
                # The file has degrees.
                assert value.angle == pytest.approx(expected.angle, rel=1e-13)
            else:
                assert_same(getattr(value, field.name), getattr(expected, field.name))
    elif isinstance(expected, np.ndarray):
        assert value.dtype == expected.dtype
        np.testing.assert_array_equal(value, expected)
    elif isinstance(expected, (list, tuple)):
        assert len(value) == len(expected)
        for item, expected_item in zip(value, expected):
            assert_same(item, expected_item)
    else:
        assert value == expected


def test_shipped_scenes_round_trip(shipped):
    text = scene_to_json(shipped)
    assert scene_to_json(scene_from_json(text)) == text


def test_how_to_read_a_source(tmp_path, cli, root):
    """Checks two channels of a file as two volumes; options of the command line override."""
    bumps = leaflight.bump_box(12).values
    np.save(tmp_path / "x.npy", np.stack([bumps, 2 * bumps]))
    look = {"albedo": [0.5, 0.5, 0.5], "source": "x.npy"}
    volumes = [
        {"name": "a", "reading": {"frame": 0}, **look},
        {"name": "b", "reading": {"frame": 1, "spacing": [1, 1, 2]}, **look},
    ]
    scene = json.loads((root / "scenes" / "cornell.json").read_text())
    scene = {key: value for key, value in scene.items() if not key.startswith("isosurface_")}
    path = written(tmp_path / "two.json", json.dumps({**scene, "volumes": volumes}))
    again = scene_from_json(scene_to_json(load_scene(path)))
    assert [one.reading for one in again.isosurfaces] == [one["reading"] for one in volumes]
    out = tmp_path / "two.vdb"
    work = ("--error", "50", "--out", out)
    cli.runs("bake", "--scene", path, *work)
    first, second = leaflight.load_bake(out).volumes
    assert second.field().range[1] == 2 * first.field().range[1]
    np.testing.assert_allclose(np.diag(second.index_to_world), [1, 1, 2, 1])
    volumes[0]["reading"] = {"color": 1}
    path.write_text(json.dumps({**scene, "volumes": volumes}))
    cli.refuses("color", "bake", "--scene", path, *work)
