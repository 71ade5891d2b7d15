# SPDX-License-Identifier: GPL-3.0-or-later
"""NeXus data in HDF5: groups NXdata that name their signal and its axes.

https://manual.nexusformat.org/classes/base_classes/NXdata.html
"""

import re
from collections.abc import Sequence

import h5py

from ...volume.axes import Axis, axis_at
from .hdf5_links import resolved
from .packing import attribute, text_of, texts_of

# Upper bound on the groups on the path to a default.
_DEEPEST = 8


def is_nexus_data(item: h5py.HLObject) -> bool:
    return isinstance(item, h5py.Group) and text_of(attribute(item, "NX_class")) == "NXdata"


def signals(data: h5py.Group) -> dict[str, tuple[h5py.Dataset, list[Axis]]]:
    """Returns {name: (array of the group, its axes)}, the main signal first."""
    names = texts_of(attribute(data, "signal")) + texts_of(attribute(data, "auxiliary_signals"))
    # Older files mark the array instead of naming it.
    names = names or [name for name in data if text_of(attribute(data.get(name), "signal")) == "1"]
    found = {}
    for name in names:
        array = resolved(data, name) if name else None
        if isinstance(array, h5py.Dataset):
            found[name] = array, _axes(data, array)
    return found


def default_signal(file: h5py.File) -> str | None:
    """Returns the path of the array that the file shows by default, or None."""
    node, path = file, ""
    for _ in range(_DEEPEST):
        name = text_of(attribute(node, "default"))
        inner = resolved(node, name) if name and "/" not in name.strip("/") else None
        if not isinstance(inner, h5py.Group):
            break
        node, path = inner, f"{path}{name.strip('/')}/"
    main = next(iter(signals(node)), None) if is_nexus_data(node) else None
    return None if main is None else path + main


def _axes(data: h5py.Group, array: h5py.Dataset) -> list[Axis]:
    named = attribute(data, "axes")
    names: Sequence[str] = texts_of(named if named is not None else attribute(array, "axes"))
    if len(names) == 1 and array.ndim > 1:
        names = re.split("[:,]", names[0].strip("[]"))
    if len(names) != array.ndim:
        return [Axis(n) for n in array.shape]
    return [_axis(data, name.strip(), n) for name, n in zip(names, array.shape)]


def _axis(data: h5py.Group, name: str, size: int) -> Axis:
    """Returns the axis whose coordinates have this name, "." for none."""
    name = name if name != "." else ""
    places = resolved(data, name) if name else None
    if not isinstance(places, h5py.Dataset) or places.shape not in ((size,), (size + 1,)):
        return Axis(size, name)
    return axis_at(size, name, places[:], {"units": text_of(attribute(places, "units"))})
