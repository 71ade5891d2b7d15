# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of BigDataViewer and BigStitcher in HDF5: t00000/s00/0/cells, for each time and setup.

Values are unsigned, but stored as signed integers. https://imagej.net/plugins/bdv
"""

import re
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np

from .axes import Axis
from .hdf5_image import Image, image_of
from .hdf5_links import resolved
from .packing import Packing

# Upper bound on the bytes of the .xml beside the file.
_MOST_XML = 1 << 26
_SHORT = np.dtype(np.int16)


def bdv_images(file: h5py.File) -> dict[str, Image]:
    """Returns the image of each setup, such as a channel or an angle; {} for other programs' files.

    Frames are the times at which the setup has an image.
    """
    times = sorted(name for name in file if re.fullmatch("t[0-9]{5,}", name))
    setups = sorted(name for name in file if re.fullmatch("s[0-9]{2,}", name))
    sizes = _voxel_sizes(Path(file.filename)) if times else {}
    found = {}
    for setup in setups:
        factors = resolved(file, f"{setup}/resolutions")
        here = [time for time in times if resolved(file, f"{time}/{setup}") is not None]
        if not here or not isinstance(factors, h5py.Dataset) or factors.ndim != 2:
            continue
        size, unit = sizes.get(int(setup[1:]), ((1.0, 1.0, 1.0), ""))
        levels, dtype = [], _SHORT
        for number, factor in enumerate(np.asarray(factors[:], np.float64)):
            paths = [[f"{time}/{setup}/{number}/cells"] for time in here]
            cells = resolved(file, paths[0][0])
            if not isinstance(cells, h5py.Dataset) or cells.ndim != 3 or factor.shape != (3,):
                break
            dtype = cells.dtype
            # A coarse voxel lies in the middle of those that it averages.
            axes = [
                Axis(n, "", letter, 0.5 * (times - 1) * step, times * step, unit)
                for letter, n, times, step in zip("zyx", cells.shape, factor[::-1], size[::-1])
            ]
            levels.append((axes, paths))
        packing = Packing(unsigned=dtype.kind == "i" and dtype.itemsize == _SHORT.itemsize)
        image = image_of(levels, dtype, packing)
        if image is not None:
            found[setup] = image
    return found


def _voxel_sizes(path: Path) -> dict[int, tuple[tuple[float, ...], str]]:
    """Returns {setup: (voxel size (x, y, z), unit)} by the .xml beside the file; {} without one."""
    found: dict[int, tuple[tuple[float, ...], str]] = {}
    beside = path.with_suffix(".xml")
    try:
        if beside.stat().st_size > _MOST_XML:
            return {}
        root = ElementTree.fromstring(beside.read_bytes())
        for setup in root.iter("ViewSetup"):
            numbers = tuple(float(n) for n in setup.findtext("voxelSize/size", "").split())
            if len(numbers) == 3 and all(0 < n < float("inf") for n in numbers):
                unit = setup.findtext("voxelSize/unit", "")
                found[int(setup.findtext("id", ""))] = numbers, unit
    except (OSError, ValueError, ElementTree.ParseError):
        return {}
    return found
