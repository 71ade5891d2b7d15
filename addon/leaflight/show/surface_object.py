# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh object that shows one isosurface of its volume, lit by its bake.

Properties of the mesh describe its surface. Undo, redo and loading restore both together, so that a
stale mesh is detected.
"""

import json
from contextlib import suppress
from dataclasses import asdict, dataclass, replace

import bpy
import numpy as np
from leaflight import LeaflightError

from .. import session
from ..store import bake_files
from ..store.reading import StillReading
from . import display, exploded, isosurface, lamps, preview, surface_material, texture
from .fill import color, fill

# Approximate limit of the triangles of a surface while its isovalue moves.
MOVING_TRIANGLES = 150_000

_SHOWN = "leaflight_shown"
_ISOVALUE = "leaflight_isovalue"
# Properties of a mesh: True if detail is missing, and the approximate number of triangles of the
# isosurface between voxels.
_COARSE = "leaflight_coarse"
_TRIANGLES = "leaflight_triangles"

# Result of made() for a surface that could not be made.
_NOTHING = np.empty((0, 3)), np.empty((0, 3)), {}, 0

# Full name of an object -> reason why its surface could not be shown, for the panel.
problems = session.cache()

# Full name of an object -> the state for which the files of its bake were found.
_looked_after = session.cache()


@dataclass(frozen=True)
class _Shown:
    """The state of a mesh.

    isosurface: Volume, shape and isovalue.
    light: The bake, or the pass.
    lamps: Strengths of the lamps, if they differ from those of the bake.
    moved: The bake of a scene with moved lamps or objects.
    failed: True if the isosurface could not be shown.
    """

    isosurface: str
    light: str
    lamps: str = ""
    moved: str = ""
    failed: bool = False

    def label(self):
        return json.dumps(asdict(self))

    @staticmethod
    def of(mesh):
        """Returns the state of a mesh.

        Returns None for a mesh without a label, or with a label of an earlier Leaflight.
        """
        try:
            return _Shown(**json.loads(label_of(mesh) or ""))
        except (ValueError, TypeError):
            return None


def create(context, volume, size):
    """Adds a mesh object for a volume to the active collection.

    Its longest side is `size` units long. Its origin is the middle of the volume, above the middle
    of the grid floor.
    """
    obj = new(context, volume.name)
    low, high = np.asarray(volume.field().bounds, np.float64)
    scale = size / float((high - low).max())
    obj.leaflight.origin = 0.5 * (low + high)
    obj.scale = (scale, scale, scale)
    obj.location = (0.0, 0.0, 0.5 * scale * (high - low)[2])
    return obj


def new(context, name):
    """Adds an empty mesh object to the active collection."""
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    context.collection.objects.link(obj)
    return obj


def update(obj, isovalue, moving=False):
    """Shows an isosurface unless the mesh already holds it. A failure goes to `problems`.

    While its bake or volume is being read, the mesh stays; the end of the reading calls again.
    moving: True if a coarse surface of about MOVING_TRIANGLES is enough for now. The full detail
    follows later (whole_detail.py).
    """
    _look_after_files(obj)
    wanted, shown = _wanted(obj, isovalue), _Shown.of(obj.data)
    if shown == wanted and (moving or not is_coarse(obj.data)):
        return
    # Try again after a failure only if its problem may be gone: after loading, undo or relocating.
    if shown == replace(wanted, failed=True) and obj.name_full in problems:
        return
    if obj.library is not None:
        problems[obj.name_full] = (
            f'"{obj.name}" is linked from another file and shows the isovalue that was saved '
            "there: make a library override of it to change or animate it."
        )
        return
    problems.pop(obj.name_full, None)
    surface, made = None, _NOTHING
    try:
        halvings = _halvings_in_motion(obj, isovalue) if moving else None
        surface = isosurface.isosurface_of(obj, isovalue, halvings)
        # Lighting and drawing all vertices takes longer than making a coarse surface.
        wants_coarse = bool(moving and halvings and wanted.moved)
        if surface.grid is not None and _serves(obj.data, shown, wanted, wants_coarse):
            _color(obj, wanted.label(), surface)
            return
        made = surface.made()
        # Raise the error of a bake that could not be read.
        isosurface.is_lit(obj, isovalue)
    except StillReading:
        return
    except LeaflightError as error:
        problems[obj.name_full] = str(error)
        wanted = replace(wanted, failed=True)
    _put(obj, wanted.label(), isovalue, surface, made)


def _serves(mesh, shown, wanted, coarse):
    """True if the wanted state differs from that of a mesh only in its light.

    coarse: True if the vertices of a coarse isosurface are wanted.
    """
    if shown is None or shown.failed or shown.isosurface != wanted.isosurface:
        return False
    if is_coarse(mesh) != coarse:
        return False
    # The light of a moved scene is temporary, so a mesh that was split for other light will do.
    return bool(wanted.moved) or shown.light == wanted.light


def _color(obj, label, surface):
    """Gives the present vertices of an object's mesh the light of an Isosurface."""
    _own_mesh(obj)
    mesh = obj.data
    for name, radiance in surface.radiance(exploded.closed_positions(mesh)).items():
        color(mesh, name, radiance)
    mesh[_SHOWN] = label
    mesh.update()
    shade(obj)


def update_all(volume, moving=False, as_coarse=False):
    """Shows a volume's isosurface and the added isosurfaces with their present light.

    moving: see update(). as_coarse: True if coarse surfaces may stay coarse.
    """
    for obj in display.surfaces_of(volume):
        update(obj, shown_isovalue(obj), moving or (as_coarse and is_coarse(obj.data)))


def coarsen_all(volume):
    """Reduces a volume's isosurfaces to the detail that they have while an isovalue moves.

    The full detail follows later, as after a move. The next update reports failures.
    """
    for obj in display.surfaces_of(volume):
        if is_coarse(obj.data) or obj.library is not None or obj.mode != "OBJECT":
            continue
        with suppress(LeaflightError):
            halvings = _halvings_in_motion(obj, shown_isovalue(obj))
            if halvings:
                surface = isosurface.isosurface_of(obj, shown_isovalue(obj), halvings)
                finish(obj, surface, surface.made())


def finish(obj, surface, made):
    """Replaces the mesh of an object by an Isosurface of other detail, which was made before."""
    _put(obj, label_of(obj.data), surface.isovalue, surface, made)


def is_coarse(mesh):
    """True if a mesh has less than the full detail of its isosurface."""
    return bool(mesh.get(_COARSE))


def _halvings_in_motion(obj, isovalue):
    """Returns how often to halve the detail of a moving isosurface. Raises LeaflightError."""
    triangles, halvings = obj.data.get(_TRIANGLES, 0), 0
    if shown_isovalue(obj) != isovalue or not triangles:
        estimate = isosurface.estimate_triangles(isosurface.volume_of(obj), isovalue)
        # Prefer the count of a near isosurface, unless one of the two is noise with many more.
        if not 0.25 * estimate < triangles < 4.0 * estimate:
            triangles = estimate
    while triangles > MOVING_TRIANGLES:
        triangles, halvings = triangles // 4, halvings + 1
    return halvings


def _put(obj, label, isovalue, surface, made):
    """Fills the mesh of an object with the result of Isosurface.made(), or with nothing."""
    _own_mesh(obj)
    mesh = obj.data
    vertices, triangles, radiance, count = made
    offsets = radiance.pop(isosurface.OFFSETS, None)
    fill(mesh, vertices, triangles, radiance)
    distance = display.volume_object(obj).leaflight_look.explode_distance
    exploded.store(mesh, vertices, offsets, distance)
    mesh[_SHOWN] = label
    mesh[_ISOVALUE] = isovalue
    mesh[_COARSE] = surface is not None and surface.is_coarse()
    mesh[_TRIANGLES] = count
    shade(obj)


def explode(obj, distance):
    """Moves the parts of an isosurface apart by a distance, unless they are."""
    if obj.library is None and not exploded.is_at(obj.data, distance):
        _own_mesh(obj)
        exploded.move(obj.data, distance)


def forget():
    """Makes the next updates find the files of all bakes again, after undo or saving."""
    _looked_after.clear()


def _look_after_files(obj):
    """Finds the files of an object's bake and atlases, once for each state."""
    volume = display.volume_object(obj)
    settings = volume.leaflight
    state = (settings.bake_id, settings.bake_index, settings.bake_path, bpy.data.filepath)
    if not settings.bake_id or _looked_after.get(obj.name_full) == state:
        return
    problems.pop(obj.name_full, None)
    try:
        path = bake_files.locate(volume)
        bake_files.remember(volume, path)
        surface_material.look_after_images(obj, path)
    except LeaflightError as error:
        problems[obj.name_full] = str(error)
        return
    _looked_after[obj.name_full] = (*state[:2], settings.bake_path, state[3])


def _own_mesh(obj):
    """Gives a linked duplicate or a library override a separate mesh before it is changed.

    They share a mesh while they show the same surface.
    """
    mesh = obj.data
    if mesh.library is None and mesh.users < 2:
        return
    others = (other for other in bpy.data.objects if other != obj and other.data == mesh)
    if mesh.library is not None or any(other.leaflight.is_volume for other in others):
        obj.data = mesh.copy()


def shown_isovalue(obj):
    """Returns the isovalue of an object's mesh, or that of its settings before the first mesh."""
    return obj.data.get(_ISOVALUE, obj.leaflight.isovalue)


def label_of(mesh):
    """Returns a key of the surface and light in a mesh, None before the first surface."""
    return mesh.get(_SHOWN)


def mark_shown(mesh, other):
    """Copies the state of another mesh, so that no update replaces this one."""
    mesh[_SHOWN], mesh[_ISOVALUE] = other[_SHOWN], other[_ISOVALUE]


def shade(obj):
    """Gives an object the material for its state: baked radiance, or unlit.

    A material that the user has chosen stays, and any while the bake is being read. A failure goes
    to `problems`.
    """
    current = obj.data.materials[0] if obj.data.materials else None
    if not surface_material.may_replace(obj, current):
        return
    try:
        material = surface_material.material_of(obj, shown_isovalue(obj))
    except StillReading:
        return
    except LeaflightError as error:
        problems[obj.name_full] = str(error)
        return
    if not obj.data.materials:
        obj.data.materials.append(material)
    elif current != material:
        _own_mesh(obj)
        obj.data.materials[0] = material


def shade_all(volume):
    """Calls shade() for a volume and its added isosurfaces."""
    for obj in display.surfaces_of(volume):
        shade(obj)


def forget_passes():
    """Shows objects without the passes of a bake: lit by their last bake, or unlit."""
    for name in preview.forget():
        obj = next((obj for obj in bpy.data.objects if obj.name_full == name), None)
        if obj is None or not obj.leaflight.is_volume:
            continue
        update_all(obj)
        if not obj.leaflight.bake_id:
            for each in display.surfaces_of(obj):
                surface_material.remove_baked(each)


def _wanted(obj, isovalue):
    """Returns the _Shown of an up-to-date mesh of an object."""
    volume_object = display.volume_object(obj)
    settings = volume_object.leaflight
    part = f"{settings.frame} {settings.channel} {settings.level} {settings.dataset}"
    smooth = f"{settings.smooth} {settings.smooth_normals}"
    shape = f"{smooth} {settings.regions} {settings.capped} {obj.leaflight_look.dust}"
    volume = f"{settings.source} {part} {settings.downsample} {shape}"
    volume += texture.label_of(volume_object)
    volume += f" without {settings.hide}" if settings.hide else ""
    axis = volume_object.leaflight_look.explode_axis
    volume += f" apart along {axis}" if axis != exploded.CLOSED else ""
    isosurface, seen = f"{isovalue!r} of {volume}", preview.of(volume_object)
    if seen is None:
        light = f"{settings.bake_id} {settings.bake_index}"
        return _Shown(isosurface, light, lamps=lamps.label(settings))
    if seen.bake.is_moved:
        return _Shown(isosurface, f"{seen.bake.original.id} {seen.index}", moved=seen.bake.id)
    return _Shown(isosurface, f"pass {seen.bake.id} {seen.index}")
