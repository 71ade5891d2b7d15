# SPDX-License-Identifier: GPL-3.0-or-later
"""A cube in the corner of the camera's picture that turns as a volume does, with its axes' names.

It renders, and no bake sees it.
"""

import bpy
import numpy as np
from leaflight import LeaflightError
from mathutils import Matrix, Vector

from .. import versions
from ..show import added, display, shader
from ..store import source_files
from .labels import SIDES, exposed

_KIND = "orientation cube"
# Along +x, -x, +y, -y, +z and -z.
_OF_A_PATIENT = tuple(letter for letter, _, _ in SIDES)
_OF_OTHERS = ("X", "-X", "Y", "-Y", "Z", "-Z")
# Of the sides across x, y and z, so that their edges are seen; of the letters.
_GRAYS, _DARK = (0.1, 0.2, 0.4), 0.002
# Shares of the height of the picture: an edge, and its distance from the picture's borders.
_EDGE, _MARGIN = 0.09, 0.04
# From the camera, as a multiple of where it begins to see.
_DISTANCE = 4.0


def add_cube(context, volume):
    """Puts the cube into the camera's picture, for an earlier one. Raises LeaflightError."""
    camera = context.scene.camera
    if camera is None:
        raise LeaflightError(
            "The scene has no camera, in whose picture the cube would stand: stage it first."
        )
    is_patient = source_files.is_patient(volume.leaflight)
    names = _OF_A_PATIENT if is_patient else _OF_OTHERS
    for obj in [obj for obj in camera.children if display.is_display(obj, _KIND)]:
        for part in (*obj.children, obj):
            bpy.data.objects.remove(part)
    corner, height = _picture(context.scene, camera)
    edge = _EDGE * height
    cube = _object(volume, "Orientation Cube", _mesh(edge), _GRAYS)
    cube.parent, cube.matrix_parent_inverse = camera, Matrix()
    # Half of its diagonal and the margin from two borders of the picture.
    cube.location = corner + (0.5 * 3**0.5 * edge + _MARGIN * height) * Vector((1, 1, 0))
    cube.constraints.new("COPY_ROTATION").target = volume
    for side, name in enumerate(names):
        letter = _object(volume, f"Orientation {name}", _text(name, 0.8 * edge), (_DARK,))
        letter.parent, letter.matrix_parent_inverse = cube, Matrix()
        letter.matrix_local = _on_side(side, 0.51 * edge)
    return cube


def _picture(scene, camera):
    """The lower left corner of the picture in the camera's coordinates, and its height there."""
    distance = _DISTANCE * camera.data.clip_start
    frame = np.array(camera.data.view_frame(scene=scene))
    if camera.data.type == "PERSP":
        frame *= distance / -frame[0, 2]
    frame[:, 2] = -distance
    return Vector(frame.min(axis=0)), float(np.ptp(frame[:, 1]))


def _on_side(side, distance):
    """Where a text lies that is upright on a side and is read from outside."""
    axis, sign = side // 2, 1 - 2 * (side % 2)
    out = Vector([sign * (a == axis) for a in range(3)])
    up = Vector((0, 0, 1)) if axis < 2 else Vector((0, 1, 0))
    matrix = Matrix((up.cross(out), up, out)).transposed().to_4x4()
    matrix.translation = distance * out
    return matrix


def _mesh(edge):
    mesh = bpy.data.meshes.new("Orientation Cube")
    ends = 0.5 * edge * np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    sides = [(1, 3, 7, 5), (0, 4, 6, 2), (2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6), (0, 2, 3, 1)]
    mesh.from_pydata(ends.tolist(), [], sides)
    for side, polygon in enumerate(mesh.polygons):
        polygon.material_index = side // 2
    return mesh


def _text(name, size):
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.size = name, size
    curve.align_x = curve.align_y = "CENTER"
    return curve


def _object(volume, name, data, grays):
    obj = added.new_display(volume, _KIND, name, data)
    obj.hide_select = True
    for gray in grays:
        material = bpy.data.materials.new(name)
        versions.do_not_sample_as_light(material)
        shader.build_emission(material, exposed((gray,) * 3))
        data.materials.append(material)
    return obj
