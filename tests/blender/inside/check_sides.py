# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks both sides of isosurfaces: baked, and each visible from its side."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from leaflight import blender
from leaflight_addon.store import atlases, bake_files, cache
from leaflight_addon.ui import volume_panel
from passes import drawn
from tools import close, colors_of, look_down, mesh_arrays, render_exr, texels_at


@pytest.fixture
def two_sided(boxed):
    boxed.leaflight.both_sides = True
    bpy.ops.leaflight.bake()
    return boxed


def check_the_mesh_has_both(two_sided):
    vertices, _, front = mesh_arrays(two_sided)
    grid, field = cache.grid_of(two_sided), cache.volume_of(two_sided).field()
    back = colors_of(two_sided, "radiance_back")
    close(front, grid.lookup(field, vertices), 1e-6)
    close(back, grid.lookup(field, vertices, back=True), 1e-6)
    assert np.abs(back - front).max() > 0.01


@pytest.mark.parametrize("shading", ["ATLAS", "ATTRIBUTE"])
@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_each_side_shows_its_radiance(two_sided, tmp_path, engine, shading):
    """Checks a facet of the isosurface from above, and, flipped, from below."""
    two_sided.leaflight.shading = shading
    (material,) = two_sided.data.materials
    bake, (vertices, _, _) = cache.bake_of(two_sided), mesh_arrays(two_sided)
    grid, field = bake.grid, cache.volume_of(two_sided).field()
    matrix = np.array(two_sided.matrix_world, np.float64)
    worlds = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    (known, front), (_, behind) = (
        texels_at(bake, worlds, name) for name in ("radiance", "radiance_back")
    )
    # Use a small triangle around a vertex that is bright on both sides.
    chosen = np.where(known, np.minimum(front, behind).min(axis=1), 0).argmax()
    middle, world = vertices[chosen].astype(np.float64), worlds[chosen]
    corners = np.array([[-0.02, -0.02, 0], [0.02, -0.02, 0], [0, 0.02, 0]])
    local = middle + corners @ np.linalg.inv(matrix[:3, :3]).T
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj.type != "LIGHT"
    camera = look_down(world[2] + 1.0, 0.001)
    camera.location.x, camera.location.y = world[:2]
    for order, back in (((0, 1, 2), False), ((0, 2, 1), True)):
        mesh = bpy.data.meshes.new("Facet")
        mesh.from_pydata(local.tolist(), [], [order])
        mesh.materials.append(material)
        for name, side in (("radiance", False), ("radiance_back", True)):
            colors = np.ones((3, 4), np.float32)
            colors[:, :3] = grid.lookup(field, middle[None], back=side)
            attribute = mesh.attributes.new(name, "FLOAT_COLOR", "POINT")
            attribute.data.foreach_set("color", colors.ravel())
        facet = bpy.data.objects.new("Facet", mesh)
        facet.matrix_world = two_sided.matrix_world
        bpy.context.scene.collection.objects.link(facet)
        pixels = render_exr(tmp_path / "facet.exr", engine, size=4)[..., :3]
        expected = grid.lookup(field, middle[None], back=back)[0]
        if shading == "ATLAS":
            expected = (behind if back else front)[chosen]
        assert expected.min() > 0.005
        close(pixels.mean(axis=(0, 1)), expected, 2e-3)
        bpy.data.objects.remove(facet)


def check_each_side_has_its_atlas(two_sided):
    nodes = two_sided.leaflight.baked_material.node_tree.nodes
    images = {node.image for node in nodes if node.type == "TEX_IMAGE"}
    paths = {Path(bpy.path.abspath(image.filepath)) for image in images}
    bake = bake_files.locate(two_sided)
    assert paths == set(atlases.beside(bake))
    assert paths == {atlases.path_of(bake), atlases.path_of(bake, back=True)}


def check_one_side_again(two_sided):
    two_sided.leaflight.both_sides = False
    bpy.ops.leaflight.bake()
    assert "radiance_back" not in two_sided.data.attributes
    kinds = {node.type for node in two_sided.leaflight.baked_material.node_tree.nodes}
    assert "BSDF_DIFFUSE" in kinds


def check_the_isovalue_has_a_note_where_the_back_is_seen(tmp_path):
    """Checks the negative lobe of a molecule, which has lower values inside."""
    x = np.linspace(-1.0, 1.0, 24)
    lobes = (
        np.exp(-8.0 * ((x - at) ** 2 + x[:, None] ** 2 + x[:, None, None] ** 2))
        for at in (-0.4, 0.4)
    )
    np.save(tmp_path / "molecule.npy", next(lobes) - next(lobes))
    obj = blender.import_volume(tmp_path / "molecule.npy", both_signs=False)
    settings = obj.leaflight
    settings.bake_folder, settings.error, settings.resolution = str(tmp_path), 50.0, 8
    settings.use_resolution, settings.low, settings.high = True, -0.4, 0.4
    # The import has switched it on.
    settings.both_sides = False
    blender.stage(obj)
    settings.light_walls = False
    blender.show(obj, -0.2)
    assert not _has_note()
    blender.bake(obj)
    assert _has_note()
    blender.show(obj, 0.2)
    assert not _has_note()
    blender.show(obj, -0.2)
    settings.both_sides = True
    blender.bake(obj)
    assert not _has_note()


def _has_note():
    texts = " ".join(drawn(volume_panel.LEAFLIGHT_PT_volume))
    return "back of this isosurface is not baked: turn on Both Sides" in texts
