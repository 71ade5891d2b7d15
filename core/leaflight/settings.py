# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake, checked: the window of isovalues and how much work is done."""

import numpy as np

from ._core import LeaflightError
from .volume import default_window


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
    both_sides=False,
    surroundings=False,
):
    """The core's settings, a kind (_core.BakeSettings or BakeSettings2) for nodes dims.

    resolution: None, one number along the longest axis, or one for each axis. caustic_photons:
    None is as many as photons. Raises LeaflightError.
    """
    settings = kind()
    settings.resolution = _texels(resolution, dims)
    settings.samples = _whole("samples", samples, 1)
    settings.photons = _whole("photons", photons, 1)
    caustic_photons = photons if caustic_photons is None else caustic_photons
    settings.caustic_photons = _whole("caustic_photons", caustic_photons, 0)
    settings.estimator = estimator
    settings.seed = _whole("seed", seed, 0)
    settings.threads = _whole("threads", threads, 0)
    settings.both_sides = bool(both_sides)
    settings.surroundings = bool(surroundings)
    return settings


def _texels(resolution, dims):
    if resolution is None:
        return (0,) * len(dims)
    if np.ndim(resolution) == 0:
        longest = _whole("resolution", resolution, 2)
        return tuple(max(2, round(longest * n / max(dims))) for n in dims)
    if len(resolution) != len(dims):
        raise LeaflightError(
            f"The resolution must be one number of texels or {len(dims)}, one for each axis."
        )
    return tuple(_whole("resolution", n, 2) for n in resolution)


def _whole(name, value, least):
    if not least <= value < 2**31 or value != int(value):
        raise LeaflightError(f"{name} must be a whole number in {least}..{2**31 - 1}, not {value}.")
    return int(value)
