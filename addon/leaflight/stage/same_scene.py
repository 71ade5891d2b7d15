# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two descriptions mean the same scene: Blender keeps less digits than scene files do."""

import dataclasses
from numbers import Real

import numpy as np

# Single precision through a few products.
_TOLERANCE = 1e-4

# What a description calls things, where they came from, and what only the bake's range says.
_UNSEEN = {"name", "source", "reading", "coordinates", "isovalues"}


def is_same(a, b):
    """Whether plain data are equal, but for names, rounding, and the order of objects."""
    if dataclasses.is_dataclass(a) and dataclasses.is_dataclass(b):
        return type(a) is type(b) and all(
            is_same(getattr(a, part.name), getattr(b, part.name)) for part in _parts(a)
        )
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)) and len(a) == len(b):
        if any(dataclasses.is_dataclass(item) for item in a):
            return _same_members(a, b)
        return all(is_same(x, y) for x, y in zip(a, b))
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and _close(a, b)
    if isinstance(a, Real) and isinstance(b, Real):
        return _close(a, b)
    return type(a) is type(b) and a == b


def in_order(a, b):
    """The members of a in the order of those like them in b, which are as many."""
    return [next(item for item in a if is_same(item, other)) for other in b]


def _parts(description):
    # The index of refraction is that of glass alone.
    unseen = _UNSEEN | (
        {"ior"} if getattr(description, "scattering", "glass") != "glass" else set()
    )
    return [part for part in dataclasses.fields(description) if part.name not in unseen]


def _same_members(a, b):
    """Each of a has its like in b: objects of a scene have no order."""
    left = list(b)
    for item in a:
        like = next((other for other in left if is_same(item, other)), None)
        if like is None:
            return False
        left.remove(like)
    return True


def _close(a, b):
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    scale = max(1e-30, np.abs(a).max(initial=0), np.abs(b).max(initial=0))
    return bool(np.abs(a - b).max(initial=0) <= _TOLERANCE * scale)
