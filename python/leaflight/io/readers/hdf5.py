# SPDX-License-Identifier: GPL-3.0-or-later
"""HDF5 through h5py: the only volume of a file, its default, or a chosen one.

It runs in a subprocess, because HDF5 may crash on damaged files, and Blender has its own HDF5.
hdf5_layouts.py finds the volumes of a file.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from ..reader_process import ReaderProcess, has_package
from .checks import check_matrix, choose_level, choose_named, index_to_world
from .hdf5_image import image_of_json
from .missing_package import MissingPackage
from .stored import StoredVolume, lengths
from .watched import STAGE, begin

_PROCESS = f"{__package__}.hdf5_process"
# First bytes of HDF4 files, which have the same suffix.
_HDF4 = b"\x0e\x03\x13\x01"

# Filters of the package hdf5plugin.
_OF_HDF5PLUGIN = {
    307: "bzip2",
    32001: "Blosc",
    32004: "LZ4",
    32008: "bitshuffle",
    32013: "ZFP",
    32015: "Zstandard",
    32017: "SZ",
    32018: "FCI",
    32024: "SZ3",
    32026: "Blosc2",
    32028: "SPERR",
}
_OTHER_FILTERS = {4: "szip", 305: "LZO", 32000: "LZF"}


def open_volume(
    path: Path,
    dataset: str | None = None,
    level: int = 0,
    spacing: float | Sequence[float] | None = None,
) -> StoredVolume:
    """Opens a volume of a file.

    dataset: A name in its list of volumes, or the path of any array.
    level: Resolution; 0 is the finest.
    """
    _check_readable(path)
    dataset = None if dataset is None else dataset.strip("/")
    with _reader(path, "list_images", dataset) as process:
        listed = process.answer()
    images = {name: image_of_json(facts) for name, facts in listed["images"].items()}
    names, notes = tuple(sorted(listed["names"])), []
    if dataset is None and len(names) > 1 and listed["default"] is not None:
        dataset = str(listed["default"])
        notes.append(f"This is {dataset}, the default of the {len(names)} volumes in the file.")
    image = images.get(dataset or "") or images[choose_named(path, names, dataset)]
    chosen = image.levels[choose_level(path, level, len(image.levels))]
    matrix, dtype = np.array(chosen.matrix), image.packing.dtype(np.dtype(image.dtype))
    matrix = matrix if spacing is None else index_to_world(path, spacing)
    check_matrix(path, matrix)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        if image.absent_filter is not None:
            raise _without_filter(path, *image.absent_filter)
        values = new_voxels(chosen.dims, dtype)
        begin(progress, STAGE, values.nbytes)
        channels = chosen.paths[min(frame, len(chosen.paths) - 1)]
        where = channels[min(channel, len(channels) - 1)], chosen.dims
        with _reader(path, "read_image", image.json(), *where, frame, channel) as process:
            if process.answer() != [list(values.shape), dtype.str]:
                raise process.died()
            process.fill(values, progress)
        return Volume(values, matrix, path.stem, notes=image.packing.note(values))

    return StoredVolume(
        dims=tuple(chosen.dims[::-1]),
        dtype=dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit=image.unit if spacing is None else "",
        frames=image.frames,
        channels=image.channels,
        channel_list=image.channel_list,
        levels=tuple(tuple(one.dims[::-1]) for one in image.levels)
        if len(image.levels) > 1
        else (),
        datasets=names,
        notes=(*notes, *image.notes),
    )


def _check_readable(path: Path) -> None:
    if not has_package("h5py"):
        raise ModuleNotFoundError(name="h5py")
    with open(path, "rb") as file:
        if file.read(len(_HDF4)) == _HDF4:
            raise LeaflightError(
                f"{path}: HDF4, the predecessor of HDF5, is not supported; convert the file with "
                "'h4toh5' of the HDF Group first."
            )


def _reader(path: Path, function: str, *options: object) -> ReaderProcess:
    return ReaderProcess(path, "HDF5 file", _PROCESS, function, *options)


def _without_filter(path: Path, code: int, name: str) -> LeaflightError:
    """Returns the error for values that an absent filter packs."""
    name = {**_OF_HDF5PLUGIN, **_OTHER_FILTERS}.get(code) or name or "without a name"
    if code in _OF_HDF5PLUGIN and not has_package("hdf5plugin"):
        kind = f"HDF5 file, which the filter {name} ({code}) packs,"
        return MissingPackage(path, kind, "hdf5plugin")
    return LeaflightError(
        f"{path}: the values are compressed by the HDF5 filter {name} ({code}), which is not "
        "installed; decompress them elsewhere, for example with 'h5repack -f NONE'."
    )
