# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks labels as surfaces: their names, colors and eyes, and label maps on scans."""

import bpy
import numpy as np
import pytest
from boxes import build_cornell_box
from leaflight.srgb import linear_from_srgb
from leaflight_addon.edit import label_operators
from leaflight_addon.show import surface_object
from leaflight_addon.stage import staleness
from leaflight_addon.store import cache
from tools import close, colors_of, vertices_of

N = 24
TABLE = "3 Left_Lung 255 0 0 255\n7 Heart 0 128 128 255\n"
RED, TEAL = (1.0, 0.0, 0.0), linear_from_srgb(np.array([0.0, 128 / 255, 128 / 255]))


@pytest.fixture
def path(tmp_path):
    """Writes two touching balls with the labels 3 and 7, and their table."""
    z, y, x = np.mgrid[:N, :N, :N] - 0.5 * (N - 1)
    labels = np.zeros((N, N, N), np.uint8)
    labels[(x - 4) ** 2 + y**2 + z**2 < 25] = 7
    labels[(x + 4) ** 2 + y**2 + z**2 < 25] = 3
    np.save(tmp_path / "regions.npy", labels)
    (tmp_path / "regions.ctbl").write_text(TABLE)
    return tmp_path / "regions.npy"


@pytest.fixture
def regions(path):
    """Returns the object of the surfaces, and that of the label map."""
    bpy.ops.leaflight.import_volume(filepath=str(path))
    obj = bpy.context.object
    obj.leaflight.bake_folder = str(path.parent / "bakes")
    obj.leaflight.error, obj.leaflight.resolution = 20.0, N
    return obj, obj.leaflight.texture_volume


def _sides(obj, name="texture"):
    """Returns the colors of the vertices left and right of the middle."""
    bpy.context.view_layer.update()
    places, colors = vertices_of(obj)[:, 0], colors_of(obj, name)
    return colors[places < -0.05], colors[places > 0.05]


def check_the_list_has_the_names_and_colors_of_the_table(regions):
    obj, label_map = regions
    labels = label_map.leaflight.labels
    assert obj.leaflight.isovalue == 0.5 and label_map.hide_render
    assert label_map.name == "regions labels"
    assert [(label.number, label.name) for label in labels] == [(3, "Left Lung"), (7, "Heart")]
    close(labels[0].color, RED, 1e-6)
    close(labels[1].color, TEAL, 1e-6)
    left, right = _sides(obj)
    close(left, np.tile(RED, (len(left), 1)), 2e-3)
    close(right, np.tile(TEAL, (len(right), 1)), 2e-3)


def check_surfaces_of_labels_can_be_left_off(path):
    bpy.ops.leaflight.import_volume(filepath=str(path), labels=False)
    assert bpy.context.object.leaflight.texture_volume is None


def check_a_color_changes_at_once(regions):
    obj, label_map = regions
    build_cornell_box()
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    before, _ = _sides(obj, "radiance")
    label_map.leaflight.labels[0].color = (0.0, 1.0, 0.0)
    left, right = _sides(obj)
    close(left, np.tile((0.0, 1.0, 0.0), (len(left), 1)), 2e-3)
    close(right, np.tile(TEAL, (len(right), 1)), 2e-3)
    lit, _ = _sides(obj, "radiance")
    assert lit[:, 1].max() > 0 and lit[:, 0].max() < 0.1 * before[:, 0].max()
    assert staleness.change_since_bake(bpy.context, obj).startswith("The scene has changed")
    label_map.leaflight.labels[0].color = RED
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, obj) == ""


def check_a_closed_eye_removes_a_surface(regions):
    obj, label_map = regions
    build_cornell_box()
    bpy.ops.leaflight.bake()
    label_map.leaflight.labels[1].is_shown = False
    bpy.context.view_layer.update()
    assert obj.leaflight.hide == "7"
    field = cache.volume_of(obj).values
    inside = cache.volume_of(label_map).values == 3
    np.testing.assert_array_equal(field > 0.5, inside)
    # Where the other ball was, the surface has the color of the first.
    colors = colors_of(obj, "texture")
    close(colors, np.tile(RED, (len(colors), 1)), 2e-3)
    assert "radiance" not in obj.data.attributes
    assert "hidden labels have changed" in staleness.change_since_bake(bpy.context, obj)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    assert len(np.unique(_sides(obj)[0].round(2), axis=0)) == 1
    label_map.leaflight.labels[1].is_shown = True
    bpy.context.view_layer.update()
    assert np.count_nonzero(cache.volume_of(obj).values > 0.5) > np.count_nonzero(inside)


def check_all_eyes_at_once(regions):
    obj, label_map = regions
    label_map.leaflight.label = 1
    for which, hidden in (("ACTIVE", "3"), ("OTHERS", "7"), ("ALL", "")):
        bpy.ops.leaflight.show_labels(which=which)
        assert obj.leaflight.hide == hidden
    for label in label_map.leaflight.labels:
        label.is_shown = False
    assert "all labels are hidden" in surface_object.problems[obj.name_full]
    bpy.ops.leaflight.show_labels(which="ALL")
    assert not surface_object.problems and len(obj.data.vertices)


def check_a_saved_scene_keeps_eyes_colors_and_names(regions, tmp_path):
    obj, label_map = regions
    labels = label_map.leaflight.labels
    labels[1].is_shown, labels[0].color, labels[0].name = False, (0.0, 0.0, 1.0), "Lung"
    names = obj.name, label_map.name
    count = len(obj.data.vertices)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "labels.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "labels.blend"))
    obj, label_map = (bpy.data.objects[name] for name in names)
    found = [(label.name, label.is_shown) for label in label_map.leaflight.labels]
    assert found == [("Lung", True), ("Heart", False)] and obj.leaflight.hide == "7"
    obj.leaflight.isovalue = 0.52
    obj.leaflight.isovalue = 0.5
    bpy.context.view_layer.update()
    assert len(obj.data.vertices) == count
    close(colors_of(obj, "texture"), np.tile((0.0, 0.0, 1.0), (count, 1)), 2e-3)


def check_undo_opens_an_eye(regions):
    obj, label_map = regions
    names, count = (obj.name, label_map.name), len(obj.data.vertices)
    bpy.ops.ed.undo_push(message="imported")
    label_map.leaflight.labels[1].is_shown = False
    bpy.ops.ed.undo_push(message="eye")
    assert len(obj.data.vertices) < count
    bpy.ops.ed.undo()
    obj, label_map = (bpy.data.objects[name] for name in names)
    assert label_map.leaflight.labels[1].is_shown and obj.leaflight.hide == ""
    assert len(obj.data.vertices) == count


def check_a_table_is_read_later(regions, tmp_path):
    obj, label_map = regions
    table = tmp_path / "snap.txt"
    table.write_text('3 0 255 0 1 1 1 "Kidney"\n')
    bpy.ops.leaflight.read_label_table(filepath=str(table))
    names = [label.name for label in label_map.leaflight.labels]
    assert names == ["Kidney", "Label 7"]
    left, _ = _sides(obj)
    close(left, np.tile((0.0, 1.0, 0.0), (len(left), 1)), 2e-3)
    table.write_text('30 0 255 0 1 1 1 "Kidney"\n')
    with pytest.raises(RuntimeError, match="has none of the labels in"):
        bpy.ops.leaflight.read_label_table(filepath=str(table))
    table.write_text("3 Kidney green\n")
    with pytest.raises(RuntimeError, match="line 1 of the label table"):
        bpy.ops.leaflight.read_label_table(filepath=str(table))


def check_a_label_map_colors_a_scan(path, tmp_path):
    """Checks a scan, along x, in the place of its label map."""
    (tmp_path / "regions.ctbl").unlink()
    (tmp_path / "given.txt").write_text('3 255 0 0 1 1 1 "Lung"\n')
    scan = np.broadcast_to(np.linspace(0, 100, N, dtype=np.float32), (N, N, N))
    np.save(tmp_path / "scan.npy", np.ascontiguousarray(scan.transpose(2, 0, 1)))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "scan.npy"))
    obj = bpy.context.object
    options = {"size_from": "SAME", "partner": obj.name, "labels": False}
    table = str(tmp_path / "given.txt")
    bpy.ops.leaflight.import_volume(filepath=str(path), label_table=table, **options)
    label_map = bpy.context.object
    assert [label.name for label in label_map.leaflight.labels] == ["Lung", "Label 7"]
    bpy.context.view_layer.objects.active = obj
    obj.leaflight.texture_volume = label_map
    assert obj.leaflight.texture_kind == "LABELS"
    obj.leaflight.isovalue = 50.0
    bpy.context.view_layer.update()
    colors = {tuple(color) for color in colors_of(obj, "texture").round(2).tolist()}
    expected = [tuple(np.round(label.color, 2)) for label in label_map.leaflight.labels]
    assert (1.0, 0.0, 0.0) in colors and (1.0, 1.0, 1.0) in colors and len(colors) == 3
    assert any(np.allclose(color, expected[1], atol=0.02) for color in colors)
    # Its eyes concern surfaces of labels, not of scans.
    label_map.leaflight.labels[0].is_shown = False
    assert obj.leaflight.hide == ""


def check_thousands_of_labels_are_listed(tmp_path):
    labels = np.zeros((40, 40, 40), np.uint16)
    labels[4:36, 4:36, 4:36] = 1 + np.arange(32**3).reshape(32, 32, 32) // 8
    np.save(tmp_path / "many.npy", labels)
    lines = [f"{n} part_{n} {n % 256} 0 0 255" for n in range(1, 4097)]
    (tmp_path / "many.ctbl").write_text("\n".join(lines))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "many.npy"))
    obj = bpy.context.object
    label_map = label_operators.label_map_of(obj)
    assert len(label_map.leaflight.labels) == 4096
    assert label_map.leaflight.labels[99].name == "part 100"
