# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: one radiance grid for every isosurface of a volume, and what to do with it."""

import hashlib
import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import _core
from ._core import LeaflightError
from .output import check_writable
from .scene import SceneDescription, core_scene, fit_scene
from .scene_file import cornell_box, scene_from_json, scene_to_json
from .version import __version__
from .volume import Volume, default_window

# What a bake depends on, as text; "name" would rename the grid that OpenVDB attaches it to.
METADATA = (
    "leaflight_version",
    "volume_name",
    "source",
    "field_sha256",
    "scene",
    "scene_sha256",
    "isovalues",
    "resolution",
    "samples",
    "photons",
    "estimator",
    "seed",
)


@dataclass(frozen=True, eq=False)
class Surface:
    """One lit isosurface in world coordinates.

    vertices, normals (outward, unit), radiance (W/(m^2 sr), linear RGB): float32 (n, 3);
    triangles: int32 (m, 3); seconds: the time contouring and lookup took.
    """

    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    radiance: np.ndarray
    seconds: float


@dataclass(frozen=True, eq=False)
class Bake:
    """A volume, the scene in world coordinates it was lit in, and the radiance of all its leaves.

    isovalues: (lo, hi), the baked window. grid: _core.RadianceGrid. statistics: seconds, rays,
    rays_per_second, texels, peak_memory_bytes, skipped_passes. metadata: text by key, everything
    the result depends on; equal bakes have equal metadata.
    """

    volume: Volume
    scene: SceneDescription
    isovalues: tuple
    grid: object
    statistics: dict
    metadata: dict

    def save(self, path):
        """Writes the bake as one .vdb under its final name or not at all. Raises LeaflightError."""
        check_writable(path, ".vdb")
        metadata = dict(self.metadata, statistics=json.dumps(self.statistics))
        _core.write_bake(str(path), self.volume.field(), self.grid, metadata)

    def surface(self, isovalue):
        """The isosurface with its radiance, a Surface. Raises LeaflightError outside the window."""
        self.check_isovalue(isovalue)
        field = self.volume.field()
        start = time.perf_counter()
        vertices, normals, triangles = _core.contour(field, isovalue)
        radiance = self.radiance(vertices)
        seconds = time.perf_counter() - start
        return Surface(vertices, normals, triangles, radiance, seconds)

    def radiance(self, points):
        """Baked radiance, float32 (n, 3), at world points (n, 3); zero where no leaf passes."""
        return self.grid.lookup(self.volume.field(), points)

    def reference(self, points, isovalue, spp=1024, seed=0, threads=0, progress=None):
        """Path-traced radiance at points (n, 3) of the isosurface, on its outer side.

        Returns (radiance, standard_error), float32 (n, 3) each. Raises LeaflightError, Cancelled.
        """
        self.check_isovalue(isovalue)
        scene = core_scene(self.scene, self.volume.field(), self.isovalues)
        progress = progress or _core.Progress()
        return _core.reference(scene, points, isovalue, spp, seed, threads, progress)

    def check_isovalue(self, isovalue):
        """Raises LeaflightError unless the baked window and the data hold the isovalue."""
        lo, hi = self.isovalues
        if not lo <= isovalue <= hi:
            raise LeaflightError(
                f"Isovalue {isovalue:g} lies outside the baked window {lo:g}..{hi:g}: choose one "
                "inside or bake again with a wider window (--isovalues)."
            )
        low, high = self.volume.field().range
        if not low < isovalue <= high:
            raise LeaflightError(
                f"Isovalue {isovalue:g} lies outside the data, whose values are {low:g}..{high:g}: "
                "no isosurface exists there, choose one inside."
            )


def bake(
    volume,
    scene=None,
    *,
    isovalues=None,
    resolution=None,
    samples=32,
    photons=2_000_000,
    estimator="gather",
    seed=0,
    threads=0,
    progress=None,
):
    """Computes the radiance of every isosurface of the volume whose isovalue lies in the window.

    scene: SceneDescription, fitted around the volume; None is the Cornell box.
    isovalues: (lo, hi) in data units; None takes default_window(volume).
    resolution: texels along the longest axis (the other axes in proportion of their nodes), or
        (nx, ny, nz); None is one texel a node.
    samples: rays per texel; photons: number of photons; estimator: "gather", "volumetric", "path".
    seed: same seed, same result, whatever the threads; threads: 0 takes every core.
    progress: _core.Progress to poll or cancel from another thread.
    Returns a Bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    field = volume.field()
    description = fit_scene(scene or cornell_box(), volume)
    window = default_window(volume) if isovalues is None else _window(isovalues, field.range)
    settings = _core.BakeSettings()
    settings.resolution = _texels(resolution, field.dims)
    settings.samples = _whole("samples", samples, 1)
    settings.photons = _whole("photons", photons, 0)
    settings.estimator = estimator
    settings.seed = _whole("seed", seed, 0)
    settings.threads = _whole("threads", threads, 0)

    grid = _core.bake(
        core_scene(description, field, window), settings, progress or _core.Progress()
    )

    scene_text = scene_to_json(description)
    metadata = {
        "leaflight_version": __version__,
        "volume_name": volume.name,
        "source": volume.source,
        "field_sha256": _sha256(volume.values, volume.index_to_world),
        "scene": scene_text,
        "scene_sha256": hashlib.sha256(scene_text.encode()).hexdigest(),
        "isovalues": json.dumps(window),
        "resolution": json.dumps(tuple(grid.resolution)),
        "samples": str(samples),
        "photons": str(photons),
        "estimator": estimator,
        "seed": str(seed),
    }
    statistics = dict(grid.statistics)
    statistics["rays_per_second"] = statistics["rays"] / max(statistics["seconds"], 1e-9)
    return Bake(volume, description, window, grid, statistics, metadata)


def load_bake(path):
    """Reads what Bake.save wrote. Raises LeaflightError for any other file."""
    if not Path(path).is_file():
        raise LeaflightError(f"{path}: there is no such file; give the .vdb that bake wrote.")
    try:
        values, index_to_world, grid, metadata = _core.read_bake(str(path))
        isovalues = json.loads(metadata["isovalues"])
        statistics = json.loads(metadata["statistics"])
        lo, hi = (float(isovalue) for isovalue in isovalues)
        scene = scene_from_json(metadata["scene"], str(path))
        # OpenVDB adds text of its own.
        metadata = {key: metadata[key] for key in METADATA}
    except (KeyError, TypeError, ValueError):
        raise LeaflightError(
            f"{path}: this .vdb lacks the metadata of a bake; bake the volume again."
        ) from None
    volume = Volume(values, index_to_world, metadata["volume_name"], str(path))
    return Bake(volume, scene, (lo, hi), grid, statistics, metadata)


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


def _texels(resolution, dims):
    if resolution is None:
        return (0, 0, 0)
    if np.ndim(resolution) == 0:
        longest = _whole("resolution", resolution, 2)
        return tuple(max(2, round(longest * n / max(dims))) for n in dims)
    if len(resolution) != 3:
        raise LeaflightError("The resolution must be one number of texels or three, (nx, ny, nz).")
    return tuple(_whole("resolution", n, 2) for n in resolution)


def _whole(name, value, least):
    if not least <= value < 2**31 or value != int(value):
        raise LeaflightError(f"{name} must be a whole number in {least}..{2**31 - 1}, not {value}.")
    return int(value)


def _sha256(*arrays):
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(str((array.dtype.str, array.shape)).encode())
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()
