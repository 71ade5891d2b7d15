# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of Blender's meshes, and of objects that convert to meshes, as walls of the bake."""

from dataclasses import replace

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.scene import Mesh

from ..show import fill
from . import images, materials


def export_meshes(obj, matrix, warnings):
    """Returns one Mesh per used material slot of an evaluated object with its modifiers.

    matrix: (4, 4), object to world. warnings: a list to which sentences are added. Raises
    LeaflightError.
    """
    mesh = obj.to_mesh()
    try:
        mesh.calc_loop_triangles()
        if not mesh.loop_triangles:
            return []
        # Swap corners if the object's scale mirrors: normals define the inside of glass.
        axes = np.array(matrix, np.float64)
        order = (0, 2, 1) if np.linalg.det(axes[:3, :3]) < 0 else (0, 1, 2)
        slots = _triangle_slots(obj, mesh)
        surfaces = {index: _surface(obj, index, warnings) for index in np.unique(slots)}
        whole = _whole(obj, mesh, axes, order)
        corners = {index: _uv(obj, mesh, surface, order) for index, surface in surfaces.items()}
        if any(surface.scattering != "diffuse" for surface in surfaces.values()):
            _warn_of_smoothness(obj, mesh, warnings)
    finally:
        obj.to_mesh_clear()
    parts = []
    for index, surface in surfaces.items():
        part = _part(whole, slots == index)
        texture = uv = None
        if surface.picture is not None:
            what = f'Material "{obj.material_slots[index].material.name}" of "{obj.name}"'
            texture = images.linear_pixels(what, surface.picture.image)
            uv = np.ascontiguousarray(corners[index][slots == index])
            _check_extension(what, surface.picture, uv)
        parts.append(
            replace(
                part,
                albedo=surface.albedo,
                scattering=surface.scattering,
                ior=surface.ior,
                emission=surface.emission,
                texture=texture,
                uv=uv,
            )
        )
    return parts


def _triangle_slots(obj, mesh):
    slots = fill.read(mesh.loop_triangles, "material_index", np.int32)
    # Blender renders an index beyond the slots with the last slot.
    return np.clip(slots, 0, max(len(obj.material_slots) - 1, 0))


def _surface(obj, index, warnings):
    material = obj.material_slots[index].material if obj.material_slots else None
    surface = materials.surface_of(obj.name, material)
    warnings += [warning for warning in surface.warnings if warning not in warnings]
    return surface


def _whole(obj, mesh, axes, order):
    vertices = fill.read(mesh.vertices, "co", np.float32, 3)
    triangles = fill.read(mesh.loop_triangles, "vertices", np.int32, 3)[:, order].astype(np.uint32)
    world = vertices @ axes[:3, :3].T + axes[:3, 3]
    return Mesh(obj.name, world.astype(np.float32), triangles, materials.DEFAULT_ALBEDO)


def _part(mesh, chosen):
    used, renumbered = np.unique(mesh.triangles[chosen], return_inverse=True)
    return replace(
        mesh,
        vertices=np.ascontiguousarray(mesh.vertices[used]),
        triangles=np.ascontiguousarray(renumbered.reshape(-1, 3), np.uint32),
    )


def _uv(obj, mesh, surface, order):
    """Returns the UV coordinates (triangles, 3, 2) of the surface's picture, None without one."""
    picture = surface.picture
    if picture is None:
        return None
    layer = mesh.uv_layers.get(picture.uv_map) if picture.uv_map else None
    if not picture.uv_map:
        layer = next((known for known in mesh.uv_layers if known.active_render), None)
    if layer is None:
        wanted = f' called "{picture.uv_map}"' if picture.uv_map else ""
        raise LeaflightError(
            f'"{obj.name}" has an image as its color but no UV map{wanted}: unwrap it, or choose a '
            "color."
        )
    loops = fill.read(mesh.loop_triangles, "loops", np.int32, 3).ravel()
    points = np.zeros((len(loops), 4))
    points[:, :2] = fill.read(layer.data, "uv", np.float32, 2)[loops]
    points[:, 3] = 1.0
    mapped = (points @ picture.uv_matrix.T)[:, :2].astype(np.float32)
    return mapped.reshape(-1, 3, 2)[:, order]


def _check_extension(what, picture, uv):
    if not picture.repeats and (uv.min() < -1e-4 or uv.max() > 1 + 1e-4):
        raise LeaflightError(
            f"{what} has UVs outside 0 to 1 and an extension other than Repeat, which the bake "
            "cannot model: set it to Repeat, or move the UVs."
        )


def _warn_of_smoothness(obj, mesh, warnings):
    if fill.read(mesh.polygons, "use_smooth", bool).any():
        warnings.append(
            f'"{obj.name}" reflects or refracts with smooth shading but is baked with its flat '
            "facets: use a finer mesh, or shade it flat for a match"
        )
