# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of arrays in HDF5, netCDF and similar files, as text and numbers."""

from typing import Any

import numpy as np

# Upper bound on the length of an attribute, against damaged files.
_MOST = 1 << 16


def attribute(item: Any, name: str) -> Any:
    """Returns an attribute of an item of h5py; None if absent or if h5py cannot read its type."""
    try:
        return None if item is None else item.attrs.get(name)
    except (OSError, TypeError, ValueError, KeyError, RuntimeError):
        return None


def text_of(found: Any) -> str:
    """Returns an attribute as text, "" for none. It is text, bytes, or an array of letters."""
    if isinstance(found, np.ndarray):
        return "".join(_plain(one) for one in found.ravel()[:_MOST]).strip()
    return _plain(found).strip()


def texts_of(found: Any) -> list[str]:
    """Returns an attribute that is a list of texts."""
    if found is None:
        return []
    return [_plain(one).strip() for one in np.atleast_1d(found).ravel()[:_MOST]]


def numbers_of(found: Any) -> list[float]:
    """Returns the numbers of an attribute, none for other types."""
    numbers = np.asarray(() if found is None else found).ravel()
    if numbers.dtype.kind not in "iuf":
        return []
    return [float(number) for number in numbers[:_MOST]]


def _plain(text: Any) -> str:
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8")
        except UnicodeDecodeError:
            text = text.decode("latin-1")
    return str("" if text is None else text)[:_MOST].replace("\0", "")
