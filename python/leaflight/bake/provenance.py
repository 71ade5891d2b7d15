# SPDX-License-Identifier: GPL-3.0-or-later
"""Provenance: everything that the light of a bake depends on."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..paths import AnyPath
from ..scene.lights import Color
from ..scene.scene import Isosurfaces
from ..version import __version__
from ..volume.regions import cuts_to_record, frozen
from ..volume.volume import Volume
from .settings import CoreSettings

_IN_PASSES = (_core.BakeSettings, _core.BakeSettings2)

# Version of the file, as in core/src/io/bake_file.cpp.
_VERSION = "2"

# Message about a file of another version.
EARLIER = "this bake was made by an earlier version of Leaflight; bake the volume again"


@dataclass(frozen=True)
class VolumeRecord:
    """The record of a volume that was baked. The other fields are those of Volume and Isosurfaces.

    values_sha256: Result of values_sha256().
    index_to_world: Four rows of the matrix.
    resolution: Texels along each axis, () before the first pass.
    map_resolution: Texels of the visibility maps, () if there are none.
    """

    name: str
    source: str
    values_sha256: str
    index_to_world: tuple[tuple[float, ...], ...]
    unit: str
    capped: bool
    patient: bool
    smooth_normals: float
    cuts: dict[str, Any] | None
    resolution: tuple[int, ...] = ()
    map_resolution: tuple[int, ...] = ()


@dataclass(frozen=True)
class Provenance:
    """Everything that the light of a bake depends on; equal bakes have equal ones.

    volumes: A VolumeRecord of each volume.
    scene: Text of a scene file.
    isovalues: The isovalue range.
    seed, both_sides, walls, error: As for bake(). error is None with fixed settings.
    asked_resolution: Resolution that the user asked for, or zeros.
    passes, blocks: Numbers of passes and blocks of indirect light in the averages. Fixed settings
        have none.
    continued: Id of the bake that this one resumed, or "".
    fixed: Settings of a fixed number of samples (validation/thesis), or None.
    lamps: Strength (r, g, b) of each lamp of a bake that relit() made, which is never saved; else
        None.
    """

    volumes: tuple[VolumeRecord, ...]
    scene: str
    isovalues: tuple[float, float]
    seed: int
    both_sides: bool
    walls: bool
    error: float | None
    asked_resolution: tuple[int, ...]
    passes: int = 0
    blocks: int = 0
    continued: str = ""
    fixed: dict[str, Any] | None = None
    lamps: tuple[Color, ...] | None = None
    leaflight_version: str = __version__

    @cached_property
    def id(self) -> str:
        """Identifier of 32 hexadecimal digits, different for different bakes."""
        return hashlib.sha256(self.to_json().encode()).hexdigest()[:32]

    def to_json(self) -> str:
        return json.dumps(asdict(self), sort_keys=True)

    def after(
        self,
        grids: Sequence[_core.RadianceGrid | _core.RadianceGrid2],
        passes: int = 0,
        blocks: int = 0,
        continued: str = "",
    ) -> "Provenance":
        """Returns the Provenance of the bake with these grids, passes and blocks."""
        volumes = tuple(
            replace(
                volume,
                resolution=tuple(grid.resolution),
                map_resolution=_map_resolution(grid),
            )
            for volume, grid in zip(self.volumes, grids)
        )
        return replace(self, volumes=volumes, passes=passes, blocks=blocks, continued=continued)

    def with_volumes(self, **changes: Any) -> "Provenance":
        """Returns a copy with these fields in the record of each volume."""
        return replace(self, volumes=tuple(replace(one, **changes) for one in self.volumes))

    def alike(self, other: "Provenance") -> bool:
        """Returns True if the bakes differ only in progress and in the sources of volumes."""
        return self._asked() == other._asked()

    def _asked(self) -> "Provenance":
        asked = self.with_volumes(name="", source="", resolution=(), map_resolution=())
        return replace(asked, passes=0, blocks=0, continued="")


def _map_resolution(grid: _core.RadianceGrid | _core.RadianceGrid2) -> tuple[int, ...]:
    if isinstance(grid, _core.RadianceGrid2):
        return tuple(grid.map_resolution or ())
    # A moved grid has other visibility maps than its bake.
    return tuple(grid.direct.resolution) if grid.direct else ()


def provenance_of(
    volumes: Sequence[Volume],
    isosurfaces: Sequence[Isosurfaces],
    scene: str,
    isovalue_range: tuple[float, float],
    settings: CoreSettings,
    fixed: Mapping[str, Any] | None = None,
) -> Provenance:
    """Returns the Provenance of a bake before its first pass.

    isosurfaces: of each volume. scene: the text of a scene file. settings: of the core. fixed: the
    settings of a fixed number of samples, or None.
    """
    records = tuple(
        VolumeRecord(
            volume.name,
            volume.source,
            values_sha256(volume),
            frozen(np.asarray(volume.index_to_world, np.float64).tolist()),
            volume.unit,
            material.capped,
            volume.patient,
            volume.smooth_normals,
            cuts_to_record(volume.cuts),
        )
        for volume, material in zip(volumes, isosurfaces)
    )
    lo, hi = map(float, isovalue_range)
    return Provenance(
        volumes=records,
        scene=scene,
        isovalues=(lo, hi),
        seed=settings.seed,
        both_sides=settings.both_sides,
        walls=settings.walls,
        error=settings.error if isinstance(settings, _IN_PASSES) else None,
        asked_resolution=tuple(settings.resolution) if fixed is None else (),
        fixed=frozen(fixed),
    )


def provenance_from_json(text: str) -> Provenance:
    """Reads the text of to_json(). Raises KeyError, TypeError, ValueError for any other text."""
    record = frozen(json.loads(text))
    volumes = tuple(VolumeRecord(**volume) for volume in record.pop("volumes"))
    found = Provenance(volumes=volumes, **record)
    texts = [found.scene, found.continued, found.leaflight_version]
    for volume in volumes:
        texts += [volume.name, volume.source, volume.values_sha256, volume.unit]
    numbers = [found.seed, found.passes, found.blocks, *found.isovalues]
    numbers += [volume.smooth_normals for volume in volumes]
    numbers += [] if found.error is None else [found.error]
    if not all(isinstance(text, str) for text in texts):
        raise TypeError("a text is not a text")
    if not all(isinstance(number, (int, float)) for number in numbers):
        raise TypeError("a number is not a number")
    if len(found.isovalues) != 2 or found.lamps is not None:
        raise ValueError("the isovalue range is missing, or there are lamps")
    return found


def read_bake_id(path: AnyPath) -> str:
    """Returns the id of the bake in a file. Reads only its first bytes.

    Raises LeaflightError for any other file.
    """
    try:
        if not Path(path).is_file():
            raise LeaflightError(f"{path}: there is no such file; give a .vdb written by bake.")
        header = _core.read_bake_header(path)
    except OSError as error:
        raise LeaflightError(f"{path}: cannot read it: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise LeaflightError(f"{path}: this bake is damaged; fetch it again.") from None
    if "id" not in header or header.get("version") != _VERSION:
        what = EARLIER if "statistics" in header else "this is not a bake; bake the volume again"
        raise LeaflightError(f"{path}: {what}.")
    return header["id"]


def values_sha256(volume: Volume) -> str:
    """Returns a hash of the values of a volume, independent of its position and its number type.

    Values that were saved and loaded have the same hash.
    """
    digest = hashlib.sha256(_kind(np.dtype(np.float32), volume.values.shape))
    for plane in volume.values:
        # A file does not keep the sign of a zero, nor the bits of a NaN.
        plane = plane.astype(np.float32, order="C") + np.float32(0.0)
        plane[np.isnan(plane)] = np.nan
        digest.update(plane)
    return digest.hexdigest()


def sha256(*arrays: Array) -> str:
    """Returns the hash of the types, shapes and bytes of arrays."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(_kind(array.dtype, array.shape))
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _kind(dtype: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    return str((dtype.str, shape)).encode()
