# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake, checked: the window of isovalues and how much work is done."""

from dataclasses import astuple, dataclass

import numpy as np

from .._core import LeaflightError
from ..volume.volume import default_window


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


def bake_settings(
    kind,
    dims,
    *,
    resolution,
    samples,
    photons,
    caustic_photons,
    estimator,
    seed,
    threads,
    photon_map=None,
    scattered=None,
    soft_spacing=1,
    refine=0,
    exposure=1.0,
    both_sides=False,
    surroundings=False,
    only_at=None,
):
    """The core's settings, a kind (_core.BakeSettings or BakeSettings2) for nodes dims.

    resolution: None, one number along the longest axis, or one for each axis. caustic_photons:
    None is as many as photons. photon_map: PhotonMap, None for the thesis's.
    scattered: Scattered, None for samples in each texel. only_at: world points (n, D), None for
    all texels. Raises LeaflightError.
    """
    settings = kind()
    settings.resolution = _texels(resolution, dims)
    settings.samples = whole("samples", samples, 1)
    settings.photons = whole("photons", photons, 1)
    caustic_photons = photons if caustic_photons is None else caustic_photons
    settings.caustic_photons = whole("caustic_photons", caustic_photons, 0)
    settings.estimator = estimator
    settings.seed = whole("seed", seed, 0)
    settings.threads = whole("threads", threads, 0)
    settings.soft_spacing = whole("soft_spacing", soft_spacing, 1)
    settings.refine = whole("refine", refine, 0)
    settings.exposure = exposure
    settings.both_sides = bool(both_sides)
    settings.surroundings = bool(surroundings)
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
