# SPDX-License-Identifier: GPL-3.0-or-later
"""What tells bakes apart, and the volumes that they were made of."""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..io.scene_file import scene_to_json
from ..version import __version__

# Settings of bakes that do a fixed amount of work, empty of others.
RESEARCH = (
    "samples",
    "photons",
    "caustic_photons",
    "soft_spacing",
    "refine",
    "estimator",
    "photon_map",
    "scattered",
    "only_at_sha256",
)
# What a bake depends on, as text; "name" would rename the grid that OpenVDB attaches it to.
# "volumes" is a list of {"name", "source", "values_sha256", "index_to_world", "resolution",
# "capped"}; "error" in percent and "rounds" are empty where the amount of work was fixed.
METADATA = (
    "leaflight_version",
    "volumes",
    "scene",
    "scene_sha256",
    "isovalues",
    "error",
    "rounds",
    "seed",
    "both_sides",
    "surroundings",
    *RESEARCH,
)
# What a file is that lacks some of it.
EARLIER = "this is a bake of an earlier Leaflight; bake the volume again"


class Stamp:
    """The metadata of a bake, most of which is the same after each of its rounds."""

    def __init__(self, volumes, description, window, settings, fixed):
        """settings: _core.BakeSettings; fixed: the research settings, None for rounds."""
        self._volumes = [
            {
                "name": volume.name,
                "source": volume.source,
                "values_sha256": values_sha256(volume),
                "index_to_world": np.asarray(volume.index_to_world, np.float64).tolist(),
                "capped": look.capped,
            }
            for volume, look in zip(volumes, description.leaves)
        ]
        self._goes_by_rounds = fixed is None
        scene = scene_to_json(description)
        self._shared = {
            "leaflight_version": __version__,
            "scene": scene,
            "scene_sha256": hashlib.sha256(scene.encode()).hexdigest(),
            "isovalues": json.dumps(window),
            "error": json.dumps(settings.error) if fixed is None else "",
            **_research(settings, fixed),
            "seed": str(settings.seed),
            "both_sides": json.dumps(settings.both_sides),
            "surroundings": json.dumps(settings.surroundings),
        }

    def metadata(self, grids, rounds):
        """Text by the keys METADATA, after so many rounds that left these grids."""
        volumes = [
            {**volume, "resolution": list(grid.resolution)}
            for volume, grid in zip(self._volumes, grids)
        ]
        return {
            **self._shared,
            "volumes": json.dumps(volumes),
            "rounds": str(rounds) if self._goes_by_rounds else "",
        }


def _research(settings, fixed):
    if fixed is None:
        return {key: "" for key in RESEARCH}
    photon_map, scattered, only_at = (fixed[k] for k in ("photon_map", "scattered", "only_at"))
    return {
        "samples": str(settings.samples),
        "photons": str(settings.photons),
        "caustic_photons": str(settings.caustic_photons),
        "soft_spacing": str(settings.soft_spacing),
        "refine": str(settings.refine),
        "estimator": settings.estimator,
        "photon_map": json.dumps(photon_map and asdict(photon_map)),
        "scattered": json.dumps(scattered and asdict(scattered)),
        "only_at_sha256": "" if only_at is None else sha256(np.float64(only_at)),
    }


def id_of(metadata):
    """The id of the bake with this metadata: 32 digits."""
    text = json.dumps([metadata[key] for key in METADATA])
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def read_bake_id(path):
    """The id of the bake that a file holds, whatever its name; reads the first bytes alone.

    Raises LeaflightError for any other file.
    """
    if not Path(path).is_file():
        raise LeaflightError(f"{path}: there is no such file; give the .vdb that bake wrote.")
    header = _core.read_bake_header(str(path))
    if "id" not in header:
        what = EARLIER if "statistics" in header else "this is no bake; bake the volume again"
        raise LeaflightError(f"{path}: {what}.")
    return header["id"]


def values_sha256(volume):
    """Tells the values of volumes apart, wherever they stand; the same once they were in a file."""
    # A file keeps neither the sign of a zero nor which NaN marks a voxel without a value.
    values = volume.values + np.float32(0.0)
    values[np.isnan(values)] = np.nan
    return sha256(values)


def sha256(*arrays):
    """Of the types, shapes and bytes of arrays."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(str((array.dtype.str, array.shape)).encode())
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()
