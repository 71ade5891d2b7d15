# SPDX-License-Identifier: GPL-3.0-or-later
"""Finer texels where light varies most: baked, kept, and shown by vertex attribute."""

import bpy
import leaflight
import mathutils
import numpy as np
import pytest
from leaflight.scene.on_mesh import interpolated
from leaflight_addon.bake import bake
from leaflight_addon.show import surface_material
from leaflight_addon.store import atlases, bake_files, cache
from tools import (
    assert_shows,
    camera_rays_down,
    close,
    colours_of,
    look_down,
    mesh_arrays,
    render_exr,
    to_world,
    vertices_of,
)

REASON = "Vertex attribute: a volume texture holds no finer texels"


@pytest.fixture
def refined(boxed):
    boxed.leaflight.refine = 1
    bpy.ops.leaflight.bake()
    return boxed


def _unrefined(obj):
    """The same bake without finer texels."""
    ours, settings = cache.bake_of(obj), obj.leaflight
    return leaflight.bake(
        ours.volume,
        ours.scene,
        isovalues=ours.isovalues,
        samples=settings.samples,
        photons=settings.photons,
    )


def _shading_nodes(obj):
    """The kinds of nodes of the material that the object has."""
    return {node.type for node in obj.data.materials[0].node_tree.nodes}


def _assert_by_vertices(obj):
    assert obj.leaflight.shading == "ATLAS"
    assert surface_material.shading_in_use(obj.leaflight) == ("ATTRIBUTE", REASON)
    nodes = _shading_nodes(obj)
    assert "ATTRIBUTE" in nodes and "TEX_IMAGE" not in nodes


def check_the_surface_shows_the_finer_texels(uncut, refined):
    ours = cache.bake_of(refined)
    assert ours.metadata["refine"] == "1" and ours.grid.levels == 2
    isovalue = refined.leaflight.isovalue
    assert_shows(refined, isovalue)
    vertices, _, radiance = mesh_arrays(refined)
    coarse_mesh, _, _ = leaflight._core.contour(cache.volume_of(refined).field(), isovalue)
    assert 1.1 * len(coarse_mesh) < len(vertices) < 4 * len(coarse_mesh)
    world = to_world(refined, vertices)
    close(radiance, ours.radiance(world), 1e-4 * radiance.max())
    coarse = _unrefined(refined)
    difference = np.abs(radiance - coarse.radiance(world)).max(axis=1)
    assert difference.max() > 0.1 * radiance.max()
    # Finer texels serve some cells alone, in which light varies most.
    assert 0.05 < np.mean(difference > 1e-3 * radiance.max()) < 0.9


def check_both_sides_have_finer_texels(boxed):
    boxed.leaflight.both_sides = True
    boxed.leaflight.refine = 1
    bpy.ops.leaflight.bake()
    ours, world = cache.bake_of(boxed), to_world(boxed, vertices_of(boxed))
    assert ours.grid.levels == 2
    for name, back in (("radiance", False), ("radiance_back", True)):
        shown = colours_of(boxed, name)
        close(shown, ours.radiance(world, back=back), 1e-4 * shown.max())
    _assert_by_vertices(boxed)


def check_the_report_counts_texels_of_all_levels(boxed):
    boxed.leaflight.refine = 1
    job = bake.BakeJob(bpy.context, boxed)
    job.run(leaflight.Progress())
    summary = job.apply()
    levels = [int(job.bake.grid.mask(level).sum()) for level in range(2)]
    assert min(levels) > 1000
    assert summary.startswith(f"Baked {sum(levels)} texels")


def check_it_is_shown_by_vertex_attribute_with_the_reason(refined):
    settings = refined.leaflight
    _assert_by_vertices(refined)
    assert not atlases.beside(bake_files.locate(refined))
    settings.shading = "ATTRIBUTE"
    assert surface_material.shading_in_use(settings) == ("ATTRIBUTE", "")
    settings.shading = "ATLAS"
    settings.refine = 0
    _assert_by_vertices(refined)
    bpy.ops.leaflight.bake()
    assert surface_material.shading_in_use(settings) == ("ATLAS", "")
    assert "TEX_IMAGE" in _shading_nodes(refined)


def check_an_atlas_of_an_earlier_bake_is_no_longer_shown(baked):
    assert "TEX_IMAGE" in _shading_nodes(baked)
    baked.leaflight.refine = 1
    bpy.ops.leaflight.bake()
    _assert_by_vertices(baked)


def check_the_reason_is_the_finer_texels_even_if_the_atlas_would_be_too_large(boxed, monkeypatch):
    monkeypatch.setattr(atlases, "LARGEST_ATLAS", 64)
    boxed.leaflight.refine = 1
    bpy.ops.leaflight.bake()
    _assert_by_vertices(boxed)


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_renders_show_the_finer_texels(refined, tmp_path, engine):
    vertices, triangles, _ = mesh_arrays(refined)
    world = to_world(refined, vertices)
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj != refined
    size, width = 64, 2.0
    look_down(5.0, width)
    pixels = render_exr(tmp_path / "leaf.exr", engine, size=size)[..., :3].reshape(-1, 3)
    seen, points = _hits(refined, width, size)
    assert seen.sum() > 500

    def error(lit):
        expected = interpolated(world, triangles, lit.radiance(world), points)
        return np.abs(pixels[seen] - expected).max(axis=1)

    # Where rays pass the edge of a triangle an engine may choose its neighbour.
    assert np.mean(error(cache.bake_of(refined)) < 2e-3) > 0.95
    assert np.mean(error(_unrefined(refined)) < 2e-3) < 0.9


def _hits(obj, width, size):
    """Which pixels of look_down show the outer side of the object, and where, in world space."""
    inverse = obj.matrix_world.inverted()
    down = inverse.to_3x3() @ mathutils.Vector((0, 0, -1))
    xs, ys = camera_rays_down(width, size)
    seen, points = [], []
    for x, y in zip(xs.ravel(), ys.ravel()):
        hit, point, normal, _ = obj.ray_cast(inverse @ mathutils.Vector((x, y, 5.0)), down)
        seen.append(hit and normal.dot(down) < 0)
        if seen[-1]:
            points.append(obj.matrix_world @ point)
    return np.array(seen), np.array(points)


def check_a_saved_file_shows_the_finer_texels_again(refined, tmp_path):
    before, name = cache.bake_of(refined), refined.name
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[name]
    assert obj.leaflight.refine == 1
    _assert_by_vertices(obj)
    obj.leaflight.isovalue += 7.0
    assert cache.bake_of(obj).grid.levels == 2
    vertices, _, radiance = mesh_arrays(obj)
    # The file holds 16 bits of each number.
    close(radiance, before.radiance(to_world(obj, vertices)), 2e-3 * radiance.max())
    _assert_by_vertices(obj)


def check_a_duplicate_shows_the_finer_texels(refined):
    bpy.ops.object.select_all(action="DESELECT")
    refined.select_set(True)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy != refined
    copy.leaflight.isovalue += 7.0
    assert_shows(copy, copy.leaflight.isovalue)
    _assert_by_vertices(copy)
