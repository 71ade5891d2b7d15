# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks images as graphs with isolines, lit within the plane."""

import bpy
import leaflight
import numpy as np
import pytest
from leaflight import _core, flatland
from leaflight_addon.flatland import isolines
from leaflight_addon.flatland import graph_object
from leaflight_addon.show import surface_object
from leaflight_addon.stage import scene_export
from tools import close, colors_of, error_of, smooth_image, vertices_of


@pytest.fixture
def bump_graph():
    bpy.ops.leaflight.import_image(source="BUMP_BOX", nodes=48, count=5, size=3.0, height=0.4)
    graph = bpy.context.object
    settings = graph.leaflight_flat
    settings.error, settings.resolution = 20.0, 48
    return graph


@pytest.fixture
def lit(bump_graph):
    bpy.ops.leaflight.bake_flatland()
    return bump_graph


def _expected_lines(graph):
    """Yields points, heights and isovalues of all isolines, computed by the core."""
    field = graph_object.field_of(graph)
    settings = graph.leaflight_flat
    low, high = field.field().range
    for isovalue in graph_object.isovalues(settings):
        points, _, segments = _core.contour2(field.field(), float(isovalue))
        yield points, settings.height * (isovalue - low) / (high - low), segments


def check_the_graph_is_the_height_field(bump_graph):
    vertices = vertices_of(bump_graph)
    values = flatland.bump_box_2d(48).values
    y, x = np.mgrid[:48, :48] / 47.0
    close(vertices, np.stack([x.ravel(), y.ravel(), 0.4 * values.ravel() / 255.0], axis=-1), 1e-5)
    assert len(bump_graph.data.polygons) == 47 * 47
    assert all(polygon.normal.z > 0 for polygon in bump_graph.data.polygons)
    bpy.context.view_layer.update()
    corners = np.array([bump_graph.matrix_world @ v.co for v in bump_graph.data.vertices])
    close(corners.min(axis=0), [-1.5, -1.5, 0.0], 1e-5)
    close(corners.max(axis=0)[:2], [1.5, 1.5], 1e-5)


def check_isolines_are_tubes_about_the_cores(bump_graph):
    lines = graph_object.isolines_of(bump_graph)
    vertices = vertices_of(lines)
    expected = list(_expected_lines(bump_graph))
    assert len(expected) == 5
    rings = vertices.reshape(-1, 4, 3)
    middles = np.concatenate([np.column_stack([p, np.full(len(p), z)]) for p, z, _ in expected])
    close(rings.mean(axis=1), middles, 1e-5)
    width = bump_graph.leaflight_flat.width
    close(np.linalg.norm(rings - middles[:, None], axis=-1), 0.5 * width, 1e-5)
    assert len(lines.data.polygons) == 4 * sum(len(segments) for *_, segments in expected)


def check_passes_are_shown_until_the_bake_is_cancelled(lit):
    before = colors_of(lit)
    # Use many texels, so that one pass does not reach the error.
    lit.leaflight_flat.resolution, lit.leaflight_flat.seed = 800, 1
    job = isolines.FlatBakeJob(lit)
    job._arguments["error"] = 0.02
    job.run(leaflight.Progress())
    job.show()
    y, x = np.mgrid[:48, :48] / 47.0
    expected = 2 / np.pi * job.latest.radiance(np.column_stack([x.ravel(), y.ravel()]))
    shown = colors_of(lit)
    close(shown, expected, 1e-4)
    assert not np.array_equal(shown, before)
    assert job.ended() == job.cancelled
    close(colors_of(lit), before, 1e-6)


def check_both_show_the_bake(lit):
    bake = graph_object._bakes[lit.leaflight_flat.bake_id]
    factor = 2 / np.pi
    y, x = np.mgrid[:48, :48] / 47.0
    expected = factor * bake.radiance(np.column_stack([x.ravel(), y.ravel()]))
    assert expected.max() > 0.1
    close(colors_of(lit), expected, 1e-4)
    lines = graph_object.isolines_of(lit)
    points = np.concatenate([points for points, *_ in _expected_lines(lit)])
    close(colors_of(lines)[::4], factor * bake.radiance(points), 1e-5)
    for obj in (lit, lines):
        kinds = {node.type for node in obj.data.materials[0].node_tree.nodes}
        assert "EMISSION" in kinds and "BSDF_DIFFUSE" not in kinds
    lit.leaflight_flat.brightness_correction = False
    close(colors_of(lit), expected / factor, 1e-4)


def check_settings_take_effect_at_once(lit):
    before = len(graph_object.isolines_of(lit).data.vertices)
    lit.leaflight_flat.count = 9
    assert len(graph_object.isolines_of(lit).data.vertices) > before
    lit.leaflight_flat.height = 0.1
    vertices = vertices_of(lit)
    close(vertices[:, 2].max(), 0.1, 1e-5)
    assert colors_of(lit).max() > 0.1


def check_an_image_file(tmp_path):
    image = smooth_image(20, 10)
    image.filepath_raw, image.file_format = str(tmp_path / "waves.png"), "PNG"
    image.save()
    bpy.ops.leaflight.import_image(filepath=str(tmp_path / "waves.png"))
    graph = bpy.context.object
    vertices = vertices_of(graph)
    field = flatland.read_image(str(tmp_path / "waves.png"))
    assert graph.name == "waves" and len(vertices) == 200
    values = field.values.ravel()
    low, high = values.min(), values.max()
    close(vertices[:, 2], graph.leaflight_flat.height * (values - low) / (high - low), 1e-5)
    close(vertices[:, 0].max(), 1.0, 1e-5)
    close(vertices[:, 1].max(), 9 / 19, 1e-5)


def check_after_loading_the_file_the_light_stays_until_something_changes(lit, tmp_path):
    name = lit.name
    before = colors_of(lit)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    graph = bpy.data.objects[name]
    np.testing.assert_array_equal(colors_of(graph), before)
    graph.leaflight_flat.count = 3
    assert "bake again" in surface_object.problems[name]
    np.testing.assert_array_equal(colors_of(graph), before)
    bpy.context.view_layer.objects.active = graph
    bpy.ops.leaflight.bake_flatland()
    assert name not in surface_object.problems


def check_bad_input_gives_one_sentence(bump_graph, tmp_path):
    objects = len(bpy.data.objects)
    (tmp_path / "broken.png").write_bytes(b"no png")
    sentence = error_of(bpy.ops.leaflight.import_image, filepath=str(tmp_path / "broken.png"))
    assert "broken.png" in sentence and "\n" not in sentence
    assert len(bpy.data.objects) == objects
    bump_graph.leaflight_flat.high = -5.0
    assert "range" in error_of(bpy.ops.leaflight.bake_flatland)
    bpy.context.view_layer.objects.active = None
    assert "Select the graph" in error_of(bpy.ops.leaflight.bake_flatland)


def check_graph_and_isolines_are_no_part_of_a_scene_that_is_baked(lit, bumps):
    description, _, warnings = scene_export.export_scene(bpy.context, bumps)
    assert description.meshes == [] and warnings == []
