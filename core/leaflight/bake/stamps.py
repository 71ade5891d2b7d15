# SPDX-License-Identifier: GPL-3.0-or-later
"""What tells bakes apart, and the volumes that they were made of."""

import hashlib
import json
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError

# What a bake depends on, as text; "name" would rename the grid that OpenVDB attaches it to.
# "volumes" is a list of {"name", "source", "values_sha256", "index_to_world", "resolution",
# "capped"}.
METADATA = (
    "leaflight_version",
    "volumes",
    "scene",
    "scene_sha256",
    "isovalues",
    "samples",
    "photons",
    "caustic_photons",
    "soft_spacing",
    "refine",
    "estimator",
    "photon_map",
    "scattered",
    "seed",
    "both_sides",
    "surroundings",
    "only_at_sha256",
)


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
        what = "a bake of an earlier Leaflight" if "statistics" in header else "no bake"
        raise LeaflightError(f"{path}: this is {what}; bake the volume again.")
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
