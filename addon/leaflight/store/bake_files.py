# SPDX-License-Identifier: GPL-3.0-or-later
"""The paths of bake files, and the file that lights each object.

A bake has an id, a hash of all its inputs, which its file contains. Each bake has a separate file,
NAME_ID.vdb, with the first digits of the id. Baking again therefore never overwrites a bake that
undo, an older .blend or another .blend in the folder still shows. An object stores the id of its
bake and the path to try first. A file is identified by the id in it, not by its name or folder. A
moved bake is therefore found again, and another bake in its place is not mistaken for it.

Bakes of a .blend that was never saved lie in the user's Leaflight folder, in a folder of this
session. Saving moves them into leaflight/ beside the .blend and makes their paths relative. Blender
adapts such paths neither on Save As nor on append. Objects therefore also store the folder where
their bake was last found.

Only the user deletes bakes (Remove Unused Bakes), because undo or another .blend may need them.
"""

import os
import re
import shutil
import time
from pathlib import Path

import bpy
from leaflight import LeaflightError
from leaflight.bake.provenance import read_bake_id
from leaflight.io.output import replaced

from .. import session
from . import atlases, frame_bakes, preferences

# Folder of bakes beside the .blend.
FOLDER = "leaflight"

# Number of digits of the id in a file's name.
_DIGITS = 12

# Prefix of the folders of sessions.
_UNSAVED = "unsaved_"

# Seconds without a change after which the folder of an unsaved .blend counts as abandoned.
_GIVEN_UP = 7 * 24 * 3600

_SESSION = time.strftime(f"{_UNSAVED}%Y%m%d_%H%M%S_{os.getpid()}")

# Cache: path -> (state of the file, its id or the LeaflightError on reading it).
_ids = session.cache()


def user_folder():
    """Returns the folder from the preferences, or else the user's Leaflight folder.

    Updates of the add-on leave the folder as it is.
    """
    chosen = preferences.cache_folder()
    if chosen is not None:
        return chosen
    package = preferences.PACKAGE
    if package.startswith("bl_ext."):
        return Path(bpy.utils.extension_path_user(package))
    return Path(bpy.utils.user_resource("DATAFILES", path="leaflight"))


def session_folder():
    """Returns the folder for bakes of a .blend that is not yet saved."""
    return user_folder() / _SESSION


def folders_of_unsaved():
    """Returns the folders of this session and of abandoned sessions."""
    user = user_folder()
    folders = sorted(user.glob(f"{_UNSAVED}*")) if user.is_dir() else []
    oldest = time.time() - _GIVEN_UP
    return [f for f in folders if f.name == _SESSION or f.stat().st_mtime < oldest]


def remove_if_empty(folder):
    """Removes a folder of an unsaved .blend if it is empty. Raises OSError."""
    if folder.parent == user_folder() and not any(folder.iterdir()):
        folder.rmdir()


def folder_for(obj):
    """Returns the folder for new bakes of an object: the chosen one or the default."""
    chosen = obj.leaflight.bake_folder
    if chosen:
        return Path(bpy.path.abspath(chosen))
    if bpy.data.filepath:
        return Path(bpy.data.filepath).parent / FOLDER
    return session_folder()


def make_folder(folder):
    """Makes a folder for files unless it exists. Raises LeaflightError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(
            f"{folder}: cannot make this folder: {error.strerror}; choose another."
        ) from None


def path_for(folder, name, identifier):
    """Returns a path in a folder for a bake of an object of this name.

    The path is free or has the same bake.
    """
    full = f"{stem(name)}_{identifier[:_DIGITS]}"
    path, number = folder / f"{full}.vdb", 1
    while path.exists() and not holds(path, identifier):
        number += 1
        path = folder / f"{full}-{number}.vdb"
    return path


def stem(name):
    """Returns the name of an object with underscores for characters that file names lack."""
    return re.sub(r"[^\w.-]+", "_", name)


def state_of(path):
    """Returns the inode, size and time of change of a file, or None if there is no file."""
    try:
        state = os.stat(path)
    except OSError:
        return None
    return state.st_ino, state.st_size, state.st_mtime_ns


def id_in(path):
    """Returns the id of the bake in a file. Raises LeaflightError if the file is no bake."""
    path, state = str(path), state_of(path)
    if path not in _ids or _ids[path][0] != state:
        try:
            _ids[path] = state, read_bake_id(path)
        except LeaflightError as error:
            _ids[path] = state, error
    found = _ids[path][1]
    if isinstance(found, LeaflightError):
        raise LeaflightError(str(found))
    return found


def holds(path, identifier):
    """True if a file exists and holds the bake of this id."""
    try:
        return id_in(path) == identifier
    except LeaflightError:
        return False


def locate(obj):
    """Finds the file of the bake that lights an object. Raises LeaflightError if there is none."""
    settings = obj.leaflight
    paths = _remembered(obj)
    for path in paths:
        if holds(path, settings.bake_id):
            return path
    for folder in places(obj):
        for path in bakes_in(folder):
            if id_in(path) == settings.bake_id:
                return path
    for path in paths:
        if path.is_file():
            id_in(path)  # raises the reason if the file is no bake
            raise LeaflightError(
                f'{path}: this is not the bake of "{obj.name}": relocate the bake, or bake again.'
            )
    raise LeaflightError(
        f'{paths[0]}: the bake of "{obj.name}" is missing here and in folders of other bakes: '
        "relocate the bake, or bake again."
    )


def remember(obj, path):
    """Stores the path of an object's bake, relative to the .blend if that is saved."""
    if obj.library is not None:
        return
    settings = obj.leaflight
    values = {"bake_path": portable(path), "bake_home": path.parent.as_posix()}
    for name, value in values.items():
        # Assign only new values, because Blender propagates each assignment as a change.
        if getattr(settings, name) != value:
            setattr(settings, name, value)


def portable(path):
    """Returns a path with slashes, which every system reads.

    It is relative to the .blend if that is saved on the same drive.
    """
    if bpy.data.filepath:
        try:
            return bpy.path.relpath(str(path)).replace(os.sep, "/")
        except ValueError:
            pass
    return path.as_posix()


def bakes_in(folder):
    """Returns the paths of all bakes in a folder, which need not exist."""
    found = []
    for path in sorted(folder.glob("*.vdb")) if folder.is_dir() else ():
        try:
            id_in(path)
        except LeaflightError:
            continue
        found.append(path)
    return found


def places(obj):
    """Returns the existing folders that may hold the bake of an object."""
    folders = [path.parent for path in _remembered(obj)]
    for base in _bases(obj):
        folders += [base / FOLDER, base]
    if obj.leaflight.bake_folder:
        folders.append(folder_for(obj))
    user = user_folder()
    # Skip folders that begin with a dot: they hold files that are being written.
    folders += sorted(user.glob("[!.]*")) if user.is_dir() else []
    return [folder for folder in dict.fromkeys(folders) if folder.is_dir()]


def _remembered(obj):
    """Returns the last paths of the bake, with `//` resolved for each .blend of the object."""
    settings = obj.leaflight
    if settings.bake_path.startswith("//"):
        paths = [bpy.path.abspath(settings.bake_path, start=str(base)) for base in _bases(obj)]
    else:
        paths = [settings.bake_path]
    if settings.bake_home:
        paths.append(os.path.join(settings.bake_home, bpy.path.basename(settings.bake_path)))
    return [Path(os.path.normpath(path)) for path in dict.fromkeys(paths)]


def _bases(obj):
    """Returns the folders of the .blend files that an object may come from, libraries first.

    A library override has the values of its library until a property is overridden.
    """
    libraries = [obj.library]
    if obj.override_library is not None and obj.override_library.reference is not None:
        libraries.append(obj.override_library.reference.library)
    files = [bpy.path.abspath(library.filepath) for library in libraries if library is not None]
    files += [bpy.data.filepath] if bpy.data.filepath else []
    return [Path(os.path.normpath(file)).parent for file in files]


def move_along(objects):
    """Moves the bakes of these objects from the folder of this session to beside the .blend.

    Returns (True if any path changed, {full name of an object: why its bake was not moved}).
    """
    changed, problems = False, {}
    for obj in (obj for obj in objects for _ in frame_bakes.each_baked(obj)):
        try:
            path = locate(obj)
        except LeaflightError:
            continue
        if path.parent == session_folder() and bpy.data.filepath:
            try:
                path = _move(path, obj)
            except (OSError, LeaflightError) as error:
                why = getattr(error, "strerror", None) or str(error).rstrip(".")
                problems[obj.name_full] = (
                    f"{path}: the bake cannot be moved beside the .blend: {why}; it stays here."
                )
        before = obj.leaflight.bake_path, obj.leaflight.bake_home
        remember(obj, path)
        changed |= before != (obj.leaflight.bake_path, obj.leaflight.bake_home)
    return changed, problems


def _move(path, obj):
    """Moves a bake with its atlases, all of them or none, and returns its new path.

    Raises OSError or LeaflightError.
    """
    folder = folder_for(obj)
    folder.mkdir(parents=True, exist_ok=True)
    target = path_for(folder, obj.name, obj.leaflight.bake_id)
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
    remove_if_empty(path.parent)
    return target


def _copy(old, new):
    """Links a file if both paths are on one disk, or else copies it.

    The new name appears only after the file is complete.
    """
    with replaced(new) as partial:
        try:
            os.link(old, partial)
        except OSError:
            shutil.copyfile(old, partial)
