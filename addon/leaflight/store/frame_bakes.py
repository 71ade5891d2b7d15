# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of a file with several volumes over time, and the bake of each frame.

An object shows one frame at a time. Its properties describe that frame's bake. The properties of
the other frames are stored as JSON.

The frames of a wipe are cuts of one volume: "frame_regions" has the regions of each as JSON. A
frame without a bake shows the bake of the nearest frame before it, whose light is estimated at the
cut (show/changed_data.py).
"""

import json

from . import source_files

# Properties that change with the frame, in addition to those that begin with bake_.
_MORE = ("atlas_columns", "comparison")
_OF_ALL = ("bake_folder",)
# Path of the property that chooses the frame, from the object.
PATH = "leaflight.shown_frame"


def wanted(settings):
    """Returns the frame that the slider, keyframes or a driver choose, clamped to the file."""
    return min(max(settings.shown_frame, 0), settings.frames - 1)


def is_behind(obj, evaluated):
    """True if an object does not yet show the frame of its evaluated copy."""
    settings = obj.leaflight
    return settings.frames > 1 and wanted(evaluated.leaflight) != settings.frame


def switch(obj, frame):
    """Switches an object to a frame and to the properties of that frame's bake, if it has one.

    Returns True if the object showed another frame before. Callers update the mesh.
    """
    settings = obj.leaflight
    if settings.frames < 2 or frame in (-1, settings.frame) or obj.library is not None:
        return False
    names = _names(settings)
    kept = json.loads(settings.frame_bakes or "{}")
    if is_baked(settings):
        kept[str(settings.frame)] = {
            name: source_files.plain(getattr(settings, name)) for name in names
        }
    found = kept.pop(str(frame), {})
    regions = json.loads(settings.frame_regions or "[]")
    if regions and not found and kept:
        first, *others = sorted(map(int, kept))
        found = kept[str(max((each for each in others if each < frame), default=first))]
    for name in names:
        if name in found:
            setattr(settings, name, found[name])
        elif not regions:
            settings.property_unset(name)
    settings.frame = frame
    settings.frame_bakes = json.dumps(kept)
    if regions:
        # Setting the property by its name would read the bake for its update.
        settings["regions"] = json.dumps(regions[frame])
    return True


def begin_wipe(settings, regions):
    """Makes a volume of one frame a wipe. regions: those of each frame."""
    settings.frames, settings.frame = len(regions), 0
    settings.frame_regions = json.dumps(regions)
    settings.regions = json.dumps(regions[0])


def end_wipe(settings):
    """Makes a wipe a volume of one frame again, with its present bake and regions."""
    for name in ("frame_regions", "frame_bakes", "frame", "frames", "shown_frame"):
        settings.property_unset(name)


def is_baked(settings):
    """True if the bake of an object is that of its present frame."""
    is_wipe = bool(settings.frame_regions)
    return bool(settings.bake_id) and not (is_wipe and source_files.values_changed(settings))


def forget(settings):
    """Clears the properties of the bakes of all frames. Their files stay."""
    for name in _names(settings):
        settings.property_unset(name)
    settings.frame_bakes = ""


def each_baked(obj):
    """Switches an object to each baked frame in turn, and then back to its first frame.

    Yields None at each. Meanwhile its settings describe that frame's bake and may be changed.
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
    """Returns the number of frames that have a bake."""
    return len(json.loads(settings.frame_bakes or "{}")) + is_baked(settings)


def bakes_of(settings):
    """Returns the ids of the bakes of all frames."""
    kept = json.loads(settings.frame_bakes or "{}").values()
    return {bake["bake_id"] for bake in kept} | ({settings.bake_id} - {""})


def _names(settings):
    names = [name for name in settings.bl_rna.properties.keys() if name.startswith("bake_")]
    return [name for name in (*names, *_MORE) if name not in _OF_ALL]
