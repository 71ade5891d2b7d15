# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the volumes of an HDF5 file and the axes of its arrays.

It reads axistags of vigra and ilastik, dimension scales such as netCDF-4's, and voxel sizes.
"""

import json
from collections.abc import Sequence
from dataclasses import replace

import h5py
import numpy as np

from ...volume.axes import CF, Axis, axis_at, grid_of
from .hdf5_image import Image, image_of
from .hdf5_links import walked
from .hdf5_microscopes import bdv_images, imaris_images
from .hdf5_nexus import default_signal, is_nexus_data, signals
from .packing import NAMES, Packing, attribute, numbers_of, packing_of, text_of

# Attributes of the voxel size, z first, and its unit: ilastik and Fiji; CREMI.
_SIZES = {"element_size_um": "µm", "voxel_size": "", "resolution": ""}
# netCDF-4's name of a dimension without coordinates.
_NO_PLACES = "This is a netCDF dimension but not a netCDF variable"


def images_of(file: h5py.File) -> tuple[dict[str, Image], str | None]:
    """Returns ({name: Image}, the default name)."""
    found = imaris_images(file) or bdv_images(file)
    if found:
        return found, None
    arrays: dict[int, tuple[str, h5py.Dataset, Sequence[Axis]]] = {}
    for path, item in walked(file):
        if is_nexus_data(item):
            for name, (array, of_array) in signals(item).items():
                arrays[hash(array.id)] = f"{path}/{name}", array, of_array
        elif isinstance(item, h5py.Dataset):
            arrays.setdefault(hash(item.id), (path, item, ()))
    for path, array, axes in arrays.values():
        image = array_image(array, path, axes)
        if image is not None:
            found[path] = image
    described = [path for path, _, axes in arrays.values() if axes and path in found]
    default = default_signal(file) or (described[0] if len(described) == 1 else None)
    return found, default if default in found else None


def array_image(data: h5py.Dataset, path: str, axes: Sequence[Axis] = ()) -> Image | None:
    """Returns the Image of one array; None if it is not a volume of real numbers.

    axes: Axes that replace those in its attributes.
    """
    if data.dtype.kind not in "biuf" or not data.size:
        return None
    axes = axes or _tagged(data) or _scaled(data)
    notes: list[str] = []
    if not any(axis.step for axis in axes):
        axes, notes = _sized(data, axes)
    packing = _packing(data)
    image = image_of([(axes, [[path]])], data.dtype, packing)
    return None if image is None else replace(image, notes=[*notes, *image.notes])


def _tagged(data: h5py.Dataset) -> list[Axis]:
    """Returns the axes by the tags of vigra and ilastik; none without tags."""
    try:
        tags = json.loads(text_of(attribute(data, "axistags")) or "{}")["axes"]
        units = json.loads(text_of(attribute(data, "axis_units")) or "{}")
        axes = []
        for size, tag in zip(data.shape, tags, strict=True):
            letter = str(tag["key"]).lower()
            step = float(tag.get("resolution") or 0) or None
            unit = str(units.get(letter) or "")
            axes.append(
                Axis(size, "", letter if letter in tuple("xyztc") else "", None, step, unit)
            )
    except (ValueError, TypeError, KeyError, AttributeError):
        return []
    return axes


def _scaled(data: h5py.Dataset) -> list[Axis]:
    """Returns the axes by the dimension scales and labels of HDF5."""
    axes = []
    for size, dimension in zip(data.shape, data.dims):
        scale = dimension[0] if len(dimension) else None
        if scale is None:
            axes.append(Axis(size, text_of(dimension.label)))
            continue
        name = text_of(dimension.label) or str(scale.name or "").rpartition("/")[2]
        known = scale.shape == (size,) and _NO_PLACES not in text_of(attribute(scale, "NAME"))
        about = {one: text_of(attribute(scale, one)) for one in CF}
        about = {one: text for one, text in about.items() if text}
        places = _packing(scale).places(scale[:]) if known else np.empty(0)
        axes.append(axis_at(size, name, places, about))
    return axes


def _packing(data: h5py.Dataset) -> Packing:
    return packing_of({name: attribute(data, name) for name in NAMES})


def _sized(data: h5py.Dataset, axes: Sequence[Axis]) -> tuple[Sequence[Axis], list[str]]:
    """Returns (the axes with the voxel size of an attribute, notes)."""
    grid = grid_of(axes)
    for name, unit in _SIZES.items():
        sizes = numbers_of(attribute(data, name))
        if grid is None or len(sizes) != 3 or not all(0 < n < float("inf") for n in sizes):
            continue
        steps = dict(zip("zyx", sizes))
        sized = [
            replace(axis, step=steps.get(letter), unit=unit)
            for letter, axis in zip(grid.letters, axes)
        ]
        note = f"The voxel size is read from the attribute {name}, in the order z, y, x."
        return sized, [] if unit else [note]
    return axes, []
