# SPDX-License-Identifier: GPL-3.0-or-later
"""Live: light that follows lamps, walls, volumes and cuts that move, once there is a bake.

Direct light of the new position comes first, over the indirect light of the bake. The passes of a
new bake follow, until the light is final. A newer position cancels the passes of an older one, but
not its direct light. A lamp that is dragged therefore shows light on its way.
"""

import math
import threading
import time
from dataclasses import replace

import bpy
import leaflight
from leaflight import LeaflightError
from leaflight.bake.moved_scene import QUICK, WHOLE, lit_walls, moved

from ..operators import checks, failures, jobs
from ..props import BoolProperty
from ..show import changed_data, isovalues, preview, surface_material, surface_object, walls
from ..show import whole_detail
from ..stage import staleness
from ..store import cache
from ..store.reading import StillReading
from ..translations import iface_
from . import bake, stopped

# Seconds between two polls of work in progress.
_POLL = 0.05

# Texels times light points of maps, and vertices times light points of walls, for about half a
# second of work. Above them blurred shadows come first.
_QUICK_MAPS, _QUICK_WALLS = 50_000_000, 500_000

# Seconds for drawing the viewport above which a move waits for direct light, and the longest wait.
_SLOW_PICTURE, _LONGEST_WAIT = 0.2, 1.0

# LiveJob in progress and its BackgroundWork, or None.
_job = _work = None
# Time at the end of the last poll. Longest time between two polls, which Blender spent on drawing
# rough light.
_looked_at, _picture = 0.0, 0.0
# True if the scene may have changed since the last poll.
_has_changed = False
# LiveJob.state whose light was stopped or failed, and a sentence about it.
_left, _why = None, ""


class LiveJob(bake.BakeJob):
    """A bake of the present scene that begins with direct light over older indirect light."""

    name = "Live"

    def __init__(self, context, obj):
        """Exports the scene. Raises LeaflightError as BakeJob, or if volumes have other bakes."""
        super().__init__(context, obj)
        volumes = [bpy.data.objects[name] for name in self.names]
        if any(other.leaflight.bake_id != obj.leaflight.bake_id for other in volumes):
            raise LeaflightError("Volumes were added or removed since the bake: bake again.")
        self._lit, self._whole = cache.light_of(obj), cache.whole_of(obj)
        self._with_present_values = changed_data.with_present_values(volumes)
        # Write no checkpoint, because each move starts a new bake.
        path = self.checkpoint.path.with_suffix(".live")
        self.checkpoint = replace(self.checkpoint, path=path, seconds=math.inf)
        self.is_outdated = self._can_be_cancelled = False
        self._has_direct = threading.Event()
        self.is_rough = self._map_work() > _QUICK_MAPS
        # Equal for equal scenes and data.
        self.state = self.fingerprint, [state.changes for state in self.states]

    def run(self, progress):
        try:
            self._pass_after_direct(progress)
        finally:
            self._has_direct.set()

    def _pass_after_direct(self, progress):
        # The amount of work is unknown before the passes.
        progress.expect(math.inf)
        self._lit = self._whole(progress)
        lit = self._with_present_values(self._lit)
        known = {name: self._arguments[name] for name in ("volumes", "scene", "isovalues")}
        blurs_maps, blurs_walls = self.is_rough, self._wall_work() > _QUICK_WALLS
        self.latest = moved(lit, **known, quick=blurs_maps, walls=False, progress=progress)
        self._has_direct.set()
        self.latest = lit_walls(self.latest, QUICK if blurs_walls else WHOLE, progress)
        self._can_be_cancelled = True
        self._check()
        if blurs_maps:
            sharp = moved(lit, **known, walls=False, progress=progress)
            self.is_rough = False
            self.latest = replace(sharp, walls=self.latest.walls)
        if blurs_walls:
            self.latest = lit_walls(self.latest, WHOLE, progress)
        super().run(progress)

    def wait_for_direct(self, seconds):
        """Waits for direct light up to this many seconds. Returns True if it can be shown."""
        return self._has_direct.wait(seconds)

    def _map_work(self):
        """Returns the number of texels times light points."""
        return sum(
            math.prod(grid.map_resolution) * len(grid.direct.light_points)
            for grid in self._lit.grids
            if grid.map_resolution
        )

    def _wall_work(self):
        """Returns the number of vertices times light points."""
        walls = self._lit.walls
        if walls is None:
            return 0
        vertices = sum(len(walls.mesh(number)[0]) for number in range(walls.count))
        points = [len(grid.direct.light_points) for grid in self._lit.grids if grid.map_resolution]
        return vertices * max(points, default=0)

    def _check(self):
        if self.is_outdated:
            raise leaflight.Cancelled

    def coarsen(self):
        for name in self.names:
            surface_object.coarsen_all(bpy.data.objects[name])

    def outdate(self, work):
        """Ends the work once its direct light is finished, because the scene has changed."""
        self.is_outdated = True
        if self._can_be_cancelled:
            work.cancel()

    def show(self):
        if self.latest is not None and self.latest.is_moved:
            self._quiet_until = 0.0
        super().show()


def changed(scene, at_once=False):
    """Starts to follow a scene after a change that may concern its bakes.

    at_once: True if work may start before Blender draws the change. Drawing is slow without a
    graphics card.
    """
    global _has_changed
    if not _is_in_window() or not scene.leaflight_live:
        return
    _has_changed = True
    if at_once and _job is None and not bpy.app.is_job_running("RENDER"):
        _look()
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.0)


def _is_in_window():
    """True if Blender has a window. Scripts without a window start their bakes themselves."""
    return not bpy.app.background


def at_work():
    """Returns the BackgroundWork in progress, or None."""
    return _work


def sentence():
    """Returns why the present light is not final after work has ended, or an empty text."""
    return _why


def stop():
    """Cancels the work in progress. The present light stays until something moves again."""
    if _work is not None:
        _work.cancel()


def forget():
    """Stops the work and resets the state, before another file is opened."""
    global _job, _work, _has_changed, _left, _why
    stop()
    _job, _work, _has_changed, _left, _why = None, None, False, None, ""
    whole_detail.hold(False)


def _tick():
    """Follows the scene. Catches all errors, because Blender drops a timer that raises."""
    try:
        return _follow()
    except Exception as error:
        forget()
        _give_up(error)
        return None


def _give_up(error):
    global _why
    _why = failures.sentence_of(error)
    jobs.redraw_panels()


def _follow():
    global _looked_at, _picture
    if bpy.app.is_job_running("RENDER"):
        _looked_at = 0.0
        return _POLL
    if _job is not None and _job.is_rough and _looked_at:
        _picture = max(_picture, time.perf_counter() - _looked_at)
    if _has_changed:
        _look()
    if _job is not None:
        _go_on()
    whole_detail.hold(_job is not None and _job.is_rough)
    goes_on = _job is not None or _has_changed
    _looked_at = time.perf_counter() if goes_on else 0.0
    return _POLL if goes_on else None


def _look():
    """Starts the work for the present scene, or ends the work for an earlier state."""
    global _has_changed, _left, _why
    if _job is not None and _job.is_outdated:
        return
    if jobs.running() is not None or stopped.offered() is not None:
        if _job is not None:
            _job.outdate(_work)
        return
    _has_changed = False
    try:
        wanted = _wanted(bpy.context)
    except StillReading:
        # changed() is called once it is read.
        wanted = None
    except LeaflightError as error:
        wanted = None
        _give_up(error)
    if _job is not None:
        if wanted is None or wanted.state != _job.state:
            _job.outdate(_work)
    elif wanted is not None and wanted.state != _left:
        _left, _why = None, ""
        _begin(wanted)


def _wanted(context):
    """Returns the LiveJob that the present scene needs, or None. Raises LeaflightError."""
    global _left, _why
    scene = context.scene
    obj = _leader(scene)
    if obj is None or not scene.leaflight_live:
        return None
    change = staleness.change_since_bake(context, obj)
    if change in (*staleness.OF_THE_SCENE, staleness.CUT):
        return LiveJob(context, obj)
    _left, _why = None, ""
    if not change and _job is None and preview.of(obj) is not None:
        # Everything is back in the position of the bake, so show the bake.
        surface_object.forget_passes()
        walls.refresh(scene)
    return None


def _leader(scene):
    """Returns the lit volume whose settings count: the last active one, or the first."""
    volumes = [obj for obj in isovalues.volumes(scene) if obj.leaflight.bake_id and not obj.library]
    active = scene.objects.get(scene.leaflight.active_volume)
    return active if active in volumes else next(iter(volumes), None)


def _begin(job):
    global _job, _work, _picture
    _job, _work = job, jobs.BackgroundWork(job)
    # Show direct light or coarse surfaces before Blender draws. Drawing full detail would delay the
    # light, and light that arrives during a draw would wait for the next.
    if _picture > _SLOW_PICTURE and job.wait_for_direct(_LONGEST_WAIT):
        _work.show()
    elif job.is_rough:
        job.coarsen()
    _picture = 0.0
    jobs.redraw_panels()


def _go_on():
    """Shows the progress of the work, or its result."""
    global _job, _work, _has_changed, _left, _why
    job, work = _job, _work
    jobs.redraw_panels()
    if work.is_alive():
        work.show()
        return
    _job = _work = None
    is_baked = False
    try:
        work.result()
        is_baked = True
        job.apply()
    except leaflight.Cancelled:
        work.show()
        surface_material.forget_first_light()
        if not job.is_outdated:
            _left, _why = (
                job.state,
                iface_(
                    "Stopped: direct light is current, indirect light is of an earlier position"
                ),
            )
    except Exception as error:
        _left, _why = job.state, failures.sentence_of(error)
        if is_baked:
            job.failed()
        else:
            surface_material.forget_first_light()
    if job.is_outdated:
        _has_changed = True
        _look()


class LEAFLIGHT_OT_stop_live(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Stop"
    bl_description = "Keep the shown light until an object moves again. Esc does the same"
    bl_options = set()
    conditions = (checks.needs(lambda _: _work, "Nothing is in progress"),)

    def run(self, _context):
        stop()


def _switched(scene, _context):
    global _left
    _left = None
    if scene.leaflight_live:
        staleness.forget()
        changed(scene)
    else:
        stop()


# (keymap, item) of Esc. Modal operators of Blender, such as a drag, get the key first.
_keys = []

PROPERTIES = (
    (
        bpy.types.Scene,
        "leaflight_live",
        BoolProperty(
            "Live",
            "Update the light while lamps, walls, volumes and clip boxes move: direct light at "
            "once, indirect light by the passes of a new bake. The last pass is saved "
            "to a new file",
            update=_switched,
        ),
    ),
)


def register():
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:
        keymap = keys.keymaps.new(name="Window", space_type="EMPTY")
        item = keymap.keymap_items.new(LEAFLIGHT_OT_stop_live.bl_idname, "ESC", "PRESS")
        _keys.append((keymap, item))


def unregister():
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    forget()
