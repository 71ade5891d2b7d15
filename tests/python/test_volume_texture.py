# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests isosurfaces whose color is given by another volume."""

import json
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight import Volume
from leaflight.io.scene_file import cornell_box, scene_from_json, scene_to_json
from leaflight.measure.sampling import Sampling
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of, without
from leaflight.scene.volume_texture import VolumeTexture, picture_stops, texture_of
from outcomes import refused

ISOVALUES = (40.0, 70.0)
SETTINGS = {"isovalues": ISOVALUES, "resolution": 25, "error": 3.0, "seed": 2, "progress": False}
RED, BLUE = (0.9, 0.05, 0.05), (0.05, 0.05, 0.9)
WHITE = [(0.0, (1.0, 1.0, 1.0))]


def on_box(function, nodes, name="volume"):
    """Returns a Volume of function(x, y, z) over the box from -1 to 1."""
    axis = np.linspace(-1.0, 1.0, nodes)
    values = function(axis[None, None, :], axis[None, :, None], axis[:, None, None])
    values = np.ascontiguousarray(np.broadcast_to(values, (nodes,) * 3))
    kept = values if values.dtype == np.uint8 else values.astype(np.float32)
    return Volume(kept, spacing=2.0 / (nodes - 1), origin=-1.0, name=name)


def wavy(x, y, z):
    return 100.0 - 60.0 * np.sqrt(x * x + y * y + z * z) - 6.0 * np.sin(5.0 * x) * np.sin(5.0 * y)


@pytest.fixture(scope="module")
def volume():
    return on_box(wavy, 32, "wavy")


def labels(nodes=17):
    """Returns labels: 1 for x < 0, else 2."""
    return on_box(lambda x, y, z: 1 + (x > 0).astype(np.uint8), nodes, "labels")


TEXTURES = {
    "a map over values": lambda: texture_of(on_box(lambda x, y, z: x + y * z, 20), "CET_D1"),
    "labels": lambda: texture_of(labels(), [(1.0, RED), (2.0, BLUE)], nearest=True),
    "three channels": lambda: texture_of(
        [on_box(lambda x, y, z, i=i: 100.0 * (x, y, z)[i], 9) for i in range(3)],
        value_range=(-120.0, 120.0),
    ),
}


def test_values_of_a_picture_are_srgb():
    volumes = [on_box(lambda x, y, z, i=i: 127.5 + 127.5 * (x, y, z)[i], 9) for i in range(3)]
    colors = texture_of(volumes, picture_stops(0.0, 255.0)).at(np.array([[-1.0, 0.0, 1.0]]))
    np.testing.assert_allclose(colors, [[0.0, ((0.5 + 0.055) / 1.055) ** 2.4, 1.0]], atol=1e-5)


def scene_with(texture, **material):
    scene = cornell_box()
    isosurfaces = replace(scene.isosurfaces[0], texture=texture, albedo=(0.9, 0.9, 0.9), **material)
    return replace(scene, isosurfaces=[isosurfaces])


def found_percent(baked, isovalue, back=False):
    """Returns (RMS error in percent without noise, mean of the bake / mean of path tracing)."""
    side = IsosurfaceSide(baked, isovalue, back=back)
    truth = side.path_traced(Sampling(400, 256, 1), None)
    errors = errors_of(side.baked(truth.points), truth, baked.scene.exposure)
    ratio = side.baked(truth.points).mean(axis=0) / truth.radiance.mean(axis=0)
    return without(errors["rms_percent"], errors["reference_noise_percent"]), ratio


@pytest.mark.parametrize("name", TEXTURES)
def test_a_bake_agrees_with_the_path_tracer(volume, name):
    bake = leaflight.bake(volume, scene_with(TEXTURES[name]()), **SETTINGS)
    percent, ratio = found_percent(bake, 55.0)
    assert percent < 2.0
    np.testing.assert_allclose(ratio, 1.0, atol=0.03)


def test_the_color_at_a_point_is_exact(volume):
    """Checks that the border of two labels is sharp, although texels are wide."""
    bake = leaflight.bake(volume, scene_with(TEXTURES["labels"]()), **SETTINGS)
    points = bake.surface(55.0).vertices
    radiance = bake.radiance(points)
    red = points[:, 0] < -1.0 / 16
    blue = points[:, 0] > 1.0 / 16
    assert (radiance[red, 0] > 2.0 * radiance[red, 2]).all()
    assert (radiance[blue, 2] > 2.0 * radiance[blue, 0]).all()
    texture = bake.scene.isosurfaces[0].texture
    shares = radiance / texture.at(points)
    # Beside the border the light without the color is almost continuous.
    near = np.abs(points[:, 0]) < 0.1
    left, right = (shares[near & side].mean(axis=0) for side in (red, blue))
    np.testing.assert_allclose(left, right, rtol=0.2)


@pytest.mark.parametrize("both", [False, True])
def test_a_white_texture_changes_no_bit(volume, both):
    white = texture_of(labels(), WHITE)
    plain, textured = (
        leaflight.bake(volume, scene_with(texture), both_sides=both, walls=True, **SETTINGS)
        for texture in (None, white)
    )
    points = plain.surface(55.0).vertices
    for back in (False, True) if both else (False,):
        light = [bake.radiance(points, back=back) for bake in (plain, textured)]
        np.testing.assert_array_equal(*light)
    for mesh in range(len(plain.scene.meshes)):
        light = [bake.walls.radiance(mesh, 55.0) for bake in (plain, textured)]
        np.testing.assert_array_equal(*light)


def test_the_back_has_the_color_too():
    """Checks a sheet whose back is lit."""
    sheet = on_box(lambda x, y, z: 50.0 + 40.0 * z + 5.0 * np.sin(4.0 * x) * np.sin(4.0 * y), 24)
    scene = scene_with(TEXTURES["labels"]())
    bake = leaflight.bake(sheet, scene, both_sides=True, **SETTINGS)
    for back in (False, True):
        percent, ratio = found_percent(bake, 55.0, back)
        assert percent < 2.0
        np.testing.assert_allclose(ratio, 1.0, atol=0.02 if back else 0.06)


def test_a_file_holds_the_texture(volume, tmp_path):
    scene = scene_with(TEXTURES["a map over values"]())
    bake = leaflight.bake(volume, scene, **SETTINGS)
    bake.save(tmp_path / "bake.vdb")
    loaded = leaflight.load_bake(tmp_path / "bake.vdb")
    points = bake.surface(55.0).vertices
    assert loaded.id == bake.id
    np.testing.assert_allclose(loaded.radiance(points), bake.radiance(points), rtol=2e-3, atol=1e-4)
    other = replace(scene.isosurfaces[0].texture, nearest=True)
    assert leaflight.bake(volume, scene_with(other), **SETTINGS).id != bake.id


def test_a_unit_moves_the_texture_along(volume):
    """Checks a texture in centimeters on a volume in millimeters."""
    small = replace(labels(), unit="cm")
    matrix = np.diag([10.0, 10, 10, 1]) @ volume.index_to_world
    large = replace(volume, unit="mm", index_to_world=matrix)
    colors = [(1.0, RED), (2.0, BLUE)]
    bake = leaflight.bake(large, scene_with(texture_of(small, colors, nearest=True)), **SETTINGS)
    points = bake.surface(55.0).vertices
    left = points[:, 0] < -1.0
    radiance = bake.radiance(points)
    assert (radiance[left, 0] > radiance[left, 2]).all()


def test_a_capped_volume_keeps_the_place_of_its_texture(volume):
    bake = leaflight.bake(volume, scene_with(TEXTURES["labels"](), capped=True), **SETTINGS)
    percent, ratio = found_percent(bake, 55.0)
    assert percent < 2.5


def test_scene_files_name_or_hold_textures(tmp_path):
    text = scene_to_json(scene_with(TEXTURES["labels"]()))
    again = scene_from_json(text).isosurfaces[0].texture
    assert again.nearest and again.colors == [(1.0, RED), (2.0, BLUE)]
    np.testing.assert_array_equal(again.channels[0].values, labels().values)
    np.testing.assert_array_equal(again.channels[0].index_to_world, labels().index_to_world)
    assert scene_to_json(scene_from_json(text)) == text
    np.save(tmp_path / "values.npy", on_box(lambda x, y, z: 100.0 * x, 9).values)
    channels = '[{"name": "v", "source": "values.npy"}]'
    texture = f'{{"channels": {channels}, "map": "MAGMA", "range": [0, 5]}}'
    named = text[: text.index('"texture":')] + f'"texture": {texture}' + _after_texture(text)
    found = scene_from_json(named, folder=tmp_path).isosurfaces[0].texture
    assert found.colors[0][0] == 0.0 and found.colors[-1][0] == 5.0


def test_wrong_numbers_of_a_texture_are_refused(tmp_path):
    data = json.loads(scene_to_json(scene_with(TEXTURES["labels"]())))
    surface = data["volumes"][0]
    channel = surface["texture"]["channels"][0]
    channel["dims"] = [1e300, 1, 1]
    refused("must be three numbers in 1..1048576", scene_from_json, json.dumps(data))
    np.save(tmp_path / "values.npy", labels().values)
    channel = {"name": "v", "source": "values.npy"}
    surface["texture"]["channels"] = [channel]
    for name, value, right in (
        ("smooth", "1", "a number"),
        ("spacing", "two", "one positive number or three"),
        ("frame", [[1], 2], "a number"),
        ("regions", 3, "a kind of box"),
        ("regions", ["ball"], "a kind of box"),
        ("regions", [{"kind": "within_labels", "label_map": "x", "labels": 3}], "whole numbers"),
        ("regions", [{"kind": "within_labels", "label_map": 3}], "label map 3 is no path"),
        ("regions", [{"kind": "within_labels", "label_map": "x", "reading": 3}], "its reading"),
    ):
        channel["reading"] = {name: value}
        refused(right, scene_from_json, json.dumps(data), folder=tmp_path)


def _after_texture(text):
    """Returns the text after the object of the texture."""
    start = text.index('"texture":') + len('"texture":')
    _, length = json.JSONDecoder().raw_decode(text[start:].lstrip())
    return text[start:].lstrip()[length:]


def test_unusable_textures_are_refused(volume):
    matrix = labels().index_to_world.copy()
    matrix[0, 3] += 10.0
    far = replace(labels(), index_to_world=matrix)
    bake = leaflight.bake
    refused("does not overlap", bake, volume, scene_with(texture_of(far, "MAGMA")), **SETTINGS)
    refused("is empty", texture_of, labels(), "MAGMA", (3.0, 3.0))
    refused("no color map", texture_of, labels(), "PINK")
    unequal = [labels(), labels(), labels(9)]
    refused("differ in their shape", bake, volume, scene_with(texture_of(unequal)), **SETTINGS)
    refused("one channel, or three", VolumeTexture((labels(), labels()), WHITE).core)
    glowing = scene_with(texture_of(labels(), WHITE), emission=(1.0, 1.0, 1.0))
    refused("emit light and have a texture", bake, volume, glowing, **SETTINGS)
    bright = scene_with(texture_of(labels(), [(0.0, (2.0, 1.0, 1.0))]))
    refused("albedo of the texture", bake, volume, bright, **SETTINGS)
    descending = scene_with(texture_of(labels(), [(1.0, RED), (0.0, BLUE)]))
    refused("ascending order", bake, volume, descending, **SETTINGS)
    flat = replace(labels(), index_to_world=np.zeros((4, 4)))
    refused("cannot be inverted", VolumeTexture((flat,), WHITE).core)
