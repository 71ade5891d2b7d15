# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes that HDF5, netCDF and their kin give to arrays, as text and numbers."""

from typing import Any

import numpy as np

# A damaged file may give an attribute any length.
_MOST = 1 << 16


def attribute(item: Any, name: str) -> Any:
    """An attribute of an item of h5py, None without it, or where h5py cannot read its type."""
    try:
        return None if item is None else item.attrs.get(name)
    except (OSError, TypeError, ValueError, KeyError, RuntimeError):
        return None


def text_of(found: Any) -> str:
    """An attribute as text, "" for none: it may be text, bytes, or an array of their letters."""
    if isinstance(found, np.ndarray):
        return "".join(_plain(one) for one in found.ravel()[:_MOST]).strip()
    return _plain(found).strip()


def texts_of(found: Any) -> list[str]:
    """An attribute that lists texts."""
    if found is None:
        return []
    return [_plain(one).strip() for one in np.atleast_1d(found).ravel()[:_MOST]]


def numbers_of(found: Any) -> list[float]:
    """The numbers of an attribute, none where it holds others."""
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
