# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists and reads the volumes of an HDF5 file in the subprocess."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from .checks import data_file
from .hdf5_image import Image, image_of_json
from .hdf5_layouts import array_image, images_of
from .hdf5_links import resolved

# Bytes to read at once, or one row of chunks if that is larger.
_SLAB = 1 << 26


def list_images(path: Path, wanted: str | None) -> tuple[dict[str, Any], tuple[()]]:
    """Returns {"images": {name: Image}, "names": of all volumes, "default": one of them or None}.

    wanted: A name, or the path of any array, to return that Image alone.
    """
    with h5py.File(path, "r") as file:
        found, default = images_of(file)
        if wanted is None:
            images = found
        else:
            image = found.get(wanted) or _image_at(file, wanted, found)
            images = {} if image is None else {wanted: image}
        described = {name: _described(file, image) for name, image in images.items()}
    return {"images": described, "names": list(found), "default": default}, ()


def read_image(
    path: Path, facts: dict[str, Any], where: str, dims: Sequence[int], frame: int, channel: int
) -> tuple[list[Any], Iterator[Array]]:
    """Returns one volume of an Image as [z, y, x], in slabs of whole slices.

    facts: The Image.
    where: Path of the array.
    dims: Voxels of the array without padding.
    """
    image = image_of_json(facts)
    file = h5py.File(path, "r")
    data = resolved(file, where)
    if not isinstance(data, h5py.Dataset) or data.dtype.str != image.dtype:
        raise ValueError(where)
    _check_other_files(data)
    # h5py then finds the filters of hdf5plugin, too.
    _absent_filter(data)
    letters, unpack = image.letters, image.packing
    index: list[int | slice] = [{"t": frame, "c": channel}.get(letter, 0) for letter in letters]
    counts = dict(zip("zyx", dims))
    for letter, count in counts.items():
        index[letters.index(letter)] = slice(0, count)
    order = [letter for letter in letters if letter in "zyx"]
    slow = letters.index("z")
    chunk = data.chunks[slow] if data.chunks else 1
    step = max(1, _SLAB // max(1, chunk * data.dtype.itemsize * dims[1] * dims[2])) * chunk

    def slabs() -> Iterator[Array]:
        for k in range(0, dims[0], step):
            counts["z"] = min(step, dims[0] - k)
            index[slow] = slice(k, k + counts["z"])
            # HDF5 does not write memory for absent chunks without a fill value.
            slab = np.zeros([counts[letter] for letter in order], data.dtype)
            data.read_direct(slab, tuple(index))
            slab = slab.transpose([order.index(letter) for letter in "zyx"])
            yield unpack.unpacked(np.ascontiguousarray(slab))
        file.close()

    return [list(dims), unpack.dtype(data.dtype).str], slabs()


def _described(file: h5py.File, image: Image) -> dict[str, Any]:
    data = resolved(file, image.levels[0].paths[0][0])
    absent = _absent_filter(data) if isinstance(data, h5py.Dataset) else None
    return replace(image, absent_filter=absent).json()


def _image_at(file: h5py.File, wanted: str, found: dict[str, Image]) -> Image | None:
    """Returns the Image of an array at this path, by itself or as part of a found one."""
    parts = (image.part(wanted) for image in found.values())
    part = next((one for one in parts if one is not None), None)
    data = resolved(file, wanted)
    if part is None and isinstance(data, h5py.Dataset):
        return array_image(data, wanted)
    return part


def _absent_filter(data: h5py.Dataset) -> tuple[int, str] | None:
    """Returns (code, name) of a filter that packs the values and is not installed, or None."""
    listed = data.id.get_create_plist()
    for number in range(listed.get_nfilters()):
        code, _, _, name = listed.get_filter(number)
        if not h5py.h5z.filter_avail(code) and not _plugins_have(code):
            name = name.decode("utf-8", "replace").partition(";")[0][:40]
            return code, name
    return None


def _plugins_have(code: int) -> bool:
    try:
        import_module("hdf5plugin")
    except Exception:
        # A filter for another version of HDF5 may raise any error.
        return False
    return bool(h5py.h5z.filter_avail(code))


def _check_other_files(data: h5py.Dataset) -> None:
    """Raises LeaflightError for values in absent files, for which HDF5 reads fill values."""
    path = Path(data.file.filename)
    if data.external:
        name = str(data.external[0][0])[:100]
        raise LeaflightError(
            f"{path}: the values are in another file, {name!r}, which is not supported; merge the "
            "files, for example with 'h5repack'."
        )
    for source in data.virtual_sources() if data.is_virtual else ():
        if source.file_name == ".":
            continue
        # If the name has a counter, test the first file.
        other = data_file(path, source.file_name.replace("%b", "0"))
        with h5py.File(other, "r") as file:
            if source.dset_name.replace("%b", "0") not in file:
                raise LeaflightError(
                    f"{path}: the array {source.dset_name[:100]!r} of its part {other.name} is "
                    "missing; fetch that file again."
                )
