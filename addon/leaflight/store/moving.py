# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes of an unsaved .blend move along when it is saved."""

import os
import shutil

import bpy
from leaflight import LeaflightError
from leaflight.io.output import replaced

from . import atlases, bake_files, frame_bakes


def move_along(objects):
    """Moves the bakes of these objects out of the folder of this session to beside the .blend.

    Returns (whether any path changed, {full name of an object: why its bake was not moved}).
    """
    changed, problems = False, {}
    for obj in (obj for obj in objects for _ in frame_bakes.each_baked(obj)):
        try:
            path = bake_files.locate(obj)
        except LeaflightError:
            continue
        if path.parent == bake_files.session_folder() and bpy.data.filepath:
            try:
                path = _move(path, obj)
            except (OSError, LeaflightError) as error:
                why = getattr(error, "strerror", None) or str(error).rstrip(".")
                problems[obj.name_full] = (
                    f"{path}: the bake could not be moved beside the .blend and stays there: {why}."
                )
        before = obj.leaflight.bake_path, obj.leaflight.bake_home
        bake_files.remember(obj, path)
        changed |= before != (obj.leaflight.bake_path, obj.leaflight.bake_home)
    return changed, problems


def _move(path, obj):
    """Moves a bake with its atlases, all of them or none, and returns its new path.

    Raises OSError or LeaflightError.
    """
    folder = bake_files.folder_for(obj)
    folder.mkdir(parents=True, exist_ok=True)
    target = bake_files.path_for(folder, obj.name, obj.leaflight.bake_id)
    moves = [(old, atlases.renamed(old, path, target)) for old in atlases.beside(path)]
    moves.append((path, target))
    done = []
    try:
        for old, new in moves:
            before = new.exists()
            _copy(old, new)
            done += [] if before else [new]
    except (OSError, LeaflightError):
        for new in done:
            new.unlink()
        raise
    for old, _ in moves:
        old.unlink()
    bake_files.remove_if_empty(path.parent)
    return target


def _copy(old, new):
    """Under its final name it is whole or absent; on the same disk it is the same file."""
    with replaced(new) as partial:
        try:
            os.link(old, partial)
        except OSError:
            shutil.copyfile(old, partial)
