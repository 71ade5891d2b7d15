# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a file that holds several volumes over time, each of which has a bake of its own.

An object shows one frame at a time, with what it remembers of that frame's bake; what it remembers
of the others is kept beside it, as JSON.
"""

import json

# Properties that change with the frame, beside those that begin with bake_.
_MORE = ("atlas_columns", "comparison")
_OF_ALL = ("bake_folder",)


def wanted(settings):
    """The frame that the slider, keyframes or a driver ask for, within those of the file."""
    return min(max(settings.shown_frame, 0), settings.frames - 1)


def is_behind(obj, evaluated):
    """Whether an object shows another frame than it is to, by its evaluated self."""
    settings = obj.leaflight
    return settings.frames > 1 and wanted(evaluated.leaflight) != settings.frame


def switch(obj, frame):
    """Makes a frame the one that the object shows, lit by its own bake or by none.

    Returns whether it was another before. The mesh is for others to update.
    """
    settings = obj.leaflight
    if settings.frames < 2 or frame == settings.frame or obj.library is not None:
        return False
    names = _names(settings)
    kept = json.loads(settings.frame_bakes or "{}")
    if settings.bake_id:
        kept[str(settings.frame)] = {name: _plain(getattr(settings, name)) for name in names}
    found = kept.pop(str(frame), {})
    for name in names:
        if name in found:
            setattr(settings, name, found[name])
        else:
            settings.property_unset(name)
    settings.frame = frame
    settings.frame_bakes = json.dumps(kept)
    return True


def forget(settings):
    """Lets a volume remember no bake, of any frame. Their files stay."""
    for name in _names(settings):
        settings.property_unset(name)
    settings.frame_bakes = ""


def each_baked(obj):
    """Lets an object show each frame that is baked, one after the other, and then as before.

    Yields nothing: what it remembers of the bake is in its settings meanwhile, and may be changed.
    """
    settings = obj.leaflight
    first = settings.frame
    if settings.bake_id:
        yield
    for frame in sorted(map(int, json.loads(settings.frame_bakes or "{}"))):
        switch(obj, frame)
        yield
    switch(obj, first)


def count_baked(settings):
    """How many of the frames have a bake."""
    return len(json.loads(settings.frame_bakes or "{}")) + bool(settings.bake_id)


def bakes_of(settings):
    """The ids of the bakes of all frames."""
    kept = json.loads(settings.frame_bakes or "{}").values()
    return {bake["bake_id"] for bake in kept} | ({settings.bake_id} - {""})


def _names(settings):
    names = [name for name in settings.bl_rna.properties.keys() if name.startswith("bake_")]
    return [name for name in (*names, *_MORE) if name not in _OF_ALL]


def _plain(value):
    return value if isinstance(value, (bool, int, float, str)) else list(value)
