# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Isolines: the light of flatland, in the background."""

import time
import uuid

import bpy
import leaflight
from leaflight import LeaflightError, flatland
from leaflight.flatland.flat_scene import load_flat_scene

from ..operators import background, checks, jobs
from ..show import graph_object


class FlatBakeJob(jobs.Job):
    """One bake of all isolines: what it needs, the work, and lighting the object by it."""

    def __init__(self, obj):
        """Raises LeaflightError when the settings cannot be baked."""
        settings = obj.leaflight_flat
        self.object_name = obj.name
        scene = bpy.path.abspath(settings.scene_file)
        self._arguments = {
            "volume": graph_object.field_of(obj),
            "scene": load_flat_scene(scene) if scene else None,
            "isovalues": (settings.low, settings.high),
            "resolution": settings.resolution or None,
            "error": settings.error,
            "seed": settings.seed,
        }
        self.latest = self._shown = None

    def run(self, progress):
        """In any thread: touches no Blender data."""
        start = time.perf_counter()
        self.bake = flatland.bake_flatland(**self._arguments, on_pass=self._keep, progress=progress)
        if progress.cancelled:
            raise leaflight.Cancelled
        self.seconds = time.perf_counter() - start

    def _keep(self, bake):
        self.latest = bake

    def show(self):
        """Lights the object by the last pass."""
        if self.latest is not self._shown:
            self._shown = self.latest
            self._rebuild(self.latest)

    def ended(self):
        self._rebuild(None)
        return super().ended()

    def _rebuild(self, passed):
        obj = bpy.data.objects.get(self.object_name)
        if obj is not None and obj.leaflight_flat.is_flatland:
            graph_object.rebuild(obj, passed)

    def apply(self):
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or not obj.leaflight_flat.is_flatland:
            raise LeaflightError(
                f'"{self.object_name}" is gone, so the bake lights nothing: import it again.'
            )
        identifier = uuid.uuid4().hex
        graph_object.keep_bake(identifier, self.bake)
        obj.leaflight_flat.bake_id = identifier
        graph_object.rebuild(obj)
        return f"Baked all isolines in {self.seconds:.1f} s"


class LEAFLIGHT_OT_bake_flatland(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.bake_flatland"
    bl_label = "Bake Isolines"
    bl_description = "Compute the light on every isoline at once, within the plane. Esc cancels"
    conditions = (
        jobs.is_free,
        checks.needs(
            lambda context: context.object and context.object.leaflight_flat.is_flatland,
            "Select the graph of an image first (File > Import > Image for Leaflight)",
        ),
        checks.in_object_mode,
    )

    def start(self, context):
        return FlatBakeJob(context.object)


CLASSES = (LEAFLIGHT_OT_bake_flatland,)
