# SPDX-License-Identifier: GPL-3.0-or-later
"""The record of a bake that each lit object stores."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
from leaflight.bake.statistics import is_limited_by_texels, outcome

from ..show import display, isovalues, lamps, surface_object, walls
from ..store import bake_files, cache, source_files


@dataclass(frozen=True)
class StateAtBake:
    """The state of a volume object at the start of its bake.

    matrix: The object's transform, 16 numbers by rows.
    file_state: State of the volume's file.
    changes: Changes of the volume's values since the import.
    frame: Its frame.
    """

    matrix: Sequence[float]
    file_state: str
    changes: str
    frame: int

    @classmethod
    def of(cls, obj):
        settings = obj.leaflight
        return cls(
            [x for row in obj.matrix_world for x in row],
            source_files.file_state(settings),
            source_files.changes_of(settings),
            settings.frame,
        )


def light(obj, bake, index, path, columns, state, fingerprint, seconds):
    """Stores a bake in a volume object. show() then shows its light.

    index: Number of the volume in the bake.
    path: Path of the bake's file.
    columns: Columns of the atlas, 0 without one.
    state: A StateAtBake.
    fingerprint: Fingerprint of the scene at the bake.
    seconds: Duration of the bake.
    """
    settings = obj.leaflight
    settings.bake_index = index
    settings.bake_matrix = state.matrix
    settings.bake_low, settings.bake_high = isovalue_range(bake, index)
    settings.bake_walls = bake.walls is not None
    settings.bake_fingerprint = fingerprint
    settings.bake_lamps = lamps.record(bake, bake.scene.lights)
    settings.bake_changes = state.changes
    settings.bake_seconds = seconds
    settings.bake_outcome = outcome(bake)
    settings.bake_target = bake.provenance.error or 0
    settings.bake_error = bake.statistics.estimated_error_percent if settings.bake_target else 0
    settings.bake_needs_texels = is_limited_by_texels(bake)
    settings.bake_values = cache.values_sha256(bake, index)
    settings.bake_file_state = state.file_state
    settings.atlas_columns = columns
    settings.bake_id = bake.id
    bake_files.remember(obj, path)


def isovalue_range(bake, index):
    """Returns the isovalues (low, high) of a volume at the ends of the bake's isovalue range."""
    return tuple(bake.isovalue_of(index, c) for c in bake.isovalues)


def show(volumes, leader, scene):
    """Shows volume objects, and the walls of a scene or None, with the light of their new bake.

    leader: the volume whose isovalue the others follow.
    """
    cache.forget_unused()
    for obj in volumes:
        surface_object.update(obj, obj.leaflight.isovalue)
        surface_object.update_all(obj)
        for surface in display.surfaces_of(obj):
            isovalues.limit(surface)
    if scene is not None:
        # Rebuild the displays, because the previous bake may have other vertices.
        walls.forget_names(scene)
        walls.refresh(scene)
    isovalues.set_isovalue(leader, leader.leaflight.isovalue)


def objects_lit_by(identifier):
    """Returns the objects that the bake of this id lights, including linked objects."""
    volumes = (obj for obj in bpy.data.objects if obj.leaflight.is_volume)
    return [obj for obj in volumes if obj.leaflight.bake_id == identifier]
