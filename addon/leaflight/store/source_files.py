# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that volumes were read from, and whether they are still what was baked."""

import hashlib
import os
from pathlib import Path

import bpy
import leaflight
from leaflight.bake.stamps import values_sha256

LeaflightError = leaflight.LeaflightError

# What key_of() tells apart -> the hash of its values, so that a file is read once for the question.
_hashes = {}


def path_of(settings):
    """The file, or the folder of slices, of a volume's settings; empty without one."""
    return bpy.path.abspath(settings.source, library=settings.id_data.library)


def read(settings):
    """The volume in the file of an object's settings. Raises LeaflightError."""
    return read_volume(
        path_of(settings),
        settings.dims,
        settings.value_type,
        settings.endian,
        settings.spacing,
        settings.frame,
    )


def read_volume(path, dims, value_type, endian, spacing, frame):
    """Reads a volume with the options that its kind of file takes; frame -1 is none chosen."""
    suffix = Path(path).suffix.lower()
    options = {}
    if suffix == ".raw":
        options = {"dims": dims, "type": value_type, "endian": endian}
    if suffix in {".raw", ".tif", ".tiff"} or Path(path).is_dir():
        options["spacing"] = spacing
    if frame >= 0:
        options["frame"] = frame
    return leaflight.read_volume(path, **options)


def key_of(settings):
    """Tells the volumes of files apart, and one file before and after a change."""
    return (
        path_of(settings),
        tuple(settings.dims),
        settings.value_type,
        settings.endian,
        tuple(settings.spacing),
        settings.frame,
        settings.capped,
        stamp(settings),
    )


def stamp(settings):
    """A text that differs once the file, or one of a folder of slices, was written; else empty."""
    path = Path(path_of(settings))
    try:
        files = sorted(path.iterdir()) if path.is_dir() else [path]
        states = [(file.name, os.stat(file)) for file in files]
    except OSError:
        return ""
    text = repr([(name, state.st_size, state.st_mtime_ns) for name, state in states])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def changed_since_bake(obj):
    """Whether the volume's file holds other values than were baked; one that is gone does not."""
    settings = obj.leaflight
    now = stamp(settings) if settings.source else ""
    if not now or now == settings.bake_source_stamp:
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


def forget():
    _hashes.clear()
