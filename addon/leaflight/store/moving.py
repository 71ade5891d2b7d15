# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes of an unsaved .blend move along when it is saved."""

import os
import shutil

import bpy
import leaflight

from . import atlases, bake_files

LeaflightError = leaflight.LeaflightError


def move_along(objects):
    """Moves the bakes of these objects out of the folder of this session to beside the .blend.

    Returns (whether any path changed, {full name of an object: why its bake was not moved}).
    """
    changed, problems = False, {}
    for obj in objects:
        try:
            path = bake_files.locate(obj)
        except LeaflightError:
            continue
        if path.parent == bake_files.session_folder() and bpy.data.filepath:
            try:
                path = _move(path, obj)
            except OSError as error:
                problems[obj.name_full] = (
                    f"{path}: the bake could not be moved beside the .blend and stays there: "
                    f"{error.strerror or error}."
                )
        before = obj.leaflight.bake_path, obj.leaflight.bake_home
        bake_files.remember(obj, path)
        changed |= before != (obj.leaflight.bake_path, obj.leaflight.bake_home)
    return changed, problems


def _move(path, obj):
    """Moves a bake with its atlases, all of them or none, and returns its new path.

    Raises OSError.
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
    except OSError:
        for new in done:
            new.unlink()
        raise
    for old, _ in moves:
        old.unlink()
    bake_files.remove_if_empty(path.parent)
    return target


def _copy(old, new):
    """Under its final name it is whole or absent; on the same disk it is the same file."""
    partial = new.with_name(f".{new.name}.{os.getpid()}.part")
    try:
        try:
            os.link(old, partial)
        except OSError:
            shutil.copyfile(old, partial)
        os.replace(partial, new)
    finally:
        partial.unlink(missing_ok=True)
