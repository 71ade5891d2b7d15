# SPDX-License-Identifier: GPL-3.0-or-later
"""Has Blender compile the materials of baked light while a bake has none yet.

Blender compiles the nodes of a material when it first draws them, and draws it gray, lit by lamps
alone, until then: the first light would look worse than none. It compiles the same nodes once. So
triangles without area have the materials until the bake ends.
"""

import bpy

from . import added, display, look, shader, shader_graph
from .isosurface import RADIANCE, RADIANCE_BACK

_KIND, _NAME = "first light", "Leaflight Materials"


def prepare(volumes, both_sides, walls):
    """Has the materials compiled, once, that a bake will give to isosurfaces without light.

    volumes: the objects to bake; walls: whether their walls will be lit.
    """
    isosurfaces = [obj for volume in volumes for obj in (volume, *added.added_to(volume))]
    unlit = [obj for obj in isosurfaces if RADIANCE not in obj.data.attributes]
    if not unlit or any(map(_is_ours, bpy.data.objects)):
        return
    kinds = [(both_sides, look.view_of(obj)) for obj in unlit]
    if walls:
        kinds.append((True, shader_graph.View()))
    mesh = bpy.data.meshes.new(_NAME)
    corners = range(3 * len(kinds))
    mesh.from_pydata([(0, 0, 0) for _ in corners], [], [corners[i : i + 3] for i in corners[::3]])
    for index, (back, view) in enumerate(kinds):
        material = bpy.data.materials.new(_NAME)
        shader.build_attribute(material, RADIANCE, RADIANCE_BACK if back else None, view)
        mesh.materials.append(material)
        mesh.polygons[index].material_index = index
    obj = added.new_display(unlit[0], _KIND, _NAME, mesh)
    obj.hide_select = obj.hide_render = True
    obj.location = unlit[0].matrix_world.translation


def forget():
    """Removes what prepare() has made, and undo or a file has brought back."""
    for obj in list(filter(_is_ours, bpy.data.objects)):
        _remove(obj)


def _remove(obj):
    bpy.data.batch_remove((*obj.data.materials, obj.data, obj))


def _is_ours(obj):
    return obj.library is None and display.is_display(obj, _KIND)
