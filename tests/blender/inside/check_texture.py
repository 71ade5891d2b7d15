# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks isosurfaces that another volume colors."""

import bpy
import leaflight
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from leaflight.scene.volume_texture import color_map
from leaflight_addon.show import display, surface_material, surface_object, texture
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache
from leaflight_addon.ui import look_panel, volume_panel
from mathutils import Vector
from passes import Layout, drawn
from tools import (
    close,
    colors_of,
    error_of,
    imported_gltf,
    mesh_arrays,
    render_exr,
    vertices_of,
)

N = 24
# Meshes of the Cornell box.
WALLS = 5


@pytest.fixture
def colored(boxed, tmp_path):
    """Returns a volume whose isosurfaces another one colors, with the values 0 to 1 along x."""
    values = np.broadcast_to(np.linspace(0.0, 1.0, N, dtype="<f4"), (N, N, N))
    other = _import(boxed, np.ascontiguousarray(values), tmp_path / "along_x.raw", "float32")
    boxed.leaflight.texture_map = "CET_D1"
    boxed.leaflight.texture_volume = other
    bpy.context.view_layer.update()
    return boxed, other


def _import(obj, values, path, kind):
    """Imports values in the place of a volume object, which becomes active again."""
    values.tofile(path)
    bpy.ops.leaflight.import_volume(
        filepath=str(path),
        dims=(N, N, N),
        value_type=kind,
        spacing=(1.0, 1.0, 0.8),
        size_from="SAME",
        partner=obj.name,
        labels=False,
    )
    other = bpy.context.object
    bpy.context.view_layer.objects.active = obj
    obj.leaflight.shading = "ATTRIBUTE"
    return other


def _shares(obj, axis=0):
    """Returns the share 0..1 of each vertex along an axis of the volume."""
    low, high = np.asarray(cache.volume_of(obj).field().bounds)[:, axis]
    return (vertices_of(obj)[:, axis] - low) / (high - low)


def _expected(obj, key="CET_D1", axis=0, share=1.0, shares=None, reverse=False):
    """Returns the colors of the vertices. share: Part of the color map that the values cover."""
    stops = color_map(key, reverse)
    positions, colors = [p for p, _ in stops], np.array([c for _, c in stops])
    shares = share * _shares(obj, axis) if shares is None else shares
    return np.array([np.interp(shares, positions, channel) for channel in colors.T]).T


def check_unlit_isosurfaces_have_the_colors(colored):
    obj, other = colored
    assert not other.leaflight.linked
    assert "linked" not in drawn(volume_panel.LEAFLIGHT_PT_volume)
    assert other.hide_render and (obj.leaflight.texture_low, obj.leaflight.texture_high) == (0, 1)
    close(colors_of(obj, "texture"), _expected(obj), 2e-3)
    (material,) = obj.data.materials
    attributes = {n.attribute_name for n in material.node_tree.nodes if n.type == "ATTRIBUTE"}
    assert "texture" in attributes


def check_a_bake_has_the_colors(colored):
    obj, _ = colored
    obj.leaflight.shading = "ATLAS"
    bpy.ops.leaflight.bake()
    assert surface_material.shading_in_use(obj.leaflight)[0] == "ATTRIBUTE"
    bake = cache.bake_of(obj)
    assert len(bake.volumes) == 1 and bake.scene.isosurfaces[0].texture is not None
    assert staleness.change_since_bake(bpy.context, obj) == ""
    vertices, _, radiance = mesh_arrays(obj)
    matrix = np.array(obj.matrix_world, np.float64)
    world = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    close(radiance, bake.radiance(world), 1e-3 * radiance.max())
    white = bake.grid.with_texture(None).lookup(bake.volume.field(), world)
    close(radiance, white * _expected(obj), 5e-3 * radiance.max())


def check_other_colors_show_at_once(colored, uncut, tmp_path):
    """Checks that the light of the bake is shown in the new colors, and a note on a new bake."""
    obj, other = colored
    y = np.broadcast_to(np.linspace(0.0, 1.0, N, dtype="<f4")[:, None], (N, N, N))
    along_y = _import(obj, np.ascontiguousarray(y), tmp_path / "along_y.raw", "float32")
    along_y.hide_render = True
    bpy.ops.leaflight.bake()
    bake, field = cache.bake_of(obj), cache.volume_of(obj).field()
    white = bake.grid.with_texture(None).lookup(field, vertices_of(obj))
    for name, value, before, expected in (
        ("texture_map", "MAGMA", "CET_D1", _expected(obj, "MAGMA")),
        ("texture_high", 2.0, 1.0, _expected(obj, share=0.5)),
        ("texture_volume", along_y, other, _expected(obj, axis=1)),
        ("texture_volume", None, other, np.ones(3)),
    ):
        setattr(obj.leaflight, name, value)
        bpy.context.view_layer.update()
        radiance = colors_of(obj)
        close(radiance, white * expected, 5e-3 * radiance.max())
        note = staleness.change_since_bake(bpy.context, obj)
        assert note == "The scene has changed since the bake: bake again"
        setattr(obj.leaflight, name, before)
        bpy.context.view_layer.update()
        assert staleness.change_since_bake(bpy.context, obj) == ""
        close(colors_of(obj), white * _expected(obj), 5e-3 * radiance.max())


def check_a_volume_elsewhere_is_refused(colored):
    obj, other = colored
    other.matrix_world.translation.x += 100.0
    bpy.context.view_layer.update()
    obj.leaflight.isovalue += 1.0
    assert "along_x: it does not overlap" in surface_object.problems[obj.name_full]
    assert "does not overlap" in error_of(bpy.ops.leaflight.bake)
    other.matrix_world.translation.x -= 100.0
    bpy.context.view_layer.update()
    assert obj.name_full not in surface_object.problems


def check_an_export_has_the_colors_that_are_shown(colored, uncut, tmp_path, monkeypatch):
    obj, _ = colored
    bpy.ops.leaflight.bake()
    obj.leaflight.texture_map = "MAGMA"
    obj.matrix_world.translation.x += 1.0
    bpy.context.view_layer.update()
    bpy.ops.leaflight.export(filepath=str(tmp_path / "box.glb"))
    found, linear, corners = imported_gltf(tmp_path / "box.glb", monkeypatch)
    # Blender 3.4 leaves out the values.
    if bpy.app.version >= (4, 2, 0):
        values = np.empty(len(found.data.vertices), np.float32)
        found.data.attributes["_ALONG_X"].data.foreach_get("value", values)
        close(values, _shares(obj), 1e-5)
    # Blender keeps eight bits of sRGB in some versions.
    close(linear, np.clip(colors_of(obj), 0, 1)[corners], 0.01)


def check_a_map_reversed_symmetric_and_in_steps(colored):
    obj, _ = colored
    settings = obj.leaflight
    settings.texture_reverse = True
    close(colors_of(obj, "texture"), _expected(obj, reverse=True), 2e-3)
    settings.texture_reverse = False
    settings.texture_symmetric = True
    # The values 0 to 1 then have the upper half of the map.
    close(colors_of(obj, "texture"), _expected(obj, shares=0.5 + 0.5 * _shares(obj)), 2e-3)
    settings.texture_symmetric = False
    settings.texture_steps = 3
    assert len(np.unique(colors_of(obj, "texture").round(3), axis=0)) == 3
    settings.texture_map = "TAB10"
    settings.texture_steps = 0
    assert len(np.unique(colors_of(obj, "texture").round(3), axis=0)) <= 10


def _values_of_colors(obj, key):
    """Returns the values 0..1 that the vertices' colors have in a map."""
    stops = color_map(key)
    red = [color[0] for _, color in stops]
    return np.interp(colors_of(obj, "texture")[:, 0], red, [place for place, _ in stops])


def check_the_height_colors_without_another_volume(boxed, tmp_path):
    """Checks a turned and scaled object, whose colors follow the height in the scene."""
    obj = boxed
    obj.rotation_euler, obj.scale = (0.5, 0.3, 0.2), (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    obj.leaflight.texture_map = "CET_L1"
    obj.leaflight.texture_kind = "HEIGHT"
    settings = obj.leaflight
    vertices, matrix = vertices_of(obj), np.array(obj.matrix_world, np.float64)
    heights = ((vertices + settings.origin) @ matrix[:3, :3].T)[:, 2] / 2.0
    assert settings.texture_low < heights.min() < heights.max() < settings.texture_high
    shares = (heights - settings.texture_low) / (settings.texture_high - settings.texture_low)
    close(_values_of_colors(obj, "CET_L1"), shares, 5e-3)
    obj.rotation_euler.x += 0.4
    bpy.context.view_layer.update()
    obj.leaflight.isovalue += 0.1
    assert np.abs(_values_of_colors(obj, "CET_L1")[:100] - shares[:100]).max() > 0.05


def check_the_panel_asks_for_a_volume_only_where_it_is_needed(colored):
    obj, _ = colored
    of_map = {"texture_map", "texture_reverse", "texture_steps", "texture_symmetric"}
    for kind, shown, hidden in (
        ("MAP", {"texture_volume", *of_map}, {"texture_green"}),
        ("HEIGHT", of_map, {"texture_volume"}),
        ("GRADIENT", of_map, {"texture_volume"}),
        ("CHANNELS", {"texture_volume", "texture_green", "texture_low"}, {"texture_map"}),
        ("LABELS", {"texture_volume"}, {"texture_low", *of_map}),
    ):
        obj.leaflight.texture_kind = kind
        seen = []
        look_panel._draw_texture(Layout(seen), obj)
        assert shown <= set(seen) and not hidden & set(seen), kind


def check_a_bake_with_the_gradient_is_current_and_reopens(boxed, tmp_path):
    obj = boxed
    obj.leaflight.texture_kind = "GRADIENT"
    assert obj.leaflight.texture_high > obj.leaflight.texture_low >= 0.0
    obj.leaflight.bake_folder = ""
    path = tmp_path / "gradient.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    found = cache.bake_of(obj).scene.isosurfaces[0].texture
    volume = cache.volume_of(obj)
    expected = leaflight.gradient_of(volume)
    close(found.channels[0].values, expected.values, 1e-4 * expected.values.max())
    bpy.ops.wm.save_mainfile()
    name = obj.name
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[name]
    obj.leaflight.isovalue += 1.0
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj.leaflight.texture_kind = "HEIGHT"
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, obj).startswith("The scene has changed")


def _bar():
    """Returns (bar, its heights 0..1, its colors, {text: its height 0..1 in the bar})."""
    (bar,) = [o for o in bpy.data.objects if display.is_display(o, "color bar") and o.children]
    length = vertices_of(bar)[:, 1].max()
    texts = {text.data.body: text.location.y / length for text in bar.children}
    return bar, vertices_of(bar)[:, 1] / length, colors_of(bar, "bar_color"), texts


def check_the_color_bar_has_the_colors_and_numbers(colored):
    obj, other = colored
    bpy.context.scene.view_settings.exposure = 0.0
    other.name = "potential (e/bohr)"
    bpy.ops.leaflight.add_color_bar()
    bar, heights, colors, texts = _bar()
    close(colors, _expected(obj, shares=heights), 1e-5)
    assert {text: share for text, share in texts.items() if share <= 1} == pytest.approx(
        {"0": 0, "0.5": 0.5, "1": 1}
    )
    assert set(texts) - {"0", "0.5", "1"} == {"potential (e/bohr)"}
    # All of it is at the right of the picture.
    bpy.context.view_layer.update()
    for part in (bar, *bar.children):
        for corner in part.bound_box:
            at = part.matrix_world @ Vector(corner)
            x, y, _ = world_to_camera_view(bpy.context.scene, bpy.context.scene.camera, at)
            assert 0.6 < x < 1 and 0 < y < 1
    assert len(scene_export.export_scene(bpy.context, obj)[0].meshes) == WALLS


def check_the_color_bar_follows_the_map_and_its_range(colored):
    obj, _ = colored
    bpy.ops.leaflight.add_color_bar()
    obj.leaflight.texture_high = 4.0
    obj.leaflight.texture_low = -2.0
    obj.leaflight.texture_map = "MAGMA"
    bar, heights, colors, texts = _bar()
    close(colors, _expected(obj, "MAGMA", shares=heights), 1e-5)
    assert {"-2", "1", "4"} < set(texts)
    obj.leaflight.texture_steps = 2
    assert len(np.unique(_bar()[2].round(4), axis=0)) == 2
    bpy.ops.leaflight.add_color_bar()
    (bar, *_) = _bar()
    obj.leaflight.texture_volume = None
    assert not bar.children and not len(bar.data.vertices)
    obj.leaflight.texture_kind = "HEIGHT"
    assert "height" in " ".join(_bar()[3])


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_the_color_bar_renders_in_its_colors(colored, tmp_path, engine):
    bpy.context.scene.view_settings.exposure = 0.0
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 64
    bpy.ops.leaflight.add_color_bar()
    bpy.context.view_layer.update()
    bar, camera = _bar()[0], bpy.context.scene.camera
    pixels = render_exr(tmp_path / "bar.exr", engine, size=64)[..., :3]
    for share in (0.1, 0.9):
        (low, *_, high) = sorted(bar.bound_box, key=sum)
        middle = [low[0] + 0.5 * (high[0] - low[0]), low[1] + share * (high[1] - low[1]), 0.0]
        x, y, _ = world_to_camera_view(bpy.context.scene, camera, bar.matrix_world @ Vector(middle))
        found = pixels[int(64 * (1 - y)), int(64 * x)]
        close(found, _expected(colored[0], shares=np.array([share]))[0], 0.05)


def check_colors_without_a_range_have_no_bar(colored, tmp_path):
    obj, _ = colored
    labels = np.broadcast_to(np.arange(N, dtype=np.uint8) // 8, (N, N, N))
    other = _import(obj, np.ascontiguousarray(labels), tmp_path / "labels.raw", "uint8")
    obj.leaflight.texture_volume = other
    obj.leaflight.texture_kind = "LABELS"
    assert "no range for a color bar" in error_of(bpy.ops.leaflight.add_color_bar)
    bpy.data.objects.remove(bpy.context.scene.camera)
    assert "no camera" in error_of(bpy.ops.leaflight.add_color_bar)


def check_labels_have_separate_colors(boxed, tmp_path):
    labels = np.broadcast_to(np.arange(N, dtype=np.uint8) // 8, (N, N, N))
    other = _import(boxed, np.ascontiguousarray(labels), tmp_path / "labels.raw", "uint8")
    boxed.leaflight.texture_kind = "LABELS"
    boxed.leaflight.texture_volume = other
    bpy.context.view_layer.update()
    assert len(np.unique(colors_of(boxed, "texture").round(3), axis=0)) == 3


def check_three_channels_are_red_green_and_blue(colored, tmp_path):
    obj, red = colored
    y = np.broadcast_to(np.linspace(0.0, 1.0, N, dtype="<f4")[:, None], (N, N, N))
    green = _import(obj, np.ascontiguousarray(y), tmp_path / "along_y.raw", "float32")
    obj.leaflight.texture_kind = "CHANNELS"
    # Without all three there is no color.
    assert "texture" not in obj.data.attributes
    obj.leaflight.texture_green = green
    obj.leaflight.texture_blue = red
    bpy.context.view_layer.update()
    colors, shares = colors_of(obj, "texture"), _shares(obj)
    close(colors[:, 0], shares, 2e-3)
    close(colors[:, 2], shares, 2e-3)
    assert np.abs(colors[:, 1] - shares).max() > 0.2 and green.hide_render


def check_channels_are_chosen_from_red_to_blue(boxed, tmp_path):
    obj, others = boxed, []
    for high in (1.0, 3.0, 2.0):
        x = np.broadcast_to(np.linspace(0.0, high, N, dtype="<f4"), (N, N, N))
        path = tmp_path / f"to_{high:g}.raw"
        others.append(_import(obj, np.ascontiguousarray(x), path, "float32"))
    settings = obj.leaflight
    settings.texture_kind = "CHANNELS"
    settings.texture_volume, settings.texture_green, settings.texture_blue = others
    assert all(other.hide_render for other in others)
    assert (settings.texture_low, settings.texture_high) == (0.0, 3.0)


def check_fractions_are_no_labels(colored):
    obj, other = colored
    obj.leaflight.texture_kind = "LABELS"
    assert "are not whole numbers" in surface_object.problems[obj.name_full]
    obj.leaflight.texture_kind = "MAP"
    assert not surface_object.problems


def check_a_deleted_volume_no_longer_colors(colored):
    obj, other = colored
    bpy.data.objects.remove(other)
    assert texture.volumes_that_color(obj) == []
    obj.leaflight.isovalue += 1.0
    assert "texture" not in obj.data.attributes


def check_displays_go_with_a_deleted_volume(colored):
    """Checks a volume that the color bar keeps in the file."""
    obj, other = colored
    obj.leaflight.unit = "mm"
    obj.leaflight_look.slice_axes = (True, False, False)
    bpy.ops.leaflight.add_isosurface()
    bpy.ops.leaflight.add_scale_bar()
    bpy.ops.leaflight.add_color_bar()
    bpy.context.view_layer.update()
    scene = bpy.context.scene
    assert len({o["leaflight_display"] for o in scene.objects if display.is_display(o)}) == 4
    # A label with another parent, or none, stays.
    labels = [o for o in scene.objects if display.is_display(o, display.SCALE_BAR)]
    for label in labels:
        label.parent = None
    bpy.context.view_layer.update()
    assert labels and all(label.name in scene.objects for label in labels)
    display.select(bpy.context, [obj], obj)
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    assert other.name in scene.objects
    assert not any(map(display.is_display, scene.objects))


def check_a_saved_scene_opens_in_color(colored, tmp_path):
    obj, _ = colored
    obj.leaflight.bake_folder = ""
    path = tmp_path / "colored.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.leaflight.bake()
    bpy.ops.wm.save_mainfile()
    name, before = obj.name, colors_of(obj)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[name]
    obj.leaflight.isovalue += 1.0
    obj.leaflight.isovalue -= 1.0
    close(colors_of(obj), before, 1e-3 * before.max())
    assert staleness.change_since_bake(bpy.context, obj) == ""
    loaded = leaflight.load_bake(bpy.path.abspath(obj.leaflight.bake_path))
    assert loaded.scene.isosurfaces[0].texture.name == "along_x"


def _orbital(path):
    """Writes a p orbital along z as a file without a header."""
    axis = np.linspace(-1.0, 1.0, N)
    radius = np.sqrt(axis**2 + axis[:, None] ** 2 + axis[:, None, None] ** 2)
    (axis[:, None, None] * np.exp(-6.0 * radius)).astype("<f4").tofile(path)
    return {"filepath": str(path), "dims": (N, N, N), "value_type": "float32"}


def check_lobes_of_both_signs_have_two_colors(tmp_path):
    bpy.ops.leaflight.import_volume(**_orbital(tmp_path / "p.raw"))
    obj = bpy.context.object
    signed = obj.leaflight.texture_volume
    assert signed.hide_render
    assert obj.leaflight.field == "absolute" and not signed.leaflight.field
    assert not obj.leaflight.both_sides and obj.leaflight.low >= 0.0
    assert np.allclose(signed.matrix_world, obj.matrix_world)
    heights, colors = vertices_of(obj)[:, 2], colors_of(obj, "texture")
    above, below = colors[heights > 0.1], colors[heights < -0.1]
    assert len(above) and len(below) and (above[:, 0] > above[:, 2]).all()
    assert (below[:, 2] > below[:, 0]).all()
    bpy.ops.leaflight.stage()
    obj.leaflight.error, obj.leaflight.resolution = 20.0, N
    obj.leaflight.bake_folder = str(tmp_path / "bakes")
    bpy.ops.leaflight.bake()
    assert len(cache.bake_of(obj).volumes) == 1
    assert staleness.change_since_bake(bpy.context, obj) == ""


def check_both_signs_can_be_left_off(tmp_path):
    bpy.ops.leaflight.import_volume(**_orbital(tmp_path / "p.raw"), both_signs=False)
    (obj,) = [obj for obj in bpy.data.objects if obj.leaflight.is_volume]
    assert obj.leaflight.texture_volume is None and not obj.leaflight.field
