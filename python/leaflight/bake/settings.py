# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake, checked: the isovalue range, the error and the time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypedDict, TypeVar

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..scene.scene import Isosurfaces
from ..volume.setting_error import SettingError
from ..volume.first_isovalue import default_isovalue_range
from ..volume.volume import Volume
from ..words import figures

_InPasses = TypeVar("_InPasses", _core.BakeSettings, _core.BakeSettings2)
_Settings = TypeVar("_Settings", bound="CoreSettings")

# Default target error, as rms_percent of compare().
DEFAULT_ERROR = 1.5


class CoreSettings(Protocol):
    """Settings of the core for any bake, with fixed samples, too (validation/thesis)."""

    resolution: Any
    seed: Any
    threads: Any
    both_sides: bool
    walls: bool


class UnusedSetting(UserWarning):
    """A warning: a setting has no effect in the scene that is baked."""


class ChosenSetting(UserWarning):
    """A warning: a setting that was not given differs from its default, to suit the data."""


class CommonOptions(TypedDict, total=False):
    """The fields of CommonSettings by name."""

    isovalues: Sequence[float] | None
    resolution: int | Sequence[int] | None
    seed: int
    threads: int
    both_sides: bool | None
    walls: bool


class BakeOptions(CommonOptions, total=False):
    """The fields of BakeSettings by name."""

    error: float | None
    time: float | None


@dataclass(frozen=True, eq=False)
class CommonSettings:
    """The settings of all bakes; leaflight.bake explains them."""

    isovalues: Sequence[float] | None = None
    resolution: int | Sequence[int] | None = None
    seed: int = 0
    threads: int = 0
    both_sides: bool | None = None
    walls: bool = False

    def set_common(self, settings: _Settings, dims: Sequence[int]) -> _Settings:
        """Sets these fields, except isovalues, in settings of the core, and returns those.

        dims: Nodes of the volume.
        Raises LeaflightError.
        """
        settings.resolution = _texels(self.resolution, dims)
        settings.seed = whole("seed", self.seed, 0)
        settings.threads = whole("threads", self.threads, 0)
        settings.both_sides = bool(self.both_sides)
        settings.walls = bool(self.walls)
        return settings


@dataclass(frozen=True, eq=False)
class BakeSettings(CommonSettings):
    """The settings of a bake in passes."""

    error: float | None = None
    time: float | None = None

    def core(
        self, kind: Callable[[], _InPasses], dims: Sequence[int], exposure: float
    ) -> _InPasses:
        """Returns core settings, a kind (_core.BakeSettings or BakeSettings2), for nodes dims.

        exposure: radiance times this is a displayed color. Raises LeaflightError.
        """
        settings = self.set_common(kind(), dims)
        error = DEFAULT_ERROR if self.error is None else self.error
        settings.error = _positive("error", error, "percent")
        settings.seconds = 0.0 if self.time is None else _positive("time", self.time, "seconds")
        settings.exposure = exposure
        return settings


def range_to_bake(
    isovalues: Sequence[float] | None,
    volumes: Sequence[Volume],
    isosurfaces: Sequence[Isosurfaces],
) -> tuple[float, float]:
    """Returns the range (lo, hi) of the common isovalue to bake."""
    if len(volumes) > 1:
        return (0.0, 1.0) if isovalues is None else _checked(isovalues, (0.0, 1.0))
    if isovalues is None:
        isovalues = isosurfaces[0].isovalues
    if isovalues is None:
        return default_isovalue_range(volumes[0])
    return _checked(isovalues, volumes[0].data_range())


def _checked(isovalues: Sequence[float], data_range: tuple[float, float]) -> tuple[float, float]:
    low, high = data_range
    try:
        lo, hi = (float(isovalue) for isovalue in isovalues)
    except (TypeError, ValueError):
        raise LeaflightError(
            f"The isovalue range must be two numbers, not {isovalues!r}."
        ) from None
    if not (np.isfinite([lo, hi]).all() and lo < hi):
        raise LeaflightError(
            f"The isovalue range {lo:g}..{hi:g} is empty: give the lower value first, "
            "then the higher."
        )
    if hi <= low or lo >= high:
        first, last, least, most = figures(lo, hi, low, high)
        raise LeaflightError(
            f"The isovalue range {first}..{last} is outside the data, {least}..{most}: give a "
            "range that overlaps them."
        )
    return lo, hi


def _texels(resolution: Any, dims: Sequence[int]) -> tuple[int, ...]:
    if resolution is None:
        return (0,) * len(dims)
    if np.ndim(resolution) == 0:
        longest = whole("resolution", resolution, 2)
        return tuple(max(2, round(longest * n / max(dims))) for n in dims)
    if len(resolution) != len(dims):
        raise LeaflightError(
            f"The resolution must be one number of texels or {len(dims)}, one for each axis."
        )
    return tuple(whole("resolution", n, 2) for n in resolution)


def whole(name: str, value: float, least: int) -> int:
    """Returns the value as an int of at least `least`. Raises LeaflightError."""
    if not least <= value < 2**31 or value != int(value):
        raise LeaflightError(f"{name} must be a whole number in {least}..{2**31 - 1}, not {value}.")
    return int(value)


def _positive(name: str, value: float, unit: str) -> float:
    """Returns the value as a float above 0. Raises SettingError."""
    value = float(value)
    if not (np.isfinite(value) and value > 0):
        raise SettingError(f"The {name} must be a number of {unit} above 0, not {value:g}.", name)
    return value
