# SPDX-License-Identifier: GPL-3.0-or-later
"""Nikon ND2 through the package nd2, in a subprocess."""

from collections.abc import Iterator
from functools import partial
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from .channels import Channel, channel_of
from .checks import truncated
from .microscope import Format, Picture, open_pictures

open_volume = partial(open_pictures, kind=Format("ND2 file", "nd2", __name__))
_WITHIN_FRAMES = "CYXS"


def pictures(path: Path) -> list[Picture]:
    """Returns the image of a file. Runs in the subprocess."""
    import nd2

    with nd2.ND2File(path) as file:
        outer, inner = _axes(file)
        sizes = _voxel_size(file)
        return [Picture("", outer, inner, file.dtype.str, sizes, "µm", _channel_list(file))]


def _voxel_size(file: Any) -> list[float | None]:
    """Returns the voxel size of the first channel, None for an axis without calibration."""
    try:
        volume = file.metadata.channels[0].volume
        known = zip(volume.axesCalibration, volume.axesCalibrated)
    except Exception:
        # Ignore any exception on metadata of unknown microscopes, because the pixels are readable.
        return [None, None, None]
    return [size if calibrated else None for size, calibrated in known]


def _channel_list(file: Any) -> list[Channel]:
    """Returns the names and colors of the channels, none for unknown microscopes."""
    try:
        found = [one.channel for one in file.metadata.channels]
        return [channel_of(one.name, np.array(one.color[:3]) / 255) for one in found]
    except Exception:
        return []


def _axes(file: Any) -> tuple[tuple[tuple[str, int], ...], tuple[tuple[str, int], ...]]:
    """Returns the axes of the frames, and those within a frame."""
    sizes = [(name, int(n)) for name, n in file.sizes.items()]
    outer = tuple(axis for axis in sizes if axis[0] not in _WITHIN_FRAMES)
    return outer, tuple(axis for axis in sizes if axis[0] in _WITHIN_FRAMES)


def blocks(path: Path, _number: int, places: list[list[int]]) -> Iterator[Array]:
    """Yields frames of the image, in the subprocess. Raises LeaflightError if one is missing."""
    import nd2

    file = nd2.ND2File(path)
    outer, inner = ([n for _, n in axes] for axes in _axes(file))
    frames = [int(np.ravel_multi_index(place, outer)) if outer else 0 for place in places]
    _check_frames(path, file, frames, prod(inner) * file.dtype.itemsize)
    return (file.read_frame(frame).reshape(inner) for frame in frames)


def _check_frames(path: Path, file: Any, frames: list[int], size: int) -> None:
    """Raises LeaflightError for missing frames, for which the package would return zeros."""
    offsets = getattr(file._rdr, "_frame_offsets", None)
    if offsets is None:
        return
    for frame in frames:
        if frame not in offsets:
            raise LeaflightError(
                f"{path}: frame {frame} of the recording is missing; fetch the file again, or "
                "choose another frame."
            )
        stored = file.attributes.compressionType is None
        if stored and offsets[frame] + size > path.stat().st_size:
            raise truncated(path, file.shape)
