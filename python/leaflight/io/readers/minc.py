# SPDX-License-Identifier: GPL-3.0-or-later
"""MINC 1 and 2 through nibabel, which scales the values of each plane.

It runs in a subprocess, because MINC 2 is HDF5, which may crash on damaged files.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
from nibabel.fileholders import FileHolder

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from ..reader_process import ReaderProcess, has_package
from .checks import check_matrix, check_shape
from .stored import StoredVolume, lengths
from .watched import STAGE, begin, open_head


def open_volume(path: Path) -> StoredVolume:
    """Opens three axes of space, the last fastest, or time before them."""
    if not _is_minc1(path) and not has_package("h5py"):
        raise ModuleNotFoundError(name="h5py")
    with _reader(path, "describe") as process:
        shape, matrix = process.answer()
    check_shape(path, shape)
    matrix = np.array(matrix, np.float64)
    check_matrix(path, matrix)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        values = new_voxels(shape[-3:], np.float32)
        begin(progress, STAGE, values.nbytes)
        with _reader(path, "read_planes", frame if len(shape) == 4 else None) as process:
            if process.answer() != list(values.shape):
                raise process.died()
            process.fill(values, progress)
        return Volume(values, matrix, path.name.partition(".mnc")[0])

    return StoredVolume(
        dims=tuple(shape[-3:][::-1]),
        # Each plane has its own scale.
        dtype=np.dtype(np.float32),
        load=load,
        voxel_size=lengths(matrix),
        unit="mm",
        frames=shape[0] if len(shape) == 4 else 1,
        patient=True,
    )


def _reader(path: Path, function: str, *options: object) -> ReaderProcess:
    return ReaderProcess(path, "MINC file", __name__, function, *options)


def describe(path: Path) -> tuple[list[Any], tuple[()]]:
    """Returns [sizes, slowest axis first; matrix, fastest axis first]. Runs in the subprocess."""
    image, names = _image(path)
    in_space = [name.endswith("space") for name in names]
    if in_space not in ([True] * 3, [False, *[True] * 3]):
        raise LeaflightError(
            f"{path}: the axes are {', '.join(names)[:80]}, but a volume needs three in space, "
            "and optionally time before them; reorder them with mincreshape."
        )
    matrix = np.asarray(image.affine, np.float64)[:, [2, 1, 0, 3]]
    return [[int(size) for size in image.shape], matrix.tolist()], ()


def read_planes(path: Path, frame: int | None) -> tuple[list[int], Iterator[Array]]:
    """Yields the planes of one volume. frame: Index of time, else None. Runs in the subprocess."""
    image, _ = _image(path)
    first: tuple[int, ...] = () if frame is None else (frame,)
    planes = (
        np.ascontiguousarray(image.dataobj[first + (k,)], np.float32)
        for k in range(image.shape[-3])
    )
    return [int(size) for size in image.shape[-3:]], planes


def _image(path: Path) -> tuple[Any, list[str]]:
    """Returns (nibabel's image, the names of its axes)."""
    if _is_minc1(path):
        files = {"image": FileHolder(fileobj=open_head(path))}
        image = nibabel.Minc1Image.from_file_map(files)
    else:
        image = nibabel.Minc2Image.from_file_map({"image": FileHolder(str(path))})
    return image, [str(name) for name in image.dataobj.minc_file._dim_names]


def _is_minc1(path: Path) -> bool:
    """Returns True if the file is netCDF, not HDF5."""
    with open_head(path) as file:
        return file.read(3) == b"CDF"
