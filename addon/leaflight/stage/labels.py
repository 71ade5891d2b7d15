# SPDX-License-Identifier: GPL-3.0-or-later
"""A scale bar, and letters for a patient's sides: objects that render and that no bake sees."""

import bpy
import numpy as np
from leaflight import LeaflightError
from mathutils import Matrix

from .. import versions
from ..show import added, display, shader
from ..store import cache, source_files

_BAR, _LETTER = "scale bar", "letter"
# Right, left, front, back, up and down in a patient's coordinates: (letter, axis, direction).
SIDES = (("R", 0, 1), ("L", 0, -1), ("A", 1, 1), ("P", 1, -1), ("S", 2, 1), ("I", 2, -1))
# Shares of the volume's longest side.
_TEXT, _GAP, _LENGTH, _WIDTH = 0.06, 0.06, 0.3, 0.008
_WHITE = (0.9, 0.9, 0.9)


def add_scale_bar(context, volume):
    """A bar before the volume's lower edge with its length. Raises LeaflightError."""
    unit = volume.leaflight.unit
    if not unit:
        raise LeaflightError(
            f"{volume.leaflight.source or volume.name}: the file gives no unit of length; choose "
            "one under Scale and Labels."
        )
    _remove(volume, _BAR)
    low, high, side = _box(volume)
    length = round_length(_LENGTH * side)
    across, deep = _axes(context, volume)
    width = _WIDTH * side
    start = np.array(low, np.float64)
    start[deep[0]] = (low if deep[1] < 0 else high)[deep[0]] + deep[1] * _GAP * side
    start[across] = 0.5 * (low + high - length)[across]
    size = np.full(3, width)
    size[across] = length
    bar = _object(volume, _BAR, "Scale Bar", _cuboid(start, start + size))
    text = _text(context, volume, _BAR, f"{length:g} {unit}", _TEXT * side)
    text.location = start + 0.5 * size + np.array([0.0, 0.0, 0.5 * _TEXT * side + width])
    return bar


def add_letters(context, volume):
    """R, L, A, P, S and I beside the volume. Raises LeaflightError."""
    if not source_files.is_patient(volume.leaflight):
        raise LeaflightError(
            f"{volume.leaflight.source or volume.name}: the file does not say where a patient's "
            "right, front and up are."
        )
    _remove(volume, _LETTER)
    low, high, side = _box(volume)
    for letter, axis, direction in SIDES:
        place = 0.5 * (low + high)
        place[axis] = (high if direction > 0 else low)[axis] + direction * _GAP * side
        _text(context, volume, _LETTER, letter, _TEXT * side).location = place


def round_length(length):
    """The greatest of 1, 2 or 5 times a power of ten that is not longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(n * power for n in (1, 2, 5) if n * power <= length * (1 + 1e-9)))


def _box(volume):
    """Lowest and highest corner in the object's coordinates, and the longest side."""
    low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)
    return low, high, float((high - low).max())


def _axes(context, volume):
    """The axis that runs across the camera's picture, and (axis, direction) towards the camera."""
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
    curve = bpy.data.curves.new(words, "FONT")
    curve.body, curve.size = words, size
    curve.align_x = curve.align_y = "CENTER"
    obj = _object(volume, kind, words, curve)
    if context.scene.camera is not None:
        obj.constraints.new("COPY_ROTATION").target = context.scene.camera
    return obj


def _object(volume, kind, name, data):
    obj = added.new_display(volume, kind, name, data)
    obj.parent = volume
    obj.matrix_parent_inverse = Matrix()
    data.materials.append(_material())
    return obj


def _material():
    name = "Leaflight Label"
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        versions.do_not_sample_as_light(material)
        shader.build_emission(material, exposed(_WHITE))
    return material


def exposed(color):
    """The radiance that shows as a color with the scene's exposure."""
    exposure = bpy.context.scene.view_settings.exposure
    return tuple(2.0**-exposure * x for x in color)


def _remove(volume, kind):
    for obj in [obj for obj in volume.children if display.is_display(obj, kind)]:
        bpy.data.objects.remove(obj)
