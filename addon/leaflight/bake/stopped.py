# SPDX-License-Identifier: GPL-3.0-or-later
"""Stop, and the choice after it: Keep Bake or Throw Away."""

import bpy
import leaflight
from leaflight import LeaflightError

from ..operators import background, checks, jobs
from ..show import surface_object, walls

# BakeJob that was stopped after a pass, until the user decides.
_offered = None


def offer(job):
    """Offers the user in the panel to keep the last pass of a BakeJob. None ends the offer."""
    global _offered
    _offered = job


def offered():
    """Returns the BakeJob that waits for the user's decision, or None."""
    return _offered


is_decided = checks.needs(lambda _: _offered is None, "Keep or throw away the stopped bake first")
_waits = checks.needs(lambda _: _offered is not None, "No bake was stopped")


def save_offered():
    """Writes an offered bake to its file, before another .blend is opened."""
    global _offered
    job, _offered = _offered, None
    if job is None:
        return
    try:
        job.write()
    except LeaflightError as error:
        print(f"Leaflight: the bake that was stopped is lost: {error}")
    else:
        print(f"Leaflight: the bake that was stopped is kept as {job.path}")


class LEAFLIGHT_OT_stop_bake(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Stop"
    bl_description = (
        "Stop the work in progress, as Esc does. You can keep the finished light of a bake"
    )
    bl_options = set()
    conditions = (checks.needs(lambda _: jobs.running(), "Nothing is in progress"),)

    def run(self, _context):
        jobs.cancel_running()


class KeepJob(jobs.Job):
    """Writes the files of a bake that was stopped, and lights the volumes by it."""

    def __init__(self, job):
        self._job = job
        self.warnings = job.warnings

    def run(self, progress):
        progress.begin("Writing the bake")
        self._job.write()
        if progress.cancelled:
            raise leaflight.Cancelled
        progress.begin("Showing the light")

    def apply(self):
        offer(None)
        return self._job.apply()

    def failed(self):
        self._job.failed()

    def ended(self):
        return "The bake was not saved; you can still keep it"


class LEAFLIGHT_OT_keep_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Keep Bake"
    bl_description = "Save the light of the stopped bake, and show it"
    conditions = (jobs.is_free, _waits)

    def start(self, _context):
        return KeepJob(_offered)


class LEAFLIGHT_OT_throw_bake_away(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Throw Away"
    bl_description = "Discard the stopped bake, and restore the previous light"
    conditions = (jobs.is_free, _waits)

    def run(self, context):
        _offered.checkpoint.remove()
        offer(None)
        surface_object.forget_passes()
        walls.refresh(context.scene)
