# SPDX-License-Identifier: GPL-3.0-or-later
"""Packed values: numbers in a file with a scale, an offset and codes for missing data.

Attributes of netCDF describe them: https://cfconventions.org, Packed Data and Missing Data
Attributes may be text or numbers, in HDF5, netCDF and Zarr.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array

# Upper bound on the length of an attribute, against damaged files.
_MOST_LETTERS = 1 << 16


def attribute(item: Any, name: str) -> Any:
    """Returns an attribute of an item of h5py; None if absent or if h5py cannot read its type."""
    try:
        return None if item is None else item.attrs.get(name)
    except (OSError, TypeError, ValueError, KeyError, RuntimeError):
        return None


def text_of(found: Any) -> str:
    """Returns an attribute as text, "" for none. It is text, bytes, or an array of letters."""
    if isinstance(found, np.ndarray):
        return "".join(_plain(one) for one in found.ravel()[:_MOST_LETTERS]).strip()
    return _plain(found).strip()


def texts_of(found: Any) -> list[str]:
    """Returns an attribute that is a list of texts."""
    if found is None:
        return []
    return [_plain(one).strip() for one in np.atleast_1d(found).ravel()[:_MOST_LETTERS]]


def numbers_of(found: Any) -> list[float]:
    """Returns the numbers of an attribute, none for other types."""
    numbers = np.asarray(() if found is None else found).ravel()
    if numbers.dtype.kind not in "iuf":
        return []
    return [float(number) for number in numbers[:_MOST_LETTERS]]


def _plain(text: Any) -> str:
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8")
        except UnicodeDecodeError:
            text = text.decode("latin-1")
    return str("" if text is None else text)[:_MOST_LETTERS].replace("\0", "")


# Attributes that packing_of() uses.
NAMES = ("scale_factor", "add_offset", "_FillValue", "missing_value", "_Unsigned")
# Upper bound on the codes for missing data.
_MOST_FILLS = 8
# Least scale, in steps of single precision, at which neighboring values differ.
_STEPS = 16


@dataclass(frozen=True)
class Packing:
    """Values are offset + scale * stored. Stored numbers in `fills` are missing data, NaN.

    unsigned: True if integers that are stored as signed are unsigned.
    """

    unsigned: bool = False
    scale: float = 1.0
    offset: float = 0.0
    fills: tuple[float, ...] = ()

    def dtype(self, stored: np.dtype[Any]) -> np.dtype[Any]:
        """Returns the type of unpacked values."""
        plain = self._plain(stored)
        if plain.kind == "f" or not (self._is_scaled or self.fills):
            return plain
        return scaled_type(plain, self.scale, self.offset)

    def unpacked(self, stored: Array) -> Array:
        """Returns the values. It is `stored` itself if nothing must be converted."""
        plain = stored.view(self._plain(stored.dtype))
        dtype = self.dtype(stored.dtype)
        values = plain.astype(dtype) if self._is_scaled or plain.dtype != dtype else plain
        if self._is_scaled:
            values *= dtype.type(self.scale)
            values += dtype.type(self.offset)
        for fill in self.fills:
            missing = plain == _as(fill, plain.dtype)
            if missing.any():
                values = values.copy() if values is plain else values
                values[missing] = np.nan
        return values

    def places(self, stored: Array) -> Array:
        """Returns unpacked coordinates: in double precision, and none is missing (CF 8.1)."""
        plain = stored.view(self._plain(stored.dtype))
        if not self._is_scaled or plain.dtype.kind not in "iuf":
            return plain
        return self.offset + self.scale * plain.astype(np.float64)

    def note(self, values: Array) -> tuple[str, ...]:
        """Returns a sentence about missing values, if there are any."""
        if not self.fills:
            return ()
        missing = sum(int(np.isnan(plane).sum()) for plane in values)
        if not missing:
            return ()
        fills = " or ".join(f"{fill:g}" for fill in self.fills)
        return (f"{missing} of the voxels are missing data, which the file marks by {fills}.",)

    @property
    def _is_scaled(self) -> bool:
        return (self.scale, self.offset) != (1.0, 0.0)

    def _plain(self, stored: np.dtype[Any]) -> np.dtype[Any]:
        if self.unsigned and stored.kind == "i":
            return np.dtype(f"{stored.byteorder}u{stored.itemsize}")
        return stored


def scaled_type(stored: np.dtype[Any], scale: float, offset: float) -> np.dtype[Any]:
    """Returns the type of offset + scale * stored: float64 if float32 would hide differences."""
    wide = stored.itemsize > (2 if stored.kind in "iu" else 4)
    with np.errstate(over="ignore", invalid="ignore"):
        fine = abs(scale) > _STEPS * np.spacing(np.float32(abs(offset)))
    return np.dtype(np.float32 if fine and not wide else np.float64)


def packing_of(attributes: Mapping[str, Any]) -> Packing:
    """Returns the Packing that the attributes of an array (NAMES) describe."""
    scale = [number for number in numbers_of(attributes.get("scale_factor")) if number]
    offset = numbers_of(attributes.get("add_offset"))
    fills = [
        *numbers_of(attributes.get("_FillValue")),
        *numbers_of(attributes.get("missing_value")),
    ]
    return Packing(
        unsigned=text_of(attributes.get("_Unsigned")).lower() == "true",
        scale=scale[0] if len(scale) == 1 and np.isfinite(scale[0]) else 1.0,
        offset=offset[0] if len(offset) == 1 and np.isfinite(offset[0]) else 0.0,
        fills=tuple(dict.fromkeys(fill for fill in fills if np.isfinite(fill)))[:_MOST_FILLS],
    )


def _as(fill: float, dtype: np.dtype[Any]) -> Any:
    """Returns a fill value as a number of this type. A file may give it in another type."""
    if dtype.kind == "f":
        with np.errstate(over="ignore"):
            return dtype.type(fill)
    if dtype.kind == "u" and fill < 0:
        # Return the signed integer with the same bits.
        fill += 2.0 ** (8 * dtype.itemsize)
    return fill
