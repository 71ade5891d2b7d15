# SPDX-License-Identifier: GPL-3.0-or-later
"""Labels of a volume: a scale bar, letters for a patient's sides, orientation cube and color bar.

The cube and the color bar are at the border of the camera's picture. The cube rotates with the
volume. Labels are objects that render and that bakes ignore.
"""

import bpy
import numpy as np
from leaflight import LeaflightError
from mathutils import Matrix, Vector

from ..operators import checks
from ..operators.checks import active_volume
from ..show import color_bar, display, label_parts, texture
from ..show.display import LETTER, SCALE_BAR
from ..store import cache, source_files

# Sides of a patient as (letter, axis, direction): right, left, front, back, up and down.
SIDES = (("R", 0, 1), ("L", 0, -1), ("A", 1, 1), ("P", 1, -1), ("S", 2, 1), ("I", 2, -1))
# Sizes of labels, as shares of the volume's longest side.
_TEXT, _GAP, _LENGTH, _WIDTH = 0.06, 0.06, 0.3, 0.008


def add_scale_bar(context, volume):
    """Adds a bar with its length in front of the volume's lower edge. Raises LeaflightError."""
    unit = volume.leaflight.unit
    if not unit:
        raise LeaflightError(
            f"{volume.leaflight.source or volume.name}: the file gives no unit of length; choose "
            "one under Scale and Labels."
        )
    low, high, side = _box(volume)
    _remove(volume, SCALE_BAR)
    length = round_length(_LENGTH * side)
    across, deep = _axes(context, volume)
    width = _WIDTH * side
    start = np.array(low, np.float64)
    start[deep[0]] = (low if deep[1] < 0 else high)[deep[0]] + deep[1] * _GAP * side
    start[across] = 0.5 * (low + high - length)[across]
    size = np.full(3, width)
    size[across] = length
    bar = _object(volume, SCALE_BAR, "Scale Bar", _cuboid(start, start + size))
    text = _text(context, volume, SCALE_BAR, f"{length:g} {unit}", _TEXT * side)
    text.location = start + 0.5 * size + np.array([0.0, 0.0, 0.5 * _TEXT * side + width])
    return bar


def add_letters(context, volume):
    """Adds R, L, A, P, S and I beside the volume. Raises LeaflightError."""
    if not source_files.is_patient(volume.leaflight):
        raise LeaflightError(
            f"{volume.leaflight.source or volume.name}: the file has no directions of a patient: "
            "choose Up and Front under Stage."
        )
    low, high, side = _box(volume)
    _remove(volume, LETTER)
    for letter, axis, direction in SIDES:
        place = 0.5 * (low + high)
        place[axis] = (high if direction > 0 else low)[axis] + direction * _GAP * side
        _text(context, volume, LETTER, letter, _TEXT * side).location = place


def round_length(length):
    """Returns the greatest 1, 2 or 5 times a power of ten up to this length."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(n * power for n in (1, 2, 5) if n * power <= length * (1 + 1e-9)))


def _box(volume):
    """Returns the lowest and highest corner in the object's coordinates, and the longest side."""
    low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)
    return low, high, float((high - low).max())


def _axes(context, volume):
    """Returns the axis across the camera's picture, and (axis, direction) to the camera."""
    camera = context.scene.camera
    if camera is None:
        return 0, (1, -1)
    turned = np.array((volume.matrix_world.to_3x3().inverted() @ camera.matrix_world.to_3x3()))
    across = int(np.argmax(np.abs(turned[:2, 0])))
    deep = 1 - across
    return across, (deep, 1 if turned[deep, 2] > 0 else -1)


def _cuboid(low, high):
    corners = [[x, y, z] for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (0, 1)]
    corners = [[(low, high)[x][0], y, z] for x, y, z in corners]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    mesh = bpy.data.meshes.new("Scale Bar")
    mesh.from_pydata(corners, [], quads)
    return mesh


def _text(context, volume, kind, words, size):
    obj = _object(volume, kind, words, label_parts.text_curve(words, size))
    if context.scene.camera is not None:
        obj.constraints.new("COPY_ROTATION").target = context.scene.camera
    return obj


def _object(volume, kind, name, data):
    obj = display.new_display(volume, kind, name, data)
    obj.parent = obj[display.VOLUME] = volume
    data.materials.append(label_parts.white_material())
    return obj


def _remove(volume, kind):
    for obj in [obj for obj in volume.children if display.is_display(obj, kind)]:
        bpy.data.objects.remove(obj)


_CUBE = "orientation cube"
# Names of the cube's sides along +x, -x, +y, -y, +z and -z.
_OF_A_PATIENT = tuple(letter for letter, _, _ in SIDES)
_OF_OTHERS = ("X", "-X", "Y", "-Y", "Z", "-Z")
# Gray values of the sides across x, y and z, different so that edges are visible, and of letters.
_GRAYS, _DARK = (0.1, 0.2, 0.4), 0.002
# Edge of the cube and its distance from the picture's borders, as shares of the picture's height.
_EDGE, _MARGIN = 0.09, 0.04


def add_cube(context, volume):
    """Adds the cube to the camera's picture, in place of an earlier one. Raises LeaflightError."""
    camera = context.scene.camera
    if camera is None:
        raise LeaflightError("The scene has no camera for the cube: add one, or use Stage.")
    is_patient = source_files.is_patient(volume.leaflight)
    names = _OF_A_PATIENT if is_patient else _OF_OTHERS
    for obj in [obj for obj in camera.children if display.is_display(obj, _CUBE)]:
        for part in (*obj.children, obj):
            bpy.data.objects.remove(part)
    corner, opposite = label_parts.picture_corners(context.scene, camera)
    height = opposite.y - corner.y
    edge = _EDGE * height
    cube = _cube_object(volume, "Orientation Cube", _cube_mesh(edge), _GRAYS)
    cube.parent = camera
    # Half of the cube's diagonal and the margin from two borders of the picture.
    cube.location = corner + (0.5 * 3**0.5 * edge + _MARGIN * height) * Vector((1, 1, 0))
    cube.constraints.new("COPY_ROTATION").target = volume
    for side, name in enumerate(names):
        letter = _cube_object(
            volume, f"Orientation {name}", label_parts.text_curve(name, 0.8 * edge), (_DARK,)
        )
        letter.parent = cube
        letter.matrix_local = _on_side(side, 0.51 * edge)
    return cube


def _on_side(side, distance):
    """Returns the matrix of a text that is upright on a side and readable from outside."""
    axis, sign = side // 2, 1 - 2 * (side % 2)
    out = Vector([sign * (a == axis) for a in range(3)])
    up = Vector((0, 0, 1)) if axis < 2 else Vector((0, 1, 0))
    matrix = Matrix((up.cross(out), up, out)).transposed().to_4x4()
    matrix.translation = distance * out
    return matrix


def _cube_mesh(edge):
    mesh = bpy.data.meshes.new("Orientation Cube")
    ends = 0.5 * edge * np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    sides = [(1, 3, 7, 5), (0, 4, 6, 2), (2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6), (0, 2, 3, 1)]
    mesh.from_pydata(ends.tolist(), [], sides)
    for side, polygon in enumerate(mesh.polygons):
        polygon.material_index = side // 2
    return mesh


def _cube_object(volume, name, data, grays):
    obj = display.new_display(volume, _CUBE, name, data)
    obj.hide_select = True
    for gray in grays:
        data.materials.append(label_parts.gray_material(name, gray))
    return obj


class LEAFLIGHT_OT_add_scale_bar(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Scale Bar"
    bl_description = (
        "Add a scale bar of a round length in front of the volume, in the unit of its file"
    )

    conditions = (
        *checks.VOLUME,
        checks.volume_needs(
            lambda volume: volume.leaflight.unit, "Choose the unit of length first"
        ),
    )

    def run(self, context):
        add_scale_bar(context, active_volume(context))


class LEAFLIGHT_OT_add_letters(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Orientation"
    bl_description = (
        "Add letters at the sides of a patient: R and L for right and left, A and P for "
        "front and back, S and I for up and down"
    )

    def run(self, context):
        add_letters(context, active_volume(context))


class LEAFLIGHT_OT_add_orientation_cube(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Orientation Cube"
    bl_description = (
        "Add a cube to the lower left corner of the camera view. It turns with the volume "
        "and names the patient's sides"
    )

    def run(self, context):
        add_cube(context, active_volume(context))


class LEAFLIGHT_OT_add_color_bar(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Color Bar"
    bl_description = (
        "Add the colors and their values to the right of the camera view. "
        "They follow later changes of the color map and its range"
    )

    conditions = (
        *checks.VOLUME,
        checks.volume_needs(
            texture.is_colored,
            "Choose the values that color the isosurfaces first, under Isosurfaces",
        ),
    )

    def run(self, context):
        color_bar.add(context.scene, active_volume(context))
