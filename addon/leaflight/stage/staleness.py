# SPDX-License-Identifier: GPL-3.0-or-later
"""The check for changes of the scene since the bake.

It exports and hashes the whole scene: at a call, or, for panels, when nothing has changed for a
moment. It never runs while a panel draws or an isovalue moves.
"""

import dataclasses
import time
from numbers import Real

import bpy
import numpy as np
from leaflight import LeaflightError

from .. import session
from ..operators import jobs
from ..show import lamps
from ..store import bake_files, source_files
from ..store.reading import StillReading
from . import lights, scene_export

_OTHER = "The bake was made for another scene: bake again to light this one"
_CHANGED = "The scene has changed since the bake: bake again"
CUT = "Cuts, parts or masks have changed since the bake: bake again"
# Results of change_since_bake() if the volumes are those of the bake, but the scene is not.
OF_THE_SCENE = (_OTHER, _CHANGED)

# Fingerprint of a bake that was loaded into another scene.
OTHER_SCENE = "another scene"

# Seconds without a change before panels are redrawn.
PAUSE = 0.5

# Cache, until the next change: (full name of an object, its bake) -> result of change_since_bake().
_changes = session.cache()
# Full name of an object -> its world matrix at the last check.
_places = session.cache()

# Results as panels show them, perhaps from before the last change. Names of the objects whose
# panels are drawn.
_shown = session.cache()
_wanted = session.cache(set)
_changed_at = 0.0


def forget():
    """Clears the cached results after any change of the scene."""
    global _changed_at
    _changes.clear()
    _changed_at = time.monotonic()


def stands_elsewhere(obj):
    """True if an object has moved since the last check of change_since_bake()."""
    place = _places.get(obj.name_full)
    return place is not None and place != obj.matrix_world


def change_since_bake(context, obj):
    """Returns a sentence if the scene or the volume's file differs from the bake, or "".

    Returns a sentence, too, if the file of the bake cannot be found. While a volume of the scene is
    being read, the last result counts: the end of the reading calls forget().
    """
    key = _key(obj)
    if key not in _changes:
        _places[obj.name_full] = obj.matrix_world.copy()
        _changes[key] = _shown[key] = _change(context, obj)
    return _changes[key]


def known_change(obj):
    """Returns the cached result of change_since_bake(), or "" after any change of the scene."""
    return _changes.get(_key(obj), "")


def change_to_show(obj):
    """Returns the last result of change_since_bake(), for panels.

    Starts a check if the scene may have changed. Panels are redrawn if the result changes.
    """
    if _key(obj) not in _changes and not bpy.app.background:
        _wanted.add(obj.name_full)
        if not bpy.app.timers.is_registered(_look):
            bpy.app.timers.register(_look, first_interval=PAUSE)
    return _shown.get(_key(obj), "")


def _key(obj):
    """Returns a key with the bake, because each frame of a volume has another bake."""
    return obj.name_full, obj.leaflight.bake_id


def _look():
    quiet = time.monotonic() - _changed_at
    if quiet < PAUSE:
        return PAUSE - quiet
    wanted = [obj for obj in bpy.context.scene.objects if obj.name_full in _wanted]
    _wanted.clear()
    before = dict(_shown)
    for obj in wanted:
        change_since_bake(bpy.context, obj)
    if _shown != before:
        jobs.redraw_panels()
    return None


def _change(context, obj):
    try:
        bake_files.locate(obj)
    except LeaflightError as error:
        return str(error)
    if source_files.regions_alone_changed(obj.leaflight):
        return CUT
    if source_files.values_changed(obj.leaflight):
        return "Smooth or hidden labels have changed since the bake: bake again"
    if source_files.changed_since_bake(obj):
        files = " or ".join(source_files.files_of(obj.leaflight))
        return f"The values in {files} have changed since the bake: bake again"
    try:
        description, volumes, _ = scene_export.export_scene(context, obj)
        now = scene_export.fingerprint(volumes, description)
    except StillReading:
        return _shown.get(_key(obj), "")
    except LeaflightError as error:
        return f"The scene has changed since the bake: {error}"
    if obj.leaflight.bake_fingerprint == OTHER_SCENE:
        return _OTHER
    if now != obj.leaflight.bake_fingerprint and not _is_relit(obj, volumes, description):
        return _CHANGED
    return ""


def _is_relit(obj, volumes, description):
    """True if only the strengths and colors of lamps have changed, which relighting shows."""
    lights = lamps.as_baked(obj.leaflight, description.lights)
    if lights is None or not lamps.factors_of(obj.leaflight):
        return False
    before = dataclasses.replace(description, lights=lights)
    return scene_export.fingerprint(volumes, before) == obj.leaflight.bake_fingerprint


# Relative tolerance of a few products in single precision.
_TOLERANCE = 1e-4

# Fields that is_same() ignores: names, sources, and those that follow from the bake's range.
_UNSEEN = {"name", "source", "reading", "coordinates", "isovalues"}


def is_same(a, b):
    """True if plain data are equal except for names, rounding and the order of objects."""
    if dataclasses.is_dataclass(a) and dataclasses.is_dataclass(b):
        return type(a) is type(b) and all(
            is_same(getattr(a, part.name), getattr(b, part.name)) for part in _parts(a)
        )
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)) and len(a) == len(b):
        if any(dataclasses.is_dataclass(item) for item in a):
            return _same_members(a, b)
        return all(is_same(x, y) for x, y in zip(a, b))
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and _close(a, b)
    if isinstance(a, Real) and isinstance(b, Real):
        return _close(a, b)
    return type(a) is type(b) and a == b


def in_order(a, b):
    """Returns the members of a in the order of their equals in b, which has as many."""
    return [next(item for item in a if is_same(item, other)) for other in b]


def _parts(description):
    # Only glass has an index of refraction.
    unseen = _UNSEEN | (
        {"ior"} if getattr(description, "scattering", "glass") != "glass" else set()
    )
    return [part for part in dataclasses.fields(description) if part.name not in unseen]


def _same_members(a, b):
    """True if a and b have equal members in any order."""
    left = list(b)
    for item in a:
        like = next((other for other in left if is_same(item, other)), None)
        if like is None:
            return False
        left.remove(like)
    return True


def _close(a, b):
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    scale = max(1e-30, np.abs(a).max(initial=0), np.abs(b).max(initial=0))
    return bool(np.abs(a - b).max(initial=0) <= _TOLERANCE * scale)


def follow_lamps(scene, depsgraph):
    """Relights bakes for the evaluated lamps. Returns True if a bake must be shown again."""
    volumes = [obj for obj in scene.objects if obj.leaflight.is_volume and obj.leaflight.bake_lamps]
    if not volumes:
        return False
    try:
        present = [light for light in _present_lamps(depsgraph) if light is not None]
    except LeaflightError:
        # The panel reports lamps that cannot be baked.
        present = None
    if present is None:
        return False
    # In a scene without any lamp, show volumes as they were baked.
    has_lamps = any(obj.type == "LIGHT" for obj in scene.objects)
    found = [lamps.follow(obj.leaflight, present if has_lamps else None) for obj in volumes]
    return any(found)


def concerns_lamps(changed):
    """True if a changed data-block may be, or may hide, a lamp."""
    if isinstance(changed, bpy.types.Object):
        return changed.type == "LIGHT"
    kinds = (bpy.types.Light, bpy.types.ShaderNodeTree, bpy.types.Collection, bpy.types.Scene)
    return isinstance(changed, kinds)


def _present_lamps(depsgraph):
    for obj, matrix in scene_export.rendered_objects(depsgraph.view_layer, depsgraph):
        if obj.type == "LIGHT":
            yield lights.export_light(obj, matrix, lambda: [], [])
