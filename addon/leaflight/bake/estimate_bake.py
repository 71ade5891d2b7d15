# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimate: the time and the memory that a bake will need."""

import bpy
import leaflight
from leaflight.bake.estimate import pilot

from .. import session
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..show import bake_properties
from ..stage import scene_export
from ..translations import iface_
from . import bake

# Properties on which an estimate depends, in addition to the scene.
_SETTINGS = (
    "source",
    "frame",
    "low",
    "high",
    "use_resolution",
    "resolution",
    "both_sides",
    "light_walls",
    "capped",
    "regions",
    "smooth",
    "smooth_normals",
    "hide",
)

# Full name of an object -> (its settings at the estimate, the error of the pilot, the Pilot).
_pilots = session.cache()


def estimate_of(obj, error=None):
    """Returns the Estimate for an object with its present settings, or None.

    error: another target error than that of the settings.
    """
    key, finest, made = _pilots.get(obj.name_full, (None, None, None))
    error = obj.leaflight.error if error is None else error
    # The tolerance covers single-precision settings.
    if key != _key(obj.leaflight) or error < finest - 1e-6:
        return None
    return made.estimate(error, bake.time_limit(obj.leaflight))


def sentence(estimate):
    """Returns a sentence about an Estimate for the panel."""
    figures = duration(estimate), memory(estimate), f"{estimate.error:.2g}"
    return iface_("About %s and %s to %s %%") % figures


def duration(estimate):
    seconds = estimate.seconds
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def memory(estimate):
    return f"{estimate.memory_bytes / 2**30:.1f} GB"


def _key(settings):
    return tuple(getattr(settings, name) for name in _SETTINGS)


class EstimateJob(jobs.Job):
    """The first passes of the bake of an object, and the estimates from them."""

    cancelled = "The estimate was cancelled"

    def __init__(self, context, obj):
        """Exports the scene. Raises LeaflightError if it cannot be baked with the settings."""
        scene, volumes, _ = scene_export.export_scene(context, obj)
        scene_export.check_light(scene)
        settings = obj.leaflight
        self._name, self._settings = obj.name_full, _key(settings)
        # Use one pilot for all qualities.
        self._error = min(settings.error, *bake_properties.QUALITIES.values())
        self._asked, self._limit = settings.error, bake.time_limit(settings)
        given = bake.arguments_of(obj, volumes, scene)
        self._arguments = {**given, "error": self._error, "time": None}
        self.pilot = None

    def run(self, progress):
        """Runs the pilot, in any thread. Touches no Blender data."""
        self.pilot = pilot(**self._arguments, progress=progress)
        if progress.cancelled:
            raise leaflight.Cancelled

    def apply(self):
        _pilots[self._name] = self._settings, self._error, self.pilot
        return sentence(self.pilot.estimate(self._asked, self._limit))


class LEAFLIGHT_OT_estimate_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Estimate"
    bl_description = (
        "Estimate time and memory of Draft, Good and Final from the first passes of a "
        "bake. Esc cancels"
    )
    bl_options = set()
    conditions = (jobs.is_free, *checks.VOLUME)

    def start(self, context):
        return EstimateJob(context, active_volume(context))
