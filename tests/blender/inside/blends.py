# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers for checks of files: save, open, and whether an object shows its bake."""

import bpy
import leaflight
import numpy as np
from leaflight_addon.show import surface_object
from leaflight_addon.store import bake_files, cache
from tools import close, colors_of, mesh_arrays


def open_saved(blend, bake=False):
    blend.parent.mkdir(parents=True, exist_ok=True)
    save(blend)
    if bake:
        bpy.ops.leaflight.bake()
        save(blend)
    return volume_object()


def save(blend, **options):
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), **options)


def open_blend(blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    return volume_object()


def reopened(blend):
    save(blend)
    return open_blend(blend)


def volume_object():
    (obj,) = [o for o in bpy.data.objects if o.leaflight.is_volume]
    bpy.context.view_layer.objects.active = obj
    return obj


def brighten(factor=2.0):
    """Brightens the lamp and moves it. Earlier bakes cannot be relit for a moved lamp."""
    lamp = bpy.data.objects["lamp"]
    lamp.data.energy *= factor
    lamp.location.z -= 0.01
    bpy.context.view_layer.update()


def images_of(obj):
    nodes = obj.data.materials[0].node_tree.nodes
    return {node.image for node in nodes if node.type == "TEX_IMAGE"}


def pixels_of(image):
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)[..., :3]


def assert_lit(obj, isovalue=None):
    """Checks that mesh and image show the bake of the object's file, without a problem."""
    assert obj.name_full not in surface_object.problems
    bake = leaflight.load_bake(bake_files.locate(obj))
    assert bake.id == obj.leaflight.bake_id
    grid = bake.grids[obj.leaflight.bake_index]
    vertices, _, radiance = mesh_arrays(obj)
    assert len(vertices) > 100
    expected = grid.lookup(cache.volume_of(obj).field(), vertices)
    # The file stores half precision.
    close(radiance, expected, 2e-3 * expected.max())
    if obj.leaflight.shading == "ATLAS":
        (image,) = images_of(obj)
        atlas = grid.atlas()[0][..., :3]
        close(pixels_of(image), atlas, 2e-3 * atlas.max())
    if isovalue is not None:
        assert obj.leaflight.isovalue == isovalue


def mean_radiance(obj):
    return float(colors_of(obj).mean())
