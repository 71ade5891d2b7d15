# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of headers and matrices that readers share. All are made before memory is allocated for
values.
"""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from math import log10, prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..._core import LeaflightError
from ...arrays import Array
from ...volume.setting_error import SettingError

# Upper bound on the ratio of deflate. A header that claims more is damaged.
DEFLATE_MOST = 1032


def check_size(path: Path, shape: Iterable[int], itemsize: int, stored: int, most: int = 1) -> None:
    """Raises LeaflightError if shape has more than `most` bytes for each of the stored bytes."""
    claimed = prod(int(n) for n in shape) * int(itemsize)
    if claimed > int(stored) * most:
        raise LeaflightError(
            f"{path}: the header claims {text(shape)} values ({text([claimed])} bytes), but the "
            f"file holds only {stored} bytes of data: it is truncated or damaged, fetch it again."
        )


def check_shape(path: Path, shape: Sequence[int]) -> None:
    """Raises LeaflightError unless a volume has three dimensions, or four with its frames."""
    if 0 in shape:
        raise LeaflightError(f"{path}: the data are empty ({text(shape)}); choose another file.")
    if len(shape) not in (3, 4) or min(shape) < 1:
        raise LeaflightError(
            f"{path}: the data have the shape {text(shape)}, but a volume needs three dimensions, "
            "or four with frames: choose another file."
        )


def truncated(path: Path, shape: Iterable[int]) -> LeaflightError:
    """Returns the error for a file that ends early or cannot be decoded."""
    return LeaflightError(
        f"{path}: the file ends before its {text(shape)} values do, or is damaged; fetch it again."
    )


def check_scalar(path: Path, dtype: DTypeLike) -> None:
    """Raises LeaflightError unless values are real numbers."""
    dtype = np.dtype(dtype)
    if dtype.kind not in "biuf":
        kinds = {"c": "complex", "S": "texts", "U": "texts", "O": "Python objects"}
        raise LeaflightError(
            f"{path}: the values are {kinds.get(dtype.kind, 'groups of numbers')}, but a volume "
            "needs one real number per voxel; convert the file first."
        )


def choose(path: Path, what: str, chosen: int | None, count: int, names: Sequence[str] = ()) -> int:
    """Returns the frame or channel to read of `count`. Raises LeaflightError.

    Several frames or channels need a choice.

    what: "frame" or "channel", the name of the option.
    names: Names of the channels, for the error.
    """
    if count == 1:
        if chosen not in (None, 0):
            raise SettingError(
                f"{path}: the data are 3D, so there is no {what} {chosen}; leave the option out.",
                what,
            )
        return 0
    if chosen is None:
        named = f" ({listed(names)})" if names else ""
        raise SettingError(
            f"{path}: the data are 4D with {count} {what}s{named}; choose one of 0..{count - 1}.",
            what,
        )
    if not 0 <= chosen < count:
        raise SettingError(
            f"{path}: there is no {what} {chosen}; choose one of 0..{count - 1}.", what
        )
    return int(chosen)


def choose_level(path: Path, level: int, count: int) -> int:
    """Returns the resolution to read of `count`, 0 the finest. Raises LeaflightError."""
    if not 0 <= level < count:
        levels = f"choose one of 0..{count - 1}, 0 is the finest" if count > 1 else "it has only 0"
        raise SettingError(f"{path}: there is no level {level}; {levels}.", "level")
    return level


class Undecided(SettingError):
    """A file holds several datasets, and none is chosen.

    facts: Fields of the StoredVolume that probe() returns.
    """

    def __init__(self, path: Path, names: Sequence[str], facts: dict[str, Any]) -> None:
        super().__init__(
            f"{path}: the file holds {len(names)} volumes; choose one of {listed(names)}.",
            "dataset",
        )
        self.facts = {**facts, "datasets": tuple(names)}


def choose_named(path: Path, names: Sequence[str], chosen: str | None, **facts: Any) -> str:
    """Returns the name of the dataset to read. Raises LeaflightError.

    names: Names of all datasets in the file.
    facts: Fields of the StoredVolume of a file without a choice.
    """
    if not names:
        raise LeaflightError(
            f"{path}: the file holds no three-dimensional volume of real numbers; choose another "
            "file."
        )
    if chosen is None and len(names) > 1:
        raise Undecided(path, names, facts)
    if chosen is None:
        return names[0]
    if chosen not in names:
        raise SettingError(
            f"{path}: the file holds no volume {chosen!r}; choose one of {listed(names)}.",
            "dataset",
        )
    return chosen


def unlike(names: Iterable[str]) -> list[str]:
    """Returns names of which repeated ones are numbered: "a", "a (2)"."""
    counts: Counter[str] = Counter()
    found = []
    for name in names:
        counts[name] += 1
        found.append(name if counts[name] == 1 else f"{name} ({counts[name]})")
    return found


def listed(names: Sequence[str], most: int = 8) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(str(name)[:80] for name in names[:most]) + more


def index_to_world(path: Path, spacing: float | Sequence[float]) -> Array:
    """Returns the matrix (4, 4) of a grid at the origin. spacing: Voxel size, one or (x, y, z)."""
    sizes = np.atleast_1d(np.asarray(spacing, dtype=np.float64))
    if sizes.shape not in ((1,), (3,)) or not (np.isfinite(sizes).all() and (sizes > 0).all()):
        raise LeaflightError(
            f"{path}: the spacing {spacing} is invalid; give one positive number or three, X Y Z."
        )
    return np.diag([*np.broadcast_to(sizes, 3), 1.0])


def matrix_at(path: Path, axes: ArrayLike, origin: ArrayLike = 0.0) -> Array:
    """Returns the matrix (4, 4) of steps along x, y and z, in columns. Raises LeaflightError."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, origin
    check_matrix(path, matrix)
    return matrix


def check_matrix(path: Path, matrix: Array) -> None:
    """Raises LeaflightError unless the matrix is finite and invertible."""
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix[:3, :3])) == 0:
        raise LeaflightError(
            f"{path}: the matrix in the header is not invertible; repair its spacing and axes."
        )


def text(shape: Iterable[int]) -> str:
    """Returns whole numbers of a file as text. A damaged file may have thousands of digits."""
    numbers = [int(n) for n in shape]
    return " x ".join(str(n) if abs(n) < 10**18 else f"10^{int(log10(abs(n)))}" for n in numbers)


def data_file(path: Path, name: str) -> Path:
    """Returns the file of values that the header in `path` names. Raises LeaflightError."""
    # For security, open no file outside the header's folder, neither by name nor by a link.
    folder = path.parent.resolve()
    data = (path.parent / name).resolve()
    if re.match(r"[A-Za-z]:", name) or folder not in data.parents:
        raise LeaflightError(
            f"{path}: the header names the data file {name[:100]!r} outside its folder; move that "
            "beside the header."
        )
    if not data.is_file():
        raise LeaflightError(
            f"{path}: the data file {name[:100]!r} is missing; put it beside the header."
        )
    return data


def cell_axes(sizes: Sequence[float] | Array, angles: Sequence[float]) -> Array:
    """Returns the edges a, b and c, in columns: a along x, b in the plane of x and y.

    angles: alpha, beta and gamma in degrees. Old files use 0 for right angles.
    """
    cosines = [np.cos(np.radians(angle or 90.0)) for angle in angles]
    alpha, beta, gamma = [0.0 if abs(cosine) < 1e-9 else float(cosine) for cosine in cosines]
    sine = np.sqrt(1 - gamma**2)
    lean = (alpha - beta * gamma) / sine
    edges = [[1, gamma, beta], [0, sine, lean], [0, 0, np.sqrt(1 - beta**2 - lean**2)]]
    return np.array(edges, np.float64) * sizes
