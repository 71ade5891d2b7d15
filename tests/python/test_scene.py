# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the shipped scenes, how scenes fit volumes, and the checks of scenes."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight import Volume, fit_scene, load_scene
from leaflight.io.scene_file import scene_to_json
from leaflight.io.sources import open_volume
from leaflight.scene.lights import AreaLight, Cone, PointLight, SunLight
from leaflight.scene.scene import (
    Environment,
    Isosurfaces,
    Mesh,
    SceneDescription,
    core_scene,
    match_isosurfaces,
)
from outcomes import refused


def brick(scale=1.0, offset=(0.0, 0.0, 0.0)):
    """Returns a volume of 4 x 6 x 11 nodes with a mirrored x axis."""
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


@pytest.mark.parametrize("scale, offset", [(1, (0, 0, 0)), (1e-3, (5, -7, 3)), (1e4, (0, 9, 0))])
def test_box_coordinates_fit_any_volume(scale, offset):
    volume = brick(scale, offset)
    fitted = fit_scene(leaflight.cornell_box(), volume)
    bounds = np.asarray(volume.field().bounds)
    points = corners(fitted)
    assert fitted.coordinates == "world"
    assert (points.min(axis=0) < bounds[0]).all() and (points.max(axis=0) > bounds[1]).all()
    # All axes have one scale, from the longest side (z, 10 steps).
    box = corners(leaflight.cornell_box())
    np.testing.assert_allclose(np.ptp(points, axis=0), 5 * scale * np.ptp(box, axis=0), rtol=1e-4)
    light = fitted.lights[0]
    below, above = light.corner[2] - bounds[1][2], points[:, 2].max() - light.corner[2]
    assert below > 0 and above > 0


def test_world_coordinates_stay(bump_scene):
    assert fit_scene(bump_scene, brick()) is bump_scene


def test_several_volumes_fit_as_one():
    near, far = brick(), brick(offset=(30, 0, 0))
    fitted = fit_scene(leaflight.cornell_box(), [near, far])
    points = corners(fitted)
    for volume in (near, far):
        low, high = np.asarray(volume.field().bounds)
        assert (points.min(axis=0) < low).all() and (points.max(axis=0) > high).all()


def test_a_point_light_grows_with_the_scene():
    """Checks that a light twice as far and four times as strong gives the same irradiance."""
    point = PointLight("bulb", (0.0, 0.0, 2.0), 0.1, (1.0, 2.0, 3.0))
    sun = SunLight("sun", (0.0, 0.0, -1.0), (1.0, 1.0, 1.0))
    box = replace(leaflight.cornell_box(), lights=[point, sun])
    # The longest side is 10, so the scale is 5.
    fitted = fit_scene(box, brick())
    assert fitted.lights[0].radius == pytest.approx(0.5)
    assert fitted.lights[0].intensity == pytest.approx((25, 50, 75))
    assert fitted.lights[0].position == pytest.approx((-1.5, 2.5, 15))
    assert fitted.lights[1] is sun


def test_one_look_serves_all_volumes():
    volumes = [replace(brick(), name=name) for name in ("a", "b")]
    matched = match_isosurfaces(leaflight.cornell_box(), volumes)
    assert [isosurfaces.name for isosurfaces in matched.isosurfaces] == ["a", "b"]
    assert matched.isosurfaces[0].isovalues == leaflight.default_isovalue_range(volumes[0])
    single = match_isosurfaces(leaflight.cornell_box(), volumes[:1])
    assert single.isosurfaces[0].isovalues is None


def test_as_many_volumes_as_the_scene_describes(root):
    scene = load_scene(root / "scenes" / "nucleons.json")
    refused("2 volumes, but 3", match_isosurfaces, scene, [brick()] * 3)


def test_shipped_scenes_are_accepted_by_the_core(shipped):
    sources = [isosurfaces.source or "bump_box" for isosurfaces in shipped.isosurfaces]
    volumes = [open_volume(source, dims=[12]) for source in sources]
    description = match_isosurfaces(fit_scene(shipped, volumes), volumes)
    isovalue_range = (0.0, 1.0) if len(volumes) > 1 else (20.0, 90.0)
    core_scene(description, [volume.field() for volume in volumes], isovalue_range)


TRIANGLE = Mesh("floor", np.eye(3, dtype=np.float32), np.uint32([[0, 1, 2]]), (0.5, 0.5, 0.5))
AREA = AreaLight("lamp", (0, 0, 1), (1, 0, 0), (0, 1, 0), (1, 1, 1))
POINT = PointLight("bulb", (0, 0, 2), 0.0, (1, 1, 1), Cone((0, 0, -1), 1.0))
SUN = SunLight("sun", (0, 0, -1), (1, 1, 1))
WORLD = Environment("sky", (1, 1, 1), np.ones((2, 4, 3), dtype=np.float32))
ISOSURFACES = Isosurfaces("brick", (0.5, 0.5, 0.5))
SCENE = SceneDescription("test", [ISOSURFACES], 1.0, [TRIANGLE], [AREA, POINT, SUN], WORLD)
NAN = float("nan")
GRAY = (0.5, 0.5, 0.5)
IMAGE = np.ones((2, 2, 3), dtype=np.float32)
UV = np.zeros((1, 3, 2), dtype=np.float32)


def build(isosurfaces=ISOSURFACES, mesh=TRIANGLE, light=AREA, environment=WORLD):
    volume = brick()
    own = {"isosurfaces": [isosurfaces], "meshes": [mesh], "lights": [light]}
    description = replace(SCENE, environment=environment, **own)
    return core_scene(description, [volume.field()], (0.2, 0.8))


def test_every_kind_of_object_is_accepted_by_the_core():
    for light in SCENE.lights:
        build(light=light)
    build(light=replace(POINT, cone=None), environment=None)
    build(mesh=replace(TRIANGLE, texture=IMAGE, uv=UV, scattering="glass", emission=(1, 0, 0)))
    ramp = [(0.3, (0.1, 0.2, 0.3)), (0.4, (1, 1, 1))]
    build(replace(ISOSURFACES, albedo=ramp, emission=ramp, scattering="mirror"))


@pytest.mark.parametrize(
    "objects, sentence",
    [
        ({"isosurfaces": replace(ISOSURFACES, albedo=(0.5, 1.5, 0.5))}, "brick.*1.5.*between 0"),
        ({"isosurfaces": replace(ISOSURFACES, albedo=[(1, GRAY), (0, GRAY)])}, "brick.*ascending"),
        ({"isosurfaces": replace(ISOSURFACES, albedo=[])}, "brick"),
        ({"isosurfaces": replace(ISOSURFACES, scattering="velvet")}, "brick.*velvet"),
        ({"isosurfaces": replace(ISOSURFACES, scattering="glass", ior=0)}, "brick"),
        ({"isosurfaces": replace(ISOSURFACES, emission=(-1, 0, 0))}, "brick.*emission"),
        ({"mesh": replace(TRIANGLE, vertices=np.full((3, 3), NAN))}, "floor.*not a number"),
        ({"mesh": replace(TRIANGLE, vertices=np.ones((3, 2)))}, "vertices.*floor.*shape"),
        ({"mesh": replace(TRIANGLE, triangles=np.zeros((0, 3)))}, "no faces.*floor"),
        ({"mesh": replace(TRIANGLE, triangles=[[0, 1, 3]])}, "floor.*vertex 3"),
        ({"mesh": replace(TRIANGLE, albedo=(2, 0, 0))}, "floor.*between 0 and 1"),
        ({"mesh": replace(TRIANGLE, scattering="velvet")}, "floor.*velvet"),
        ({"mesh": replace(TRIANGLE, uv=UV)}, "texture.*floor"),
        ({"mesh": replace(TRIANGLE, texture=IMAGE)}, "texture.*floor"),
        ({"mesh": replace(TRIANGLE, texture=IMAGE, uv=UV[:, :2])}, "uv.*floor.*shape"),
        ({"mesh": replace(TRIANGLE, texture=3 * IMAGE, uv=UV)}, "floor.*between 0 and 1"),
        ({"mesh": replace(TRIANGLE, texture=IMAGE[0], uv=UV)}, r"floor.*\[row, column, RGB\]"),
        ({"light": replace(AREA, edge_v=(2, 0, 0))}, "lamp.*area"),
        ({"light": replace(AREA, radiance=(0, -1, 0))}, "lamp.*negative"),
        ({"light": replace(POINT, radius=-1)}, "bulb.*radius"),
        ({"light": replace(POINT, intensity=(NAN, 0, 0))}, "bulb.*intensity"),
        ({"light": replace(POINT, cone=Cone((0, 0, 0), 1))}, "bulb.*axis"),
        ({"light": replace(POINT, cone=Cone((0, 0, 1), 0))}, "bulb.*cone"),
        ({"light": replace(POINT, cone=Cone((0, 0, 1), 7))}, "bulb.*cone"),
        ({"light": replace(POINT, cone=Cone((0, 0, 1), 1, 2))}, "bulb.*blend"),
        ({"light": replace(SUN, direction=(0, 0, -2))}, "sun.*length 1"),
        ({"light": replace(SUN, angle=4)}, "sun.*angle"),
        ({"light": replace(SUN, irradiance=(-1, 0, 0))}, "sun.*irradiance"),
        ({"environment": replace(WORLD, radiance=(-1, 0, 0))}, "sky.*radiance"),
        ({"environment": replace(WORLD, image=-WORLD.image)}, "sky.*negative"),
        ({"environment": replace(WORLD, world_to_image=((0,) * 3,) * 3)}, "sky"),
    ],
)
def test_the_core_names_what_is_wrong(objects, sentence):
    message = refused(sentence, build, **objects)
    assert message.endswith(".") and "\n" not in message


def test_a_black_sky_is_no_light():
    black = replace(WORLD, image=np.zeros((2, 4, 3), dtype=np.float32))
    settings = {"isovalues": (0.2, 0.8), "error": 20.0, "resolution": 8}
    refused("no light", leaflight.bake, brick(), replace(SCENE, lights=[], environment=black))
    lit, alone = (
        leaflight.bake(brick(), replace(SCENE, environment=sky), **settings)
        for sky in (black, None)
    )
    points = lit.surface(0.5).vertices
    np.testing.assert_array_equal(lit.radiance(points), alone.radiance(points))


def test_a_lamp_far_away_lights_as_a_sun():
    far = PointLight("star", (0.6e13, 0.0, 0.8e13), 0.0, (1e26, 1e26, 1e26))
    sun = SunLight("sun", (-0.6, 0.0, -0.8), (1.0, 1.0, 1.0))
    stars, suns = (
        leaflight.bake(brick(), replace(SCENE, lights=[lamp], environment=None), error=20.0)
        for lamp in (far, sun)
    )
    points = suns.surface(0.5).vertices
    expected = suns.radiance(points)
    assert expected.max() > 0.05
    np.testing.assert_allclose(stars.radiance(points), expected, atol=0.02 * expected.max())


def test_a_closed_white_room_ends():
    """Checks photons of isovalues that no voxel has, which meet nothing that absorbs them."""
    low, high = np.asarray(brick().field().bounds) + [[-1.0], [1.0]]
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.uint32([(a, b, c) for s in sides for a, b, c in (s[:3], (s[0], *s[2:]))])
    room = Mesh("room", np.float32(low + corners * (high - low)), triangles, (1.0, 1.0, 1.0))
    lamp = PointLight("bulb", tuple(high - 0.1), 0.0, (1.0, 1.0, 1.0))
    scene = replace(SCENE, meshes=[room], lights=[lamp], environment=None)
    bake = leaflight.bake(brick(), scene, isovalues=(0.2, 1.02), error=20.0, walls=True)
    assert np.isfinite(bake.walls.radiance(0, 0.5, False)).all()
