# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the scene is still the one that was baked."""

import leaflight

from . import scene_export

# Object name -> what has changed since its bake, found when a panel first asks after a change.
_changes = {}


def forget():
    """After any change of the scene: the next question looks anew."""
    _changes.clear()


def change_since_bake(context, obj):
    """A sentence when the scene is no longer the one that was baked, or an empty text."""
    if obj.name not in _changes:
        settings = obj.leaflight
        try:
            description, volumes, _ = scene_export.export_scene(context, obj)
            same = scene_export.fingerprint(volumes, description) == settings.bake_fingerprint
            _changes[obj.name] = "" if same else "The scene has changed since the bake: bake again"
        except leaflight.LeaflightError as error:
            _changes[obj.name] = f"The scene has changed since the bake: {error}"
    return _changes[obj.name]
