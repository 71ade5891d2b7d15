# SPDX-License-Identifier: GPL-3.0-or-later
"""Headers of Zarr folders: groups and arrays of versions 2 and 3.

https://zarr-specs.readthedocs.io; zarr_values.py reads the values, in a subprocess.
"""

import base64
import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ..reader_process import ReaderProcess
from .checks import check_scalar, text
from .watched import STAGE, begin

# Attributes of packed numbers.
_PACKED = {"scale_factor", "add_offset"}


@dataclass(frozen=True)
class ZarrArray:
    """The header of an array. names: Names of its axes, empty if the header has none."""

    path: Path
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    attributes: dict[str, Any]
    names: tuple[str | None, ...] = ()

    def read(
        self, values: Array, places: Sequence[int | None], axes: Sequence[int], progress: Progress
    ) -> None:
        """Fills an array [z, y, x] of the same type.

        places: Index along each axis of this array, None along z, y and x.
        axes: Numbers of these three axes.
        """
        begin(progress, STAGE, values.nbytes)
        with ReaderProcess(
            self.path,
            "Zarr array",
            f"{__package__}.zarr_values",
            "read_slabs",
            *(places, axes),
            size=values.nbytes,
        ) as process:
            if process.answer() != [list(values.shape), values.dtype.str]:
                raise process.died()
            process.fill(values, progress)


@dataclass(frozen=True)
class ZarrGroup:
    """A folder of arrays and other groups."""

    path: Path
    attributes: dict[str, Any]

    def groups(self) -> Iterator["ZarrGroup"]:
        """Returns the groups directly in it, sorted by number: 2 before 10."""
        for path in sorted(self.path.iterdir(), key=lambda path: (len(path.name), path.name)):
            found = open_zarr(path) if is_zarr(path) else None
            if isinstance(found, ZarrGroup):
                yield found

    def array(self, name: str) -> ZarrArray:
        """Returns one of its arrays, at any depth. Raises LeaflightError."""
        path = self.path / name
        # For security, open no file outside the header's folder.
        if self.path.resolve() not in path.resolve().parents:
            raise LeaflightError(
                f"{self.path}: the metadata name the array {name[:100]!r} outside this folder; "
                "repair the metadata."
            )
        found = open_zarr(path)
        if isinstance(found, ZarrGroup):
            raise LeaflightError(f"{path}: this is not a Zarr array; repair the metadata.")
        return found


def is_zarr(path: Path) -> bool:
    """Returns True if a folder is a group or an array."""
    return any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))


def open_zarr(path: Path) -> ZarrArray | ZarrGroup:
    """Opens a folder as an array or a group. Raises LeaflightError."""
    header = header_of(path)
    attributes = header.get("attributes") or {}
    if not {"shape", "data_type"} <= header.keys():
        return ZarrGroup(path, attributes)
    kind = header["data_type"]
    if not isinstance(kind, str):
        raise LeaflightError(
            f"{path}: the values are structures, but a volume needs one real number per voxel; "
            "convert the array first."
        )
    try:
        dtype = np.dtype(kind).newbyteorder("=")
    except TypeError:
        raise LeaflightError(
            f"{path}: the values have the type {kind[:40]!r}, but a volume needs one real number "
            "per voxel; convert the array first."
        ) from None
    check_scalar(path, dtype)
    shape = tuple(int(n) for n in header["shape"])
    if min(shape, default=0) < 1:
        raise LeaflightError(
            f"{path}: the shape is {text(shape) or 'missing'}, so there are no values; fetch it "
            "again."
        )
    names = tuple(header.get("dimension_names") or ())
    return ZarrArray(path, shape, dtype, {**attributes, **_missing(header, attributes)}, names)


def _missing(header: dict[str, Any], attributes: dict[str, Any]) -> dict[str, Any]:
    """Returns the attribute _FillValue as a number, if xarray has stored it in another way."""
    fill = attributes.get("_FillValue")
    # In version 2 xarray stores the code for missing data as the value of absent chunks. Version 3
    # requires a value of absent chunks, so it is no code there.
    if fill is None and header.get("zarr_format") == 2 and _PACKED & attributes.keys():
        return {"_FillValue": header.get("fill_value")}
    if isinstance(fill, str):
        # In version 3 xarray stores floating-point codes as base64 of a double.
        with suppress(ValueError):
            return {"_FillValue": np.frombuffer(base64.b64decode(fill, validate=True), "<f8")}
    return {}


def header_of(path: Path) -> dict[str, Any]:
    """Reads the metadata of a folder. Keys of version 2 get the names of version 3."""
    if (path / "zarr.json").is_file():
        return _json(path / "zarr.json")
    attributes = _json(path / ".zattrs") if (path / ".zattrs").is_file() else {}
    if (path / ".zarray").is_file():
        header = _json(path / ".zarray")
        return {**header, "data_type": header["dtype"], "attributes": attributes}
    if (path / ".zgroup").is_file():
        return {"zarr_format": 2, "attributes": attributes}
    raise LeaflightError(f"{path}: this folder holds no Zarr array or group; fetch it again.")


def _json(path: Path) -> dict[str, Any]:
    header: dict[str, Any] = json.loads(path.read_bytes())
    if not isinstance(header, dict):
        raise ValueError
    return header
