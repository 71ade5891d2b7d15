# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads bakes from their files."""

import json
from dataclasses import replace

import leaflight._core as _core

from .._core import LeaflightError
from ..io.reader_process import ReaderProcess
from ..io.scene_file import scene_from_json
from ..paths import AnyPath
from ..volume.regions import cuts_from_record
from ..volume.units import METERS
from ..volume.volume import Volume
from .baked import Bake
from .provenance import EARLIER, provenance_from_json, read_bake_id
from .statistics import statistics_from_record


def load_bake(path: AnyPath) -> Bake:
    """Reads a file that Bake.save wrote. Raises LeaflightError for any other file."""
    progress = _core.Progress()
    return with_walls(*open_bake(path, progress), progress)


def with_walls(bake: Bake, walls: _core.WallRadiance | None, progress: _core.Progress) -> Bake:
    """Returns a bake of open_bake() with its walls attached. Raises LeaflightError, Cancelled."""
    if walls is None:
        return bake
    _core.attach_walls(walls, bake.core_scene(), progress)
    return replace(bake, walls=walls)


def open_bake(path: AnyPath, progress: _core.Progress) -> tuple[Bake, _core.WallRadiance | None]:
    """Returns a bake without its walls, and the walls for with_walls().

    The direct light of walls may take a minute. Raises LeaflightError, Cancelled.
    """
    identifier = read_bake_id(path)
    if not _core.has_seal(path):
        # The file may be incomplete: an earlier Leaflight or another program wrote it, or it was
        # cut.
        with ReaderProcess(path, "OpenVDB file", __name__, "can_be_read") as process:
            try:
                process.answer()
            except ValueError:
                raise LeaflightError(f"{path}: this bake is damaged; fetch it again.") from None
    try:
        fields, grids, walls, metadata = _core.read_bake(path, progress)
        if "provenance" not in metadata:
            raise LeaflightError(f"{path}: {EARLIER}.")
        provenance = provenance_from_json(metadata["provenance"])
        statistics = statistics_from_record(json.loads(metadata["statistics"]))
        lo, hi = map(float, provenance.isovalues)
        scene = scene_from_json(provenance.scene, str(path))
        records = provenance.volumes
        if not len(records) == len(fields) == len(grids) == len(scene.isosurfaces):
            raise ValueError("the number of volumes differs")
        if not {"", *METERS} >= {record.unit for record in records}:
            raise ValueError("there is no such unit")
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError):
        raise LeaflightError(
            f"{path}: this .vdb lacks the metadata of a bake; bake the volume again."
        ) from None
    volumes = [
        Volume(
            values,
            matrix,
            record.name,
            str(path),
            record.unit,
            bool(record.patient),
            record.smooth_normals,
            cuts=cuts_from_record(record.cuts),
        )
        for (values, matrix), record in zip(fields, records)
    ]
    for volume in volumes:
        volume.field()
    # Texels of fixed samples hold the color.
    if provenance.fixed is None:
        grids = [
            grid.with_texture(material.texture_on(volume.field()))
            for grid, material, volume in zip(grids, scene.isosurfaces, volumes)
        ]
    bake = Bake(volumes, scene, (lo, hi), grids, None, statistics, provenance)
    if bake.id != identifier:
        raise LeaflightError(
            f"{path}: its metadata were edited after the bake; bake the volume again."
        )
    _add_direct_light(bake)
    return bake, walls


def _add_direct_light(bake: Bake) -> None:
    """Gives the grids of a file their direct light."""
    core = bake.core_scene()
    for number, (grid, record) in enumerate(zip(bake.grids, bake.provenance.volumes)):
        if record.map_resolution:
            try:
                direct = grid.stored_direct(core, number)
            except LeaflightError as error:
                raise LeaflightError(f"{bake.volume.source}: {error}") from None
            grid.add_direct(bake.volumes[number].field(), direct)


def can_be_read(path: str) -> tuple[None, tuple[()]]:
    """Raises LeaflightError unless the file is a bake. Run it in a subprocess: it may crash."""
    _core.read_bake(path)
    return None, ()
