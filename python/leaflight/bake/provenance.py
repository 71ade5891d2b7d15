# SPDX-License-Identifier: GPL-3.0-or-later
"""What tells bakes apart, and the volumes that they were made of."""

import hashlib
import json
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..io.scene_file import scene_to_json
from ..version import __version__

# What a bake depends on, as text; "name" would rename the grid that OpenVDB attaches it to.
# "volumes" is a list of {"name", "source", "values_sha256", "index_to_world", "unit", "resolution",
# "capped", "patient"}. "map_resolution": of the maps that lookups compute direct light from, a list
# with null for a volume without, empty where there are none. "error": in percent;
# "asked_resolution": zeros for none; "blocks": of indirect light, how many its averages hold;
# "continued": the id of the bake that this one went on with. "fixed": the settings of a bake with
# fixed samples (../thesis), for which those are empty; empty of any other.
METADATA = (
    "leaflight_version",
    "volumes",
    "scene",
    "scene_sha256",
    "isovalues",
    "error",
    "asked_resolution",
    "map_resolution",
    "passes",
    "blocks",
    "continued",
    "seed",
    "both_sides",
    "walls",
    "fixed",
)
# What a file is that lacks some of it.
EARLIER = "this is a bake of an earlier Leaflight; bake the volume again"


def provenance(volumes, description, window, settings, fixed=None):
    """The metadata of a bake before its first pass.

    settings: of the core; fixed: what depends on those of fixed samples, None where there are none.
    """
    records = [
        {
            "name": volume.name,
            "source": volume.source,
            "values_sha256": values_sha256(volume),
            "index_to_world": np.asarray(volume.index_to_world, np.float64).tolist(),
            "unit": volume.unit,
            "capped": look.capped,
            "patient": volume.patient,
        }
        for volume, look in zip(volumes, description.isosurfaces)
    ]
    scene = scene_to_json(description)
    return {
        "leaflight_version": __version__,
        "volumes": json.dumps(records),
        "scene": scene,
        "scene_sha256": hashlib.sha256(scene.encode()).hexdigest(),
        "isovalues": json.dumps(window),
        "error": json.dumps(settings.error) if fixed is None else "",
        "asked_resolution": json.dumps(settings.resolution) if fixed is None else "",
        "map_resolution": "",
        "passes": "",
        "blocks": "",
        "continued": "",
        "seed": str(settings.seed),
        "both_sides": json.dumps(settings.both_sides),
        "walls": json.dumps(settings.walls),
        "fixed": "" if fixed is None else json.dumps(fixed),
    }


def provenance_after(metadata, grids, passes=0, blocks=0, continued=""):
    """The metadata of a bake with these grids after so many passes and blocks of light.

    metadata: of provenance(), or of a bake that it goes on with, whose id is `continued`.
    """
    volumes = [
        {**volume, "resolution": list(grid.resolution)}
        for volume, grid in zip(json.loads(metadata["volumes"]), grids)
    ]
    changed = {"volumes": json.dumps(volumes)}
    maps = [grid.map_resolution for grid in grids]
    changed["map_resolution"] = json.dumps(maps) if any(maps) else ""
    if not metadata["fixed"]:
        changed["passes"] = str(passes)
        changed["blocks"] = str(blocks) if blocks else ""
        changed["continued"] = continued
    return {**metadata, **changed}


def id_of(metadata):
    """The id of the bake with this metadata: 32 digits."""
    # Of a bake whose lamps have other strengths (relit.py), which no file holds.
    lamps = [metadata["lamps"]] if "lamps" in metadata else []
    text = json.dumps([metadata[key] for key in METADATA] + lamps)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def read_bake_id(path):
    """The id of the bake that a file holds, whatever its name; reads the first bytes alone.

    Raises LeaflightError for any other file.
    """
    try:
        if not Path(path).is_file():
            raise LeaflightError(f"{path}: there is no such file; give the .vdb that bake wrote.")
        header = _core.read_bake_header(path)
    except OSError as error:
        raise LeaflightError(f"{path}: cannot read it: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise LeaflightError(f"{path}: this bake is damaged; fetch it again.") from None
    if "id" not in header:
        what = EARLIER if "statistics" in header else "this is no bake; bake the volume again"
        raise LeaflightError(f"{path}: {what}.")
    return header["id"]


def values_sha256(volume):
    """Tells the values of volumes apart, wherever they stand and whatever type holds them.

    The same once they were in a file.
    """
    digest = hashlib.sha256(_kind(np.dtype(np.float32), volume.values.shape))
    for plane in volume.values:
        # A file keeps neither the sign of a zero nor which NaN marks a voxel without a value.
        plane = plane.astype(np.float32, order="C") + np.float32(0.0)
        plane[np.isnan(plane)] = np.nan
        digest.update(plane)
    return digest.hexdigest()


def sha256(*arrays):
    """Of the types, shapes and bytes of arrays."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(_kind(array.dtype, array.shape))
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


def _kind(dtype, shape):
    return str((dtype.str, shape)).encode()
