# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimate: the seconds and the memory that a bake will take, before it starts."""

import bpy
import leaflight

from ..operators import background, checks
from ..stage import scene_export
from . import bake

# What an estimate depends on, besides the scene.
_SETTINGS = (
    "source",
    "frame",
    "low",
    "high",
    "resolution",
    "error",
    "time_limit",
    "both_sides",
    "light_surroundings",
    "capped",
)

# Full name of an object -> (its settings then, the leaflight.Estimate).
_estimates = {}


def estimate_of(obj):
    """The leaflight.Estimate for an object with its present settings, or None."""
    key, estimate = _estimates.get(obj.name_full, (None, None))
    return estimate if key == _key(obj.leaflight) else None


def forget():
    _estimates.clear()


def sentence(estimate):
    """An Estimate for the panel."""
    memory = estimate.memory_bytes / 2**30
    return f"About {_time(estimate.seconds)} and {memory:.1f} GB to {estimate.error:.2g} %"


def _time(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def _key(settings):
    return tuple(getattr(settings, name) for name in _SETTINGS)


class EstimateJob(background.Job):
    """The first rounds of the bake of an object, and what follows from them."""

    def __init__(self, context, obj):
        """Raises LeaflightError when the scene or the settings cannot be baked."""
        scene, volumes, _ = scene_export.export_scene(context, obj)
        scene_export.check_light(scene)
        self._name, self._settings = obj.name_full, _key(obj.leaflight)
        self._arguments = bake.arguments_of(obj, volumes, scene)
        self.estimate = None

    def run(self, progress):
        """In any thread: touches no Blender data."""
        self.estimate = leaflight.estimate(**self._arguments, progress=progress)
        if progress.cancelled:
            raise leaflight.Cancelled

    def apply(self):
        _estimates[self._name] = self._settings, self.estimate
        return sentence(self.estimate)

    def ended(self):
        return "The estimate was cancelled"


class LEAFLIGHT_OT_estimate_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.estimate_bake"
    bl_label = "Estimate"
    bl_description = (
        "Tell the seconds and the memory that the bake will take, by its first rounds. Esc cancels"
    )

    @classmethod
    def poll(cls, context):
        if not (cls.is_free() and checks.has_volume(cls, context)):
            return False
        if context.object.leaflight.fixed_samples:
            cls.poll_message_set("Only of bakes that go by their error is there an estimate")
            return False
        return True

    def start(self, context):
        return EstimateJob(context, context.object)


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_estimate_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_estimate_bake)
