# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the scene is still the one that was baked.

The whole scene is read and hashed for this: at a call, or, for panels, when nothing has
changed for a moment. Never while a panel draws or an isovalue moves.
"""

import dataclasses
import time

import bpy
from leaflight import LeaflightError

from .. import session
from ..operators import jobs
from ..show import lamps
from ..store import bake_files, source_files
from . import scene_export

_OTHER = "The bake was made for another scene: bake again to light this one"
_CHANGED = "The scene has changed since the bake: bake again"
# What change_since_bake() says where the volumes are those of the bake, in another scene.
OF_THE_SCENE = (_OTHER, _CHANGED)

# The fingerprint of a bake that was loaded into a scene other than its own.
OTHER_SCENE = "another scene"

# Seconds without a change before panels are drawn anew.
PAUSE = 0.5

# (Full name of an object, its bake) -> what has changed, known until the next change; by the name
# alone where it stood then.
_changes = session.remembered()
_places = session.remembered()

# The same as panels show it, by object and bake, though it may have been before the last change;
# the names of the objects whose panels are drawn.
_shown = session.remembered()
_wanted = session.remembered(set)
_changed_at = 0.0


def forget():
    """After any change of the scene: the next question looks anew."""
    global _changed_at
    _changes.clear()
    _changed_at = time.monotonic()


def stands_elsewhere(obj):
    """Whether an object has moved since change_since_bake() looked."""
    place = _places.get(obj.name_full)
    return place is not None and place != obj.matrix_world


def change_since_bake(context, obj):
    """A sentence when the bake is not that of the scene and of the volume's file, or "".

    Also when the bake itself cannot be found.
    """
    key = _key(obj)
    if key not in _changes:
        _places[obj.name_full] = obj.matrix_world.copy()
        _changes[key] = _shown[key] = _change(context, obj)
    return _changes[key]


def known_change(obj):
    """What change_since_bake() said unless something may have changed since; then ""."""
    return _changes.get(_key(obj), "")


def change_to_show(obj):
    """The last result of change_since_bake(), for panels, which are drawn anew if it changes."""
    if _key(obj) not in _changes and not bpy.app.background:
        _wanted.add(obj.name_full)
        if not bpy.app.timers.is_registered(_look):
            bpy.app.timers.register(_look, first_interval=PAUSE)
    return _shown.get(_key(obj), "")


def _key(obj):
    """Another frame of a volume has another bake."""
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
    if source_files.smoothing_changed(obj.leaflight):
        return "Smooth has changed since the bake: bake again"
    if source_files.changed_since_bake(obj):
        return f"{obj.leaflight.source} has changed since the bake: bake again"
    try:
        description, volumes, _ = scene_export.export_scene(context, obj)
        now = scene_export.fingerprint(volumes, description)
    except LeaflightError as error:
        return f"The scene has changed since the bake: {error}"
    if obj.leaflight.bake_fingerprint == OTHER_SCENE:
        return _OTHER
    if now != obj.leaflight.bake_fingerprint and not _is_relit(obj, volumes, description):
        return _CHANGED
    return ""


def _is_relit(obj, volumes, description):
    """Whether but the strengths and colors of lamps have changed, which are shown as they are."""
    lights = lamps.as_baked(obj.leaflight, description.lights)
    if lights is None or not lamps.factors_of(obj.leaflight):
        return False
    before = dataclasses.replace(description, lights=lights)
    return scene_export.fingerprint(volumes, before) == obj.leaflight.bake_fingerprint
