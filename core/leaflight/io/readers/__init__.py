# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes from files: read_volume picks the reader by the suffix."""

import warnings
from importlib import import_module
from pathlib import Path

from ..._core import LeaflightError
from ...volume.setting_error import SettingError

# Suffix -> module of this package and the options that its read() takes.
_READERS = {
    ".nii": ("nifti", {"frame"}),
    ".nii.gz": ("nifti", {"frame"}),
    ".nrrd": ("nrrd", set()),
    ".nhdr": ("nrrd", set()),
    ".raw": ("raw", {"dims", "type", "endian", "spacing"}),
    ".tif": ("tiff", {"frame", "spacing"}),
    ".tiff": ("tiff", {"frame", "spacing"}),
    ".vdb": ("vdb", {"grid"}),
}
_FOLDER = ("tiff", {"frame", "spacing"})

SUFFIXES = tuple(_READERS)


def read_volume(path, *, dims=None, type=None, endian=None, spacing=None, grid=None, frame=None):
    """Reads a scalar volume from a file of one of SUFFIXES or from a folder of TIFF slices.

    dims (nx, ny, nz), type ("uint8", "float32", ...), endian ("little", "big"): layout of a .raw.
    spacing: size of a voxel, one number or (x, y, z); for .raw and TIFF, whose files often lack it.
    grid: name of the grid in a .vdb; None is the first scalar one.
    frame: index of the frame, from 0, in 4D data.
    Returns a Volume. Raises LeaflightError: one sentence with the file and the remedy.
    """
    path = Path(path)
    if not path.exists():
        raise LeaflightError(f"{path}: there is no such file or folder; check the path.")
    module, takes = _reader(path)
    options = {
        "dims": dims,
        "type": type,
        "endian": endian,
        "spacing": spacing,
        "grid": grid,
        "frame": frame,
    }
    options = {name: value for name, value in options.items() if value is not None}
    for name in options:
        if name not in takes:
            raise SettingError(
                f"{path}: {name} has no meaning for this kind of file; leave it out.", name
            )
    try:
        reader = import_module(f".{module}", __name__)
    except ImportError as error:
        raise LeaflightError(
            f"{path}: reading it needs the Python package {error.name}, which is not installed; "
            f"install python3-{error.name}."
        ) from None
    try:
        # What a library warns of is harmless, or an error comes.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            volume = reader.read(path, **options)
    except LeaflightError as error:
        # The sentence may be about another file, the detached data of a header.
        if str(path) in str(error):
            raise
        raise LeaflightError(f"{path}: {error}") from None
    except OSError as error:
        raise LeaflightError(f"{path}: cannot read it: {error.strerror or 'damaged'}.") from None
    except MemoryError:
        raise LeaflightError(
            f"{path}: the volume does not fit into memory; use a smaller one."
        ) from None
    volume.field()
    return volume


def _reader(path):
    if path.is_dir():
        return _FOLDER
    name = path.name.lower()
    for suffix in sorted(_READERS, key=len, reverse=True):
        if name.endswith(suffix):
            return _READERS[suffix]
    raise LeaflightError(
        f"{path}: the suffix {path.suffix or '(none)'} is not known; known are "
        f"{', '.join(SUFFIXES)} and folders of TIFF slices."
    )
