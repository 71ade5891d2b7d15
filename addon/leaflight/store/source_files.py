# SPDX-License-Identifier: GPL-3.0-or-later
"""The source files of volumes, and their changes since the bake."""

import hashlib
import json
import os
import sys
from contextlib import contextmanager
from pathlib import Path

import bpy
import leaflight
import numpy as np
from leaflight import LeaflightError
from leaflight.bake.provenance import values_sha256
from leaflight.io import readers
from leaflight.io.readers.reading import with_label_maps
from leaflight.volume import regions, smoothing

from .. import session

# Properties that choose the volume in a file and the way to read it. A frame or a channel of -1 is
# no choice.
CHOICES = (
    "dims",
    "value_type",
    "endian",
    "skip",
    "use_spacing",
    "spacing",
    "frame",
    "channel",
    "brightest",
    "level",
    "dataset",
    "downsample",
    "field",
    "hide",
    "regions",
    "smooth",
    "smooth_normals",
)
# Largest value of each property that has no effect.
_NONE = {
    **{"frame": -1, "channel": -1, "brightest": (-1, -1, -1), "downsample": 1},
    **{"field": "", "hide": "", "regions": "", "smooth": 0, "smooth_normals": 0},
}
# Properties for changes of the values since the import.
CHANGES = CHOICES[-4:]

# Cache: key_of() -> hash of the values, so that each file is read only once for it.
_hashes = session.cache()
# Cache: key_of() -> True if the coordinates are a patient's.
_patients = session.cache()


def path_of(settings):
    """Returns the path of a volume's file or folder of slices, empty if it has none."""
    return bpy.path.abspath(settings.source, library=settings.id_data.library)


def read(settings):
    """Reads the volume in the file of an object's settings. Raises LeaflightError."""
    return read_volume(path_of(settings), **choices_of(settings))


def choices_of(settings):
    """Returns the arguments of read_volume() beside the path, by the names of the properties."""
    choices = {name: plain(getattr(settings, name)) for name in CHOICES}
    # The frames of a wipe are cuts of one volume. Import operators have none.
    return {**choices, "frame": -1} if getattr(settings, "frame_regions", "") else choices


def plain(value):
    """Returns the value of a property as numbers or text that JSON can hold."""
    return value if isinstance(value, (bool, int, float, str)) else tuple(value)


def read_slices(path, progress=None, **choices):
    """Reads the values on the faces of a volume's capped cuts. Raises LeaflightError."""
    whole = read_volume(path, progress, uncut=True, **choices)
    return leaflight.slices_of(whole, _records(choices["regions"]))


def read_volume(path, progress=None, label_table="", uncut=False, **choices):
    """Reads a volume with the CHOICES that apply to its format. Raises LeaflightError.

    label_table: Path of a table of labels, empty without one. uncut: True leaves out cuts.
    """
    options = reading_of(path, choices, uncut)
    if label_table:
        options["label_table"] = label_table
    with _in_words_of_blender():
        return leaflight.read_volume(path, progress=progress, **options)


def reading_of(path, choices, uncut=False):
    """Returns the options of leaflight.read_volume() for CHOICES that apply to a format.

    uncut: As for read_volume().
    """
    options = _options(path, choices)
    options |= {name: choices[name] for name, none in _NONE.items() if choices[name] > none}
    if "regions" in options:
        records = _records(options["regions"])
        options["regions"] = regions.without_cuts(records) if uncut else records
    if "brightest" in options:
        options["channel"] = options.pop("brightest")
    if "hide" in options:
        options["hide"] = [int(number) for number in options["hide"].split()]
    return options


def changed(volume, items, progress):
    """Returns a volume that regions have changed (importing/regions.py). Raises LeaflightError."""
    found = regions.as_regions(_records(json.dumps(items)))
    return regions.changed(volume, with_label_maps(found, progress), progress)


def _records(text):
    """Returns the records of the regions that are on (importing/regions.py)."""
    records = []
    for item in json.loads(text or "[]"):
        if item.pop("on"):
            for name in ("object", "place"):
                item.pop(name, None)
            if "label_map" in item:
                item["label_map"] = bpy.path.abspath(item["label_map"])
            records.append(item)
    return records


def regions_of(settings):
    """Returns the regions of a volume, on or off (importing/regions.py)."""
    return json.loads(settings.regions or "[]")


def before_box(text):
    """Splits the regions of a volume before the first cut by a clip box.

    Returns (text of the regions before it, list of the others). The list is empty without such a
    cut.
    """
    items = json.loads(text or "[]")
    cuts = (number for number, item in enumerate(items) if item["on"] and is_box_cut(item))
    first = next(cuts, len(items))
    return json.dumps(items[:first]) if first else "", items[first:]


def is_box_cut(item):
    """True if a region is a cut by the object of a clip box."""
    return item["kind"] == "box" and "object" in item


def capped_cuts(settings):
    """Returns the regions of a volume that are on and cut it, with a cap."""
    return [item for item in regions_of(settings) if item["on"] and item.get("cut") == "capped"]


def probe(path, **choices):
    """Reads the StoredVolume of a file from its header. Raises LeaflightError."""
    with _in_words_of_blender():
        return readers.probe(path, **_options(path, choices))


def is_patient(settings):
    """True if a volume has a patient's coordinates by the header of its file."""
    key = key_of(settings)
    if key not in _patients:
        try:
            _patients[key] = probe(path_of(settings), **choices_of(settings)).patient
        except LeaflightError:
            # The file is gone, or the volume was never in a file.
            _patients[key] = False
    return _patients[key]


def format_of(path):
    """Returns the Format of a file or folder.

    A file of an unknown format counts as RAW, which has no header. Raises LeaflightError.
    """
    try:
        return readers.format_of(path)
    except LeaflightError:
        if Path(path).is_file():
            return readers.RAW
        raise


def _options(path, choices):
    """Returns the options that locate a volume in its file."""
    takes = format_of(path).options if Path(path).exists() else ()
    options = {}
    # Without dimensions, let the reader report what is missing.
    if "type" in takes and any(choices["dims"]):
        names = {"dims": "dims", "type": "value_type", "endian": "endian", "skip": "skip"}
        options = {name: choices[choice] for name, choice in names.items()}
    if "spacing" in takes and (options or choices["use_spacing"]):
        options["spacing"] = choices["spacing"]
    if "level" in takes:
        options["level"] = choices["level"]
    if "dataset" in takes and choices["dataset"]:
        options["dataset"] = choices["dataset"]
    return options


@contextmanager
def _in_words_of_blender():
    """Turns MissingPackage into a LeaflightError with a remedy for Blender."""
    try:
        yield
    except readers.MissingPackage as missing:
        other = "save the file as NIfTI or NRRD with another program."
        raise LeaflightError(
            f"{missing.path}: reading this {missing.kind} needs the Python package "
            f"{missing.package}, which Blender's Python lacks: {remedy(missing.of_debian, other)}"
        ) from None


def remedy(of_debian, other):
    """Returns what to do about a missing package. other: the remedy where Debian has none."""
    # Debian's Blender uses the system's Python. An extension must not change Blender's own.
    if sys.prefix == "/usr" and of_debian:
        return f"run 'sudo apt install {of_debian}' in a terminal, and restart Blender."
    return other


def from_file(settings):
    """Returns the matrix (4, 4) from the coordinates of a volume's file to those of its object."""
    matrix = np.eye(4)
    matrix[:3, 3] -= settings.origin
    return matrix


def place_of_file(obj):
    """Returns the matrix (4, 4) from the coordinates of a volume's file to world space."""
    return np.array(obj.matrix_world, np.float64) @ from_file(obj.leaflight)


def key_of(settings):
    """Returns a key of a volume, which changes with its file and with each option of reading."""
    choices = {**choices_of(settings), "regions": json.dumps(_nameless(settings.regions))}
    others = settings.capped, *settings.origin, file_state(settings)
    return (path_of(settings), *choices.values(), *others)


def file_state(settings):
    """Returns a hash of the names, sizes and times of the volume's file or slices, and of those of
    the label maps that mask it.

    Returns an empty text if the volume has no file, or one cannot be read.
    """
    if not settings.source:
        return ""
    paths = map(Path, files_of(settings))
    try:
        states = [(file.name, os.stat(file)) for path in paths for file in _files_at(path)]
    except OSError:
        return ""
    text = repr([(name, state.st_size, state.st_mtime_ns) for name, state in states])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def files_of(settings):
    """Returns the paths of the volume's file, or folder of slices, and of its label maps."""
    masks = (item["label_map"] for item in _records(settings.regions) if "label_map" in item)
    return [path_of(settings), *masks]


def _files_at(path):
    return sorted(path.iterdir()) if path.is_dir() else [path]


def source_of(settings):
    """Returns the file of a volume and its smoothing, as text for the record of a bake."""
    if not settings.source:
        return ""
    source = smoothing.source_of(path_of(settings), settings.smooth, settings.smooth_normals)
    return source + regions.titles(regions.as_regions(_records(settings.regions)))


def changes_of(settings):
    """Returns the changes of a volume's values since the import, as text."""
    return json.dumps([plain(getattr(settings, name)) for name in CHANGES])


def regions_alone_changed(settings):
    """True if the user has changed the regions since the bake, and no other values."""
    if not settings.bake_id or not values_changed(settings):
        return False
    before, now = (json.loads(text) for text in (settings.bake_changes, changes_of(settings)))
    number = CHANGES.index("regions")
    return all(a == b for i, (a, b) in enumerate(zip(before, now)) if i != number)


def values_changed(settings):
    """True if the user has changed values or normals since the bake."""
    now, before = changes_of(settings), settings.bake_changes
    return now != before and _without_names(now) != _without_names(before)


def _without_names(changes):
    """Returns the values of changes_of() by name, without the names of objects in regions."""
    values = dict(zip(CHANGES, json.loads(changes or "[]")))
    return {**values, "regions": _nameless(values.get("regions"))}


def _nameless(regions):
    return [{**item, "object": ""} for item in json.loads(regions or "[]")]


def changed_since_bake(obj):
    """True if the files of a volume and its label maps hold other values than were baked.

    False if one of them is gone.
    """
    settings = obj.leaflight
    now = file_state(settings)
    if not now or now == settings.bake_file_state:
        return False
    key = key_of(settings)
    if key not in _hashes:
        try:
            volume = read(settings)
        except LeaflightError:
            # The file was readable when it was imported, so it has changed.
            return True
        _hashes[key] = values_sha256(volume.capped() if settings.capped else volume)
    return _hashes[key] != settings.bake_values
