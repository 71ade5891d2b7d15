# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes with textures by other programs and settings, and changes of textures afterwards."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight import Checkpoint, Volume
from leaflight.flatland import bake_flatland, bump_box_2d, flat_box
from leaflight.io.scene_file import cornell_box
from leaflight.measure.sampling import Sampling
from leaflight.measure.sides import IsosurfaceSide, MeshSide
from leaflight.scene.volume_texture import label_texture, sign_texture, texture_of
from outcomes import refused
from same_bytes import assert_same_light, saved_alike
from test_checkpoint import interrupted
from test_volume_texture import (
    BLUE,
    ISOVALUES,
    RED,
    SETTINGS,
    TEXTURES,
    WHITE,
    labels,
    on_box,
    scene_with,
    wavy,
)

SMALL = {**SETTINGS, "error": 20.0, "resolution": 12}
TWO = [(1.0, RED), (2.0, BLUE)]


def ball(nodes=24, up=0.0):
    volume = on_box(lambda x, y, z: 100.0 - 90.0 * np.sqrt(x * x + y * y + z * z), nodes, "ball")
    matrix = volume.index_to_world.copy()
    matrix[2, 3] += up
    return replace(volume, index_to_world=matrix)


def scene_of_two(*textures):
    """Returns the Cornell box with two volumes and a texture of each."""
    (one,) = scene_with(None, isovalues=(30.0, 80.0)).isosurfaces
    return replace(cornell_box(), isosurfaces=[replace(one, texture=each) for each in textures])


def in_the_dark(scene):
    """Returns a scene whose walls reflect nothing. A convex isosurface then has direct light."""
    black = [replace(mesh, albedo=(0.0, 0.0, 0.0)) for mesh in scene.meshes]
    return replace(scene, meshes=black)


def white(nodes=17):
    return texture_of(labels(nodes), WHITE)


def test_a_resumed_bake_has_the_same_bits(tmp_path):
    scene = scene_with(TEXTURES["a map over values"]())
    arguments = {"volumes": on_box(wavy, 8), "scene": scene, "isovalues": ISOVALUES, "error": 0.3}
    whole = leaflight.bake(**arguments)
    assert whole.statistics.passes > 1
    checkpoint = Checkpoint(tmp_path / "x.checkpoint", seconds=0.0)
    interrupted(arguments, checkpoint, 1)
    again = replace(checkpoint, resume=True)
    assert_same_light(leaflight.bake(**arguments, checkpoint=again, threads=1), whole)
    other = scene_with(TEXTURES["labels"]())
    refused("another bake", leaflight.bake, **{**arguments, "scene": other}, checkpoint=again)


@pytest.mark.parametrize("textures", ["green and labels", "none and red"])
def test_each_of_several_volumes_has_its_texture(tmp_path, textures):
    """Checks both volumes and their file, whose light paths gather, beside path tracing."""
    if textures == "none and red":
        scene = scene_of_two(None, texture_of(labels(), [(1.0, RED)]))
    else:
        green = texture_of(ball(up=1.3), [(30.0, (0.05, 0.9, 0.05)), (80.0, (0.9, 0.9, 0.05))])
        scene = scene_of_two(green, texture_of(labels(), TWO, nearest=True))
    settings = {**SETTINGS, "isovalues": None, "error": 2.0}
    bake = leaflight.bake([ball(up=1.3), ball()], scene, **settings)
    bake.save(tmp_path / "two.vdb")
    loaded = leaflight.load_bake(tmp_path / "two.vdb")
    for number in (0, 1):
        points = bake.surface(0.5, number).vertices[::20]
        truth, _ = bake.reference(points, 0.5, spp=256, volume=number)
        for each in (bake, loaded):
            found = each.radiance(points, number).mean(axis=0)
            np.testing.assert_allclose(found, truth.mean(axis=0), rtol=0.03, atol=0.005)
    if textures == "none and red":
        above = bake.radiance(bake.surface(0.5, 0).vertices)
        assert above[:, 0].mean() > 1.05 * above[:, 2].mean()


@pytest.mark.parametrize("estimator", ["path", "gather", "volumetric", "thesis"])
def test_fixed_samples_and_photons_have_the_color(thesis, estimator, tmp_path):
    """Checks a red half beside path tracing, and that a file holds the color once."""
    settings = {"samples": 32, "photons": 50_000, "isovalues": ISOVALUES}
    scene = scene_with(TEXTURES["labels"]())
    bake = thesis.bake(on_box(wavy, 16), scene, estimator=estimator, **settings)
    points = bake.surface(55.0).vertices
    points = points[points[:, 0] < -0.15][::4]
    truth, _ = bake.reference(points, 55.0, spp=128)
    found = bake.radiance(points)
    np.testing.assert_allclose(found.mean(axis=0), truth.mean(axis=0), rtol=0.15)
    bake.save(tmp_path / "fixed.vdb")
    loaded = leaflight.load_bake(tmp_path / "fixed.vdb").radiance(points)
    np.testing.assert_allclose(loaded, found, rtol=2e-3, atol=1e-4)


def test_compare_with_a_texture():
    bake = leaflight.bake(on_box(wavy, 24), scene_with(TEXTURES["labels"]()), **SETTINGS)
    found = leaflight.compare(bake, 55.0, points=400, spp=128, seed=1)
    assert found["rms_percent"] < 3.0 and abs(found["mean_ratio"] - 1.0) < 0.03


def test_a_red_label_colors_the_white_wall_beside_it():
    """Checks means over walls beside a red and a blue label within 2 % of path tracing."""
    scene = scene_with(TEXTURES["labels"]())
    scene = replace(scene, meshes=[replace(mesh, albedo=(0.8, 0.8, 0.8)) for mesh in scene.meshes])
    bake = leaflight.bake(on_box(wavy, 20), scene, **{**SETTINGS, "error": 2.0}, walls=True)
    ratios = {}
    for name, back in (("left wall", False), ("right wall", True)):
        side = MeshSide(bake, name, 55.0, back)
        truth = side.path_traced(Sampling(300, 512, 1), None)
        found, expected = side.baked(truth.points).mean(axis=0), truth.radiance.mean(axis=0)
        np.testing.assert_allclose(found, expected, rtol=0.02)
        ratios[name] = found[0] / found[2]
        np.testing.assert_allclose(ratios[name], expected[0] / expected[2], rtol=0.02)
    assert ratios["left wall"] > 1.08 and ratios["right wall"] < 0.97


def test_a_white_texture_changes_no_bit_of_paths():
    volumes = [ball(12, up=1.3), ball(12)]
    settings = {**SMALL, "isovalues": None}
    plain, textured = (
        leaflight.bake(volumes, scene_of_two(*textures), **settings)
        for textures in ((None, None), (white(), white()))
    )
    for number in (0, 1):
        points = plain.surface(0.5, number).vertices
        light = [bake.radiance(points, number) for bake in (plain, textured)]
        np.testing.assert_array_equal(*light)


def test_without_a_texture_files_have_no_byte_more(tmp_path):
    """Checks that a file with a texture is longer only by the text of its scene."""
    plain, textured = (
        leaflight.bake(on_box(wavy, 12), scene_with(texture), **SMALL)
        for texture in (None, white())
    )
    assert "texture" not in plain.provenance.to_json()
    files = [saved_alike(bake, tmp_path / "x.vdb") for bake in (plain, textured)]
    assert b"texture" not in files[0]
    more = len(textured.provenance.to_json()) - len(plain.provenance.to_json())
    assert len(files[1]) - len(files[0]) == more


def saddle():
    return on_box(lambda x, y, z: x + y * z, 20)


CHANGES = {
    "another map": lambda: texture_of(saddle(), "MAGMA"),
    "another range": lambda: texture_of(saddle(), "CET_D1", (-0.3, 1.5)),
    "another volume": TEXTURES["labels"],
    "no volume": lambda: None,
}


@pytest.mark.parametrize("name", CHANGES)
def test_direct_light_is_exact_in_new_colors(name):
    """Checks a convex isosurface in a dark room by path tracing with the new texture."""
    volume, settings = ball(16), {**SMALL, "error": 3.0}
    before = in_the_dark(scene_with(TEXTURES["a map over values"]()))
    now = in_the_dark(scene_with(CHANGES[name]()))
    bake = leaflight.bake(volume, before, **settings)
    points = bake.surface(55.0).vertices[::5]
    texture = now.isosurfaces[0].texture_on(volume.field())
    found = bake.grid.with_texture(texture).lookup(volume.field(), points)
    again = leaflight.bake(volume, now, **settings)
    np.testing.assert_allclose(found, again.radiance(points), rtol=1e-5, atol=1e-6)
    truth, error = again.reference(points, 55.0, spp=256)
    assert truth.mean() > 0.02
    assert abs((found - truth).mean()) < 0.01 * truth.mean()
    moved = bake.moved(volume, now)
    np.testing.assert_allclose(moved.radiance(points), found, rtol=1e-4, atol=1e-6)


def test_bounces_keep_the_old_color():
    """Checks that a white surface over red light has the light of the bake, without its color."""
    volume = on_box(wavy, 16)
    bake = leaflight.bake(volume, scene_with(texture_of(labels(), [(1.0, RED)])), **SMALL)
    points = bake.surface(55.0).vertices
    shown = bake.grid.with_texture(None).lookup(volume.field(), points)
    np.testing.assert_allclose(shown * np.float32(RED), bake.radiance(points), rtol=1e-5)
    new = leaflight.bake(volume, scene_with(None), **SMALL).radiance(points)
    # Red light has lost little, and blue light almost all that isosurfaces reflect.
    red, blue = (shown.mean(axis=0) / new.mean(axis=0))[[0, 2]]
    assert 0.9 < red < 1.0 and blue < red - 0.02


def test_values_that_are_no_colors_are_refused():
    empty = replace(labels(), values=np.full((17,) * 3, np.nan, np.float32), name="empty")
    volume, words = on_box(wavy, 12), "empty: its values are not finite numbers"
    refused(words, texture_of, empty)
    refused(words, sign_texture, empty)
    for texture in (texture_of(empty, None, (0.0, 1.0)), label_texture(empty)):
        refused(words, leaflight.bake, volume, scene_with(texture), **SMALL)
    text = replace(labels(), values=np.full((3, 3, 3), "red"), name="words")
    refused("words: its values are not finite numbers", texture_of, text)
    for value_range in ((0.0, np.inf), (np.nan, 1.0)):
        refused("is empty or infinite", texture_of, labels(), None, value_range)


def test_files_of_text_are_refused(tmp_path):
    np.save(tmp_path / "words.npy", np.full((4, 4, 4), "red"))
    (tmp_path / "words.csv").write_text("x,y,z,color\n1,2,3,red\n4,5,6,blue\n")
    for name in ("words.npy", "words.csv"):
        assert "\n" not in refused(name, leaflight.read_volume, tmp_path / name)


def test_infinite_values_have_the_colors_of_the_ends():
    values = np.linspace(0.0, 1.0, 9, dtype=np.float32) * np.ones((9, 9, 9), np.float32)
    values[..., 0], values[..., -1] = -np.inf, np.inf
    texture = texture_of(Volume(values, spacing=2.0 / 8, origin=-1.0, name="poles"), "CET_D1")
    assert texture.colors[0][0] == 0.125 and texture.colors[-1][0] == 0.875
    ends = texture.at(np.array([[-1.0, 0, 0], [1.0, 0, 0]]))
    np.testing.assert_allclose(ends, [texture.colors[0][1], texture.colors[-1][1]], atol=1e-6)


def test_a_volume_may_color_itself():
    """Checks that it then has the light of a ramp over its isovalues."""
    volume, ramp = on_box(wavy, 16), [(40.0, RED), (70.0, BLUE)]
    (one,) = scene_with(None).isosurfaces
    own = {"albedo": (1.0, 1.0, 1.0), "texture": texture_of(volume, ramp)}
    bakes = []
    for material in (own, {"albedo": ramp}):
        scene = replace(cornell_box(), isosurfaces=[replace(one, **material)])
        bakes.append(leaflight.bake(volume, scene, **SETTINGS))
    side = IsosurfaceSide(bakes[1], 55.0)
    points = side.path_traced(Sampling(300, 2, 1), None).points
    own, ramped = (bake.radiance(points) for bake in bakes)
    np.testing.assert_allclose(own.mean(axis=0), ramped.mean(axis=0), rtol=0.01)


def test_flatland_has_no_textures():
    scene = flat_box()
    scene = replace(scene, isosurfaces=replace(scene.isosurfaces, texture=white()))
    refused("labels: no image can color", bake_flatland, bump_box_2d(12), scene)
