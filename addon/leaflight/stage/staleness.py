# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the scene is still the one that was baked."""

import leaflight

from ..store import bake_files, source_files
from . import scene_export

# The fingerprint of a bake that was loaded into a scene other than its own.
OTHER_SCENE = "another scene"

# Full name of an object -> what has changed, found when a panel first asks after any change.
_changes = {}


def forget():
    """After any change of the scene: the next question looks anew."""
    _changes.clear()


def change_since_bake(context, obj):
    """A sentence when the bake is not that of the scene and of the volume's file, or "".

    Also when the bake itself cannot be found.
    """
    if obj.name_full not in _changes:
        _changes[obj.name_full] = _change(context, obj)
    return _changes[obj.name_full]


def _change(context, obj):
    try:
        bake_files.locate(obj)
    except leaflight.LeaflightError as error:
        return str(error)
    if source_files.changed_since_bake(obj):
        return f"{obj.leaflight.source} has changed since the bake: bake again"
    try:
        description, volumes, _ = scene_export.export_scene(context, obj)
        now = scene_export.fingerprint(volumes, description)
    except leaflight.LeaflightError as error:
        return f"The scene has changed since the bake: {error}"
    if obj.leaflight.bake_fingerprint == OTHER_SCENE:
        return "The bake was made for another scene: bake again to light this one"
    if now != obj.leaflight.bake_fingerprint:
        return "The scene has changed since the bake: bake again"
    return ""
