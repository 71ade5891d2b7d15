# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that volumes were read from, and whether they are still what was baked."""

import hashlib
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
from leaflight.volume import smoothing

from .. import session

# The properties that say which volume of a file was read, and how; of a frame or a channel -1 is
# none chosen.
CHOICES = (
    "dims",
    "value_type",
    "endian",
    "skip",
    "use_spacing",
    "spacing",
    "frame",
    "channel",
    "level",
    "dataset",
    "downsample",
    "smooth",
    "smooth_normals",
)
# Those that say so by a number above this one.
_NONE = {"frame": -1, "channel": -1, "downsample": 1, "smooth": 0, "smooth_normals": 0}
# Those of them that say how values, and normals alone, are smoothed.
SMOOTHING = CHOICES[-2:]

# A key_of() -> the hash of its values, so that a file is read once for it.
_hashes = session.remembered()
# The same -> whether its coordinates are a patient's.
_patients = session.remembered()


def path_of(settings):
    """The file, or the folder of slices, of a volume's settings; empty without one."""
    return bpy.path.abspath(settings.source, library=settings.id_data.library)


def read(settings):
    """The volume in the file of an object's settings. Raises LeaflightError."""
    return read_volume(path_of(settings), **choices_of(settings))


def choices_of(settings):
    """What read_volume() takes beside the path, by the names that properties have for it."""
    return {name: _plain(getattr(settings, name)) for name in CHOICES}


def _plain(value):
    return value if isinstance(value, (bool, int, float, str)) else tuple(value)


def read_volume(path, progress=None, **choices):
    """Reads a volume with those of CHOICES that its kind of file takes. Raises LeaflightError."""
    options = _options(path, choices)
    options |= {name: choices[name] for name, none in _NONE.items() if choices[name] > none}
    with _in_words_of_blender():
        return leaflight.read_volume(path, progress=progress, **options)


def probe(path, **choices):
    """The StoredVolume of a file, from its header. Raises LeaflightError."""
    with _in_words_of_blender():
        return readers.probe(path, **_options(path, choices))


def is_patient(settings):
    """Whether the coordinates of a volume are a patient's, by the header of its file."""
    key = key_of(settings)
    if key not in _patients:
        try:
            _patients[key] = probe(path_of(settings), **choices_of(settings)).patient
        except LeaflightError:
            # It is gone, or the volume was never in a file.
            _patients[key] = False
    return _patients[key]


def format_of(path):
    """The Format of a file or folder; a file of an unknown kind may be one without a header."""
    try:
        return readers.format_of(path)
    except LeaflightError:
        if Path(path).is_file():
            return readers.RAW
        raise


def _options(path, choices):
    """Those that say where in a file its volume is."""
    takes = format_of(path).options if Path(path).exists() else ()
    options = {}
    # Until they are given, the reader or the suffix says what is missing.
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
    """What to do about an absent package, where nobody works in a terminal."""
    try:
        yield
    except readers.MissingPackage as missing:
        raise LeaflightError(
            f"{missing.path}: reading this {missing.kind} needs the Python package "
            f"{missing.package}, which Blender's Python lacks: run "
            f"{install_command(missing.wanted, missing.of_debian)} in a terminal, and start "
            "Blender again."
        ) from None


def install_command(wanted, of_debian=None):
    """The command that gives packages of PyPI, or one of Debian, to Blender's Python."""
    # Debian's Blender uses the system's Python.
    if sys.prefix == "/usr" and of_debian:
        return f"'sudo apt install {of_debian}'"
    # Without what they depend on: another NumPy would take the place of Blender's own.
    target = bpy.utils.user_resource("SCRIPTS", path="modules")
    return f'\'"{sys.executable}" -m pip install --no-deps --target "{target}" {wanted}\''


def from_file(settings):
    """The matrix (4, 4) from the coordinates of a volume's file to those of its object."""
    matrix = np.eye(4)
    matrix[:3, 3] -= settings.origin
    return matrix


def place_of_file(obj):
    """The matrix (4, 4) from the coordinates of a volume's file to the world."""
    return np.array(obj.matrix_world, np.float64) @ from_file(obj.leaflight)


def key_of(settings):
    """A key, different for the volumes of different files, and after each change of a file."""
    choices = (*choices_of(settings).values(), settings.capped, *settings.origin)
    return (path_of(settings), *choices, file_state(settings))


def file_state(settings):
    """A text that differs once the file, or one of a folder of slices, was written; else empty."""
    path = Path(path_of(settings))
    try:
        files = sorted(path.iterdir()) if path.is_dir() else [path]
        states = [(file.name, os.stat(file)) for file in files]
    except OSError:
        return ""
    text = repr([(name, state.st_size, state.st_mtime_ns) for name, state in states])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def source_of(settings):
    """The file of an object's volume and what was done to its values, for the bake's record."""
    if not settings.source:
        return ""
    return smoothing.source_of(path_of(settings), settings.smooth, settings.smooth_normals)


def smoothing_changed(settings):
    """Whether the values, or the normals alone, are smoothed otherwise than they were baked."""
    now = [getattr(settings, name) for name in SMOOTHING]
    return now != list(settings.bake_smoothing)


def changed_since_bake(obj):
    """Whether the volume's file holds other values than were baked; one that is gone does not."""
    settings = obj.leaflight
    now = file_state(settings) if settings.source else ""
    if not now or now == settings.bake_file_state:
        return False
    key = key_of(settings)
    if key not in _hashes:
        try:
            volume = read(settings)
        except LeaflightError:
            # It was a volume when it was imported.
            return True
        _hashes[key] = values_sha256(volume.capped() if settings.capped else volume)
    return _hashes[key] != settings.bake_values
