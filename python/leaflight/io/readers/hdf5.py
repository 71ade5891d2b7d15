# SPDX-License-Identifier: GPL-3.0-or-later
"""HDF5 through h5py: the only array of three or four dimensions, or the one that is chosen.

In a process of its own: on damaged files HDF5 ends the one that it is in. Only that process imports
h5py.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from ..reader_process import ReaderProcess
from .checks import choose_named, index_to_world, undecided
from .stored import StoredVolume, lengths
from .watched import STAGE, begin

if TYPE_CHECKING:
    import h5py

# How ilastik and Fiji write the size of a voxel, z first, in micrometers.
_ELEMENT_SIZE = "element_size_um"


def open_volume(
    path: Path, dataset: str | None = None, spacing: float | Sequence[float] | None = None
) -> StoredVolume:
    """Arrays are [z, y, x] or [frame, z, y, x]; axes of length 1 do not count."""
    with _reader(path, "list_arrays") as process:
        found = process.answer()
    names = tuple(sorted(found))
    name = choose_named(path, names, None if dataset is None else dataset.strip("/"))
    if name is None:
        return StoredVolume(None, np.dtype(np.float32), undecided(path, names), datasets=names)
    shape, dtype, size = found[name]
    shape, dtype = tuple(n for n in shape if n > 1), np.dtype(dtype)
    matrix = index_to_world(path, spacing if spacing is not None else size or 1.0)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        values = new_voxels(shape[-3:], dtype)
        begin(progress, STAGE, values.nbytes)
        with _reader(path, "read_array", name, frame if len(shape) == 4 else None) as process:
            if process.answer() != [list(values.shape), dtype.str]:
                raise process.died()
            process.fill(values, progress)
        return Volume(values, matrix, path.stem)

    return StoredVolume(
        dims=shape[-3:][::-1],
        dtype=dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit="µm" if size and spacing is None else "",
        frames=shape[0] if len(shape) == 4 else 1,
        datasets=names,
    )


def _reader(path: Path, function: str, *options: object) -> ReaderProcess:
    return ReaderProcess(path, "HDF5 file", __name__, function, *options)


def list_arrays(path: Path) -> tuple[dict[str, Any], tuple[()]]:
    """Within the process: {name: (shape, type, size of a voxel or None)} of what may be volumes."""
    import h5py

    found: dict[str, Any] = {}

    def look(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and _is_volume(item):
            found[name] = item.shape, item.dtype.str, _voxel_size(item)

    with h5py.File(path, "r") as file:
        file.visititems(look)
    return found, ()


def read_array(path: Path, name: str, frame: int | None) -> tuple[list[Any], Iterator[Array]]:
    """Within the process: one volume, in slabs; frame: of four dimensions, else None."""
    import h5py

    file = h5py.File(path, "r")
    data = file[name]
    index = [slice(None) if n > 1 else 0 for n in data.shape]
    places = [i for i, n in enumerate(data.shape) if n > 1]
    if frame is not None:
        index[places.pop(0)] = frame
    shape = [data.shape[place] for place in places]

    def slabs() -> Iterator[Array]:
        step = data.chunks[places[0]] if data.chunks else 1
        for k in range(0, shape[0], step):
            index[places[0]] = slice(k, k + step)
            yield np.ascontiguousarray(data[tuple(index)])

    return [shape, data.dtype.str], slabs()


def _is_volume(data: "h5py.Dataset") -> bool:
    return sum(n > 1 for n in data.shape) in (3, 4) and data.size > 0 and data.dtype.kind in "biuf"


def _voxel_size(data: "h5py.Dataset") -> tuple[float, ...] | None:
    """(x, y, z) in micrometers, or None."""
    sizes = np.atleast_1d(data.attrs.get(_ELEMENT_SIZE, ()))
    if sizes.shape != (3,) or sizes.dtype.kind not in "iuf" or not (sizes > 0).all():
        return None
    return tuple(float(size) for size in sizes[::-1])
