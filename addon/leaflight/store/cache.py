# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache of bakes, by id, and of volumes, by their source or bake.

Nothing here is saved with the scene or refers to a Blender object. Neither undo nor loading a file
can therefore invalidate it. Missing entries are read again from their files.
"""

import threading
from contextlib import contextmanager, suppress

import bpy
import numpy as np
from leaflight import LeaflightError

from .. import session
from . import bake_files, reading, source_files
from .reading import StillReading


class _Readings(dict):
    """The Readings in progress, by the key of their result in a cache."""

    def clear(self):
        for begun in self.values():
            begun.cancel()
        super().clear()


_volumes = session.cache()
_bakes = session.cache()
_readings = session.cache(_Readings)
# Thread-local: `now` is True within waiting().
_waits = threading.local()
# Functions that a timer calls while files are read. Their arguments are the Progress, None at the
# end, and True if a step of a reading has ended since the last call.
watching = []

# Bytes of voxels above which unused volumes and bakes are freed. Playback loads many frames.
_MOST = 2 << 30

# Seconds between two polls of files that are being read.
_POLL = 0.04

# Cache: id of a bake or key of a volume -> (state of its file, why it could not be read).
_damaged = session.cache()


@contextmanager
def waiting(waits=True):
    """Lets volume_of() and light_of() wait for files in this thread, in place of StillReading."""
    before, _waits.now = getattr(_waits, "now", False), waits
    try:
        yield
    finally:
        _waits.now = before


def volume_of(obj):
    """Returns the volume that an object shows, in local coordinates. Raises as light_of().

    The volume of the bake takes precedence over the source file, which may have changed.
    """
    key = _baked_key(obj)
    if key is not None:
        if key not in _volumes:
            _volumes[key] = _volume_of_bake(obj)
        return _volumes[key]
    return _source_volume(obj)


def slices_of(obj):
    """Returns the values on the faces of a volume's capped cuts, in local coordinates.

    Raises as light_of().
    """
    return _source_volume(obj, slices=True)


def world_volume(obj):
    """Returns volume_of() in world space. Raises as light_of()."""
    # If the object has not moved since the bake, return exactly the baked volume.
    if _baked_key(obj) is not None and _flat(obj.matrix_world) == list(obj.leaflight.bake_matrix):
        return light_of(obj).volumes[obj.leaflight.bake_index]
    return _in_world(obj, volume_of(obj))


def volume_to_bake(obj):
    """Returns the volume in world space for a new bake. Raises as light_of().

    The file is read again if it has changed since the last bake.
    """
    if obj.leaflight.bake_id and source_files.changed_since_bake(obj):
        return _in_world(obj, _source_volume(obj))
    volume = world_volume(obj)
    # The source of a loaded bake's volume is the bake itself; the object may store a better one.
    source = source_files.source_of(obj.leaflight) or volume.source
    return volume.placed(volume.index_to_world, source=source)


def placed(volume, index_to_world):
    """Returns a volume in Blender's coordinates, which have neither a patient's axes nor a unit."""
    return volume.placed(index_to_world, unit="", patient=False)


def keep_volume(obj, volume):
    """Caches the volume that was read for an object without a bake."""
    settings = obj.leaflight
    _volumes[source_files.key_of(settings)] = _moved(volume, source_files.from_file(settings))


def bake_of(obj):
    """Returns the bake that lights an object, with lit walls. Raises LeaflightError.

    Waits for its file and the light of the walls. Returns None before the first bake.
    """
    with waiting():
        light_of(obj)
        _keep(obj.leaflight.bake_id)
        return light_of(obj)


def light_of(obj):
    """Returns the bake that lights an object, perhaps without the light of its walls.

    In a window, a thread reads its file and then lights the walls, which takes up to a minute.
    Returns None before the first bake. Raises LeaflightError, and StillReading before the file is
    read.
    """
    identifier = obj.leaflight.bake_id
    is_read = _reading_of_bake(obj) is None
    return _bakes.get(identifier) if is_read else _first(obj, identifier)


def whole_of(obj):
    """Returns a function that takes a Progress and returns the bake with lit walls.

    The function may run in any thread and waits until the Progress is canceled. Both raise
    LeaflightError.
    """
    begun, bake = _reading_of_bake(obj), _bakes.get(obj.leaflight.bake_id)
    return begun.result if begun is not None else lambda _progress: bake


def progress_of(obj):
    """Returns the Progress of the reading of an object's bake or volume, or None."""
    if not _readings:
        return None
    settings = obj.leaflight
    keys = settings.bake_id, source_files.key_of(settings), _key_of_slices(settings)
    return next((_readings[key].progress for key in keys if key in _readings), None)


def lacks_walls(obj):
    """True if the bake that lights an object is still read, or its walls are not yet lit."""
    begun = _readings.get(obj.leaflight.bake_id)
    return begun is not None and begun.is_alive()


def _reading_of_bake(obj):
    """Returns the Reading of an object's bake. Returns None before the first, and once it is read.

    Raises LeaflightError.
    """
    identifier = obj.leaflight.bake_id
    if not identifier or identifier in _bakes:
        return None
    if identifier not in _readings:
        path = bake_files.locate(obj)
        _begin(obj, identifier, path, reading.steps_of_bake(path))
    return _readings.get(identifier)


def _begin(obj, key, path, steps):
    """Reads a file: in a thread, or at once for playback and without a window.

    A damaged file is read again only after it has changed. steps: see Reading. Raises
    LeaflightError.
    """
    state = bake_files.state_of(path)
    known, error = _damaged.get(key, (None, None))
    if error is not None and known == state:
        raise LeaflightError(error)
    _make_room()
    _readings[key] = reading.Reading(path, state, steps)
    if bpy.app.background or obj.leaflight.frames > 1:
        try:
            _keep(key)
        finally:
            _readings.pop(key, None)
    elif not bpy.app.timers.is_registered(_watch):
        bpy.app.timers.register(_watch, first_interval=0.0, persistent=True)


def _first(obj, key):
    """Returns the first result of the Reading of a key. Raises LeaflightError, StillReading."""
    begun = _readings[key]
    if begun.found is None and not getattr(_waits, "now", False):
        raise StillReading(
            f'"{obj.name}": {begun.path} is still being read: wait until the status bar shows no '
            "progress."
        )
    begun.wait_for_first()
    if begun.found is None:
        _keep(key)
    return begun.found


def _keep(key):
    """Waits for the last result of the Reading of a key, and caches it. Raises LeaflightError."""
    begun = _readings.get(key)
    if begun is None:
        return
    # The id of a bake is a text, the key of a volume is not.
    cache = _bakes if isinstance(key, str) else _volumes
    try:
        cache.setdefault(key, begun.result())
    except LeaflightError as problem:
        _damaged[key] = begun.state, str(problem)
        raise


def _watch():
    """Polls the readings from a timer, and returns the seconds until the next call."""
    has_news = False
    # Blender must not change what it renders. A render has waited for the files that it needs.
    if not bpy.app.is_job_running("RENDER"):
        ended = [key for key, begun in _readings.items() if not begun.is_alive()]
        has_news = any([begun.has_news() for begun in _readings.values()])
        for key in ended:
            with suppress(LeaflightError):
                _keep(key)
            _readings.pop(key)
    first = next(iter(_readings.values()), None)
    for call in watching:
        call(None if first is None else first.progress, has_news)
    # A call may have begun another reading.
    return _POLL if _readings else None


def grid_of(obj):
    """Returns the radiance grid of an object's bake, or None. Raises as light_of()."""
    bake = light_of(obj)
    return bake.grids[obj.leaflight.bake_index] if bake is not None else None


def keep_bake(bake):
    _bakes[bake.id] = bake


def values_sha256(bake, index):
    """Returns the hash of a volume's values in a bake (leaflight.bake.provenance.values_sha256)."""
    return bake.provenance.volumes[index].values_sha256


def forget_unused():
    """Frees volumes and bakes that no object of the file refers to."""
    settings = [obj.leaflight for obj in bpy.data.objects if obj.leaflight.is_volume]
    keys = (source_files.key_of, _key_in_bake, _key_of_slices, _key_of_uncut)
    volumes = {key_of(s) for key_of in keys for s in settings}
    bakes = {s.bake_id for s in settings}
    for cache, kept in ((_volumes, volumes), (_bakes, bakes)):
        for key in [key for key in cache if key not in kept]:
            del cache[key]


def _make_room():
    volumes = [*_volumes.values(), *(one for bake in _bakes.values() for one in bake.volumes)]
    if sum(volume.values.nbytes for volume in volumes) > _MOST:
        forget_unused()


def _source_volume(obj, slices=False):
    settings = obj.leaflight
    if not settings.source:
        raise LeaflightError(
            f'"{obj.name}" has no volume file, only its bake: relocate the bake, keep Capped as '
            "baked, or import the volume."
        )
    key = _key_of_slices(settings) if slices else source_files.key_of(settings)
    if key not in _volumes and key not in _readings:
        _begin(obj, key, source_files.path_of(settings), _steps_of_volume(settings, slices))
    return _volumes[key] if key in _volumes else _first(obj, key)


def _key_of_slices(settings):
    return ("slices", *source_files.key_of(settings))


def _key_of_uncut(settings):
    return _uncut(
        source_files.path_of(settings),
        source_files.choices_of(settings),
        source_files.file_state(settings),
    )[0]


def _uncut(path, choices, state):
    """Returns (a key, the choices) of a volume before its cuts by clip boxes, and these cuts."""
    before, cuts = source_files.before_box(choices["regions"])
    choices = {**choices, "regions": before}
    return ("uncut", path, *choices.values(), state), choices, cuts


def read(path, choices, state, progress):
    """Reads a volume with CHOICES of source_files. Raises LeaflightError.

    Values before cuts by clip boxes stay in memory, because a box may move on.
    state: source_files.file_state().
    """
    key, before, cuts = _uncut(path, choices, state)
    if not cuts:
        return source_files.read_volume(path, progress, **choices)
    if key not in _volumes:
        _volumes[key] = source_files.read_volume(path, progress, **before)
    return source_files.changed(_volumes[key], cuts, progress)


def _steps_of_volume(settings, slices):
    """Returns the steps of a Reading of the volume in a file, in the object's coordinates.

    slices: True reads slices_of() it.
    """
    path, choices = source_files.path_of(settings), source_files.choices_of(settings)
    from_file, is_capped = source_files.from_file(settings), settings.capped
    state = source_files.file_state(settings)

    def steps(progress):
        progress.begin("Reading the volume")
        if slices:
            volume = source_files.read_slices(path, progress, **choices)
        else:
            volume = read(path, choices, state, progress)
        yield _moved(volume.capped() if is_capped and not slices else volume, from_file)

    return steps


def _moved(volume, matrix):
    return volume.placed(matrix @ volume.index_to_world)


def _baked_key(obj):
    """Returns a key of the volume in an object's bake.

    Returns None if the object has no readable bake or shows its volume otherwise than baked. Raises
    StillReading.
    """
    settings = obj.leaflight
    try:
        bake = light_of(obj)
    except StillReading:
        raise
    except LeaflightError:
        return None
    if bake is None or bake.scene.isosurfaces[settings.bake_index].capped != settings.capped:
        return None
    if source_files.values_changed(settings):
        return None
    return _key_in_bake(settings)


def _key_in_bake(settings):
    return settings.bake_id, settings.bake_index, tuple(settings.bake_matrix)


def _volume_of_bake(obj):
    settings = obj.leaflight
    local_to_world = np.array(settings.bake_matrix, np.float64).reshape(4, 4)
    baked = light_of(obj).volumes[settings.bake_index]
    index_to_local = np.linalg.inv(local_to_world) @ baked.index_to_world
    return placed(baked, index_to_local)


def _in_world(obj, volume):
    index_to_world = np.array(obj.matrix_world, np.float64) @ volume.index_to_world
    return placed(volume, index_to_world)


def _flat(matrix):
    return [x for row in matrix for x in row]
