# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake, checked: the window of isovalues and how much work is done.

The work is either rounds, until the estimated error or the time asked for is reached, or the fixed
amount of the research settings.
"""

from dataclasses import astuple, dataclass

import numpy as np

from .._core import LeaflightError
from ..volume.setting_error import SettingError
from ..volume.volume import default_window

# Of what compare() calls rms_percent.
DEFAULT_ERROR = 1.5

# The research settings where some of them are given.
FIXED_WORK = {
    "samples": 32,
    "photons": 2_000_000,
    "caustic_photons": None,
    "estimator": "gather",
    "photon_map": None,
    "scattered": None,
    "only_at": None,
}


@dataclass(frozen=True)
class PhotonMap:
    """How the estimator "thesis" counts photons (thesis 4.3.5).

    k: photons of an estimate; radius: how far it reaches at most, in longest sides of the volumes,
    0 for no limit; g: how much longer a unit of the range counts than one of the domain;
    region: "sphere", "clipped_sphere", "box", "cylinder" or "graph".
    """

    k: int = 200
    radius: float = 0.0
    g: float = 10.0
    region: str = "clipped_sphere"


@dataclass(frozen=True)
class Scattered:
    """Samples strewn over the domain and interpolated into texels (thesis 3.4, 4.4 and 4.5).

    strategy: "uniform", "stratified", "importance", "level_set", "letters", "slabs", "regular";
    count: samples, each of them with all the rays; isovalues: of "level_set", how many, chosen
    adaptively, or a sequence of them; filter: "shepard" (Eq. 3.11), "tent" or "box"; radius:
    texels that it reaches.
    """

    strategy: str
    count: int
    isovalues: object = 9
    filter: str = "shepard"
    radius: int = 3


def leaf_window(isovalues, volumes, leaves):
    """The window (lo, hi) of the leaf coordinate to bake."""
    if len(volumes) > 1:
        return (0.0, 1.0) if isovalues is None else _window(isovalues, (0.0, 1.0))
    if isovalues is None:
        isovalues = leaves[0].isovalues
    if isovalues is None:
        return default_window(volumes[0])
    return _window(isovalues, volumes[0].data_range())


def _window(isovalues, data_range):
    low, high = data_range
    try:
        lo, hi = (float(isovalue) for isovalue in isovalues)
    except (TypeError, ValueError):
        raise LeaflightError(
            f"The isovalue window must be two numbers, not {isovalues!r}."
        ) from None
    if not (np.isfinite([lo, hi]).all() and lo < hi):
        raise LeaflightError(
            f"The isovalue window {lo:g}..{hi:g} is empty: give the lower value first, "
            "then the higher."
        )
    if hi <= low or lo >= high:
        raise LeaflightError(
            f"The isovalue window {lo:g}..{hi:g} lies outside the data, whose values are "
            f"{low:g}..{high:g}: give a window that overlaps them."
        )
    return lo, hi


def fixed_work(error, time, given):
    """The research settings, all of them, where one is given; None where the work is rounds.

    error, time: as of bake(), None where they were not asked for. given: each of FIXED_WORK by its
    name, None where it was not. Raises SettingError where both ways were asked for.
    """
    asked = {name: value for name, value in given.items() if value is not None}
    limits = {"error": error, "time": time}
    limits = [name for name, value in limits.items() if value is not None]
    if not asked:
        return None
    if limits:
        names = ", ".join(name.replace("_", " ") for name in asked)
        raise SettingError(
            f"A bake either does a fixed amount of work ({names}) or goes on until it reaches an "
            f"error or a time: leave out the {' and the '.join(limits)}, or the others.",
            *limits,
        )
    return {**FIXED_WORK, **asked}


def round_settings(kind, dims, *, error=None, time=None, **common):
    """The core's settings, a kind (_core.BakeSettings or BakeSettings2), of a bake in rounds.

    error: in percent, where the bake may end, None is DEFAULT_ERROR; time: seconds after which it
    ends with the round in progress, None for no limit. common: see _common. Raises LeaflightError.
    """
    settings = _common(kind, dims, **common)
    settings.samples = 0
    settings.error = _positive("error", DEFAULT_ERROR if error is None else error, "percent")
    settings.seconds = 0.0 if time is None else _positive("time", time, "seconds")
    return settings


def fixed_settings(
    kind,
    dims,
    *,
    samples,
    photons,
    caustic_photons=None,
    estimator="gather",
    photon_map=None,
    scattered=None,
    only_at=None,
    **common,
):
    """The core's settings of a bake that does a fixed amount of work.

    caustic_photons: None is as many as photons. photon_map: PhotonMap, None for the thesis's.
    scattered: Scattered, None for samples in each texel. only_at: world points (n, D), None for
    all texels. The rest as for round_settings. Raises LeaflightError.
    """
    settings = _common(kind, dims, **common)
    settings.samples = whole("samples", samples, 1)
    settings.photons = whole("photons", photons, 1)
    caustic_photons = photons if caustic_photons is None else caustic_photons
    settings.caustic_photons = whole("caustic_photons", caustic_photons, 0)
    settings.estimator = estimator
    if only_at is not None:
        if len(only_at) == 0:
            raise LeaflightError("only_at holds no points: give some, or None for all texels.")
        settings.set_only_at(np.ascontiguousarray(only_at, dtype=np.float64))
    if photon_map is not None:
        if estimator != "thesis":
            raise LeaflightError(
                f'The photon map belongs to the estimator "thesis", not to "{estimator}": '
                "leave it out or choose that estimator."
            )
        whole("k", photon_map.k, 2)
        settings.set_photon_map(*astuple(photon_map))
    if scattered is not None:
        whole("count", scattered.count, 1)
        if np.ndim(scattered.isovalues) == 0:
            whole("isovalues", scattered.isovalues, 1)
        whole("radius", scattered.radius, 0)
        settings.set_scattered(*astuple(scattered))
    return settings


def _common(
    kind,
    dims,
    *,
    resolution,
    seed,
    threads,
    exposure=1.0,
    both_sides=False,
    surroundings=False,
):
    """What both ways have, for nodes dims.

    resolution: None, one number along the longest axis, or one for each axis. exposure: radiance
    times this is a displayed colour. Raises LeaflightError.
    """
    settings = kind()
    settings.resolution = _texels(resolution, dims)
    settings.seed = whole("seed", seed, 0)
    settings.threads = whole("threads", threads, 0)
    settings.exposure = exposure
    settings.both_sides = bool(both_sides)
    settings.surroundings = bool(surroundings)
    return settings


def _texels(resolution, dims):
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


def whole(name, value, least):
    """The value as an int of at least `least`. Raises LeaflightError."""
    if not least <= value < 2**31 or value != int(value):
        raise LeaflightError(f"{name} must be a whole number in {least}..{2**31 - 1}, not {value}.")
    return int(value)


def _positive(name, value, unit):
    """The value as a float above 0. Raises SettingError."""
    value = float(value)
    if not (np.isfinite(value) and value > 0):
        raise SettingError(f"The {name} must be a number of {unit} above 0, not {value:g}.", name)
    return value
