# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Flattened Illumination: the operator and its job, which lights all volumes of the scene."""

import time
from dataclasses import replace

import bpy
import leaflight
from leaflight import LeaflightError
from leaflight.bake.checkpoint import Checkpoint
from leaflight.bake.statistics import outcome
from leaflight.io.output import check_writable

from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..show import preview, surface_material, surface_object, walls
from ..stage import hidden, scene_export, viewport
from ..store import atlases, bake_files, cache, frame_bakes, preferences
from . import lighting, stopped

# Showing passes may take at most 1/N of the time of a bake.
_SHOWN_SHARE = 5

_DARK_WALLS = (
    "The bake was stopped before it lit the walls, so Blender's lamps light them; Continue bakes "
    "them"
)

# Progress, 0 to 1, once the light is computed, and once its files are written.
_LIT, _WRITTEN = 0.9, 0.97


def arguments_of(obj, volumes, scene):
    """Returns the arguments of leaflight.bake() for volumes, with the settings of `obj`."""
    settings = obj.leaflight
    return {
        "volumes": [cache.volume_to_bake(volume) for volume in volumes],
        "scene": scene,
        "isovalues": (settings.low, settings.high) if len(volumes) == 1 else None,
        "resolution": settings.resolution if settings.use_resolution else None,
        "seed": settings.seed,
        "both_sides": settings.both_sides,
        "walls": settings.light_walls,
        "threads": preferences.threads(),
        "error": settings.error,
        "time": time_limit(settings),
    }


def time_limit(settings):
    """Returns the seconds after which a bake ends, or None."""
    return settings.time_limit if settings.use_time_limit else None


def checkpoint_path(obj):
    """Returns the path of the checkpoint of a bake with the settings of an object."""
    return bake_files.folder_for(obj) / f"{bake_files.stem(obj.name)}.checkpoint"


class BakeJob(jobs.Job):
    """A bake of all volumes of the scene: its inputs, the work, and lighting the volumes."""

    # True if the light of `latest` is temporary, so that coarse isosurfaces are good enough.
    is_rough = False
    # True once a volume was deleted, and once the bake was stopped.
    is_deleted = is_stopped = False

    def __init__(self, context, obj, resume=False):
        """Exports the scene for a bake of all volumes that render, with the settings of `obj`.

        resume: True to continue from a checkpoint. Raises LeaflightError if the scene or the
        settings cannot be baked.
        """
        scene, volumes, self.warnings = scene_export.export_scene(context, obj)
        for volume in volumes:
            _check_own(volume)
        self.folder = bake_files.folder_for(obj)
        bake_files.make_folder(self.folder)
        check_writable(self.folder / "bake.vdb", ".vdb")
        scene_export.check_light(scene)
        self.scene_name = context.scene.name
        self.leader = volumes.index(obj)
        self.names = [volume.name for volume in volumes]
        self._pointers = [volume.as_pointer() for volume in volumes]
        self.states = [lighting.StateAtBake.of(volume) for volume in volumes]
        self.fingerprint = scene_export.fingerprint(volumes, scene)
        self.bake = None
        self.latest = None
        # Light of the walls in the last pass that had it.
        self._lit_walls = None
        self._shown, self._quiet_until, self._reached = None, 0.0, 0.0
        self._seconds_before = 0.0
        self._arguments = arguments_of(obj, volumes, scene)
        self._materials = obj.leaflight.both_sides, obj.leaflight.light_walls
        self.checkpoint = Checkpoint(checkpoint_path(obj), self._recipe(obj), resume)

    def _recipe(self, _obj):
        """Returns facts for the checkpoint that tell how to resume it."""
        return {}

    def run(self, progress):
        """Bakes and writes the files, in any thread. Touches no Blender data."""
        start = time.perf_counter()

        def keep(bake):
            self.latest = bake
            self._lit_walls = bake.walls if bake.walls is not None else self._lit_walls
            self.seconds = self._seconds_before + time.perf_counter() - start

        keep(self._light(on_pass=keep, progress=progress))
        if progress.cancelled:
            raise leaflight.Cancelled
        self._reached = _LIT
        progress.begin("Writing the bake")
        self.write()
        self._reached = _WRITTEN
        progress.begin("Showing the light")
        self.seconds = self._seconds_before + time.perf_counter() - start

    def fraction(self, progress):
        return max(_LIT * progress.fraction, self._reached)

    def _light(self, **how):
        return leaflight.bake(**self._arguments, checkpoint=self.checkpoint, **how)

    def write(self):
        """Writes the files of the last pass, in any thread. Raises LeaflightError."""
        self.path = bake_files.path_for(self.folder, self.names[self.leader], self.latest.id)
        self.columns = _write(self.latest, self.path)
        self.checkpoint.remove()
        self.bake = self.latest

    def show(self):
        """Lights the volumes with the last pass unless that would take too much of the time."""
        start, bake = time.perf_counter(), self.latest
        volumes = self._volumes()
        if bake is None:
            surface_material.prepare_first_light(volumes, *self._materials)
        if bake is None or bake is self._shown or start < self._quiet_until:
            return
        for index, (obj, state) in enumerate(zip(volumes, self.states)):
            if obj.mode == "OBJECT" and obj.leaflight.frame == state.frame:
                preview.put(obj, bake, index, state.matrix, state.changes)
                surface_object.update_all(obj, self.is_rough, as_coarse=True)
        if bpy.data.scenes.get(self.scene_name) is not None:
            walls.show_pass(bpy.data.scenes[self.scene_name])
        self._shown = bake
        end = time.perf_counter()
        self._quiet_until = end + (_SHOWN_SHARE - 1) * (end - start)

    def _volumes(self):
        """Returns the objects of the bake, even if they were renamed. Raises LeaflightError."""
        found = []
        for index, (name, pointer) in enumerate(zip(self.names, self._pointers)):
            obj = _volume(name) or _renamed(pointer)
            if obj is None:
                self.is_deleted = True
                raise LeaflightError(
                    f'"{name}" was deleted, so its bake was stopped; undo brings the volume back.'
                )
            self.names[index], self._pointers[index] = obj.name, obj.as_pointer()
            found.append(obj)
        return found

    def ended(self):
        surface_material.forget_first_light()
        if self.latest is None or self.is_deleted:
            return super().ended()
        statistics = replace(self.latest.statistics, stopped=True)
        self.latest = replace(self.latest, statistics=statistics, walls=self._lit_walls)
        if self._materials[1] and self.latest.scene.meshes and self._lit_walls is None:
            self.warnings = (*self.warnings, _DARK_WALLS)
        self.is_stopped = True
        # Offer the light even if show() fails.
        stopped.offer(self)
        self._quiet_until = 0.0
        self.show()
        return "The bake was stopped: keep its light, or throw it away, in the sidebar"

    def apply(self):
        """Lights the volumes with the bake and returns a sentence about it.

        Raises LeaflightError if a volume was deleted meanwhile.
        """
        volumes = self._volumes()
        preview.forget()
        surface_material.forget_first_light()
        cache.keep_bake(self.bake)
        end, about = self.outcome(), (self.fingerprint, self.seconds)
        for index, (obj, state) in enumerate(zip(volumes, self.states)):
            # Show the baked frame. A volume that follows the scene switches back by itself.
            frame_bakes.switch(obj, state.frame)
            columns = self.columns[index]
            lighting.light(obj, self.bake, index, self.path, columns, state, *about)
            obj.leaflight.bake_outcome = end
        volumes[self.leader].leaflight.bake_warnings = "\n".join(self.warnings)
        scene = bpy.data.scenes.get(self.scene_name)
        lighting.show(volumes, volumes[self.leader], scene)
        texels = sum(grid.texels for grid in self.bake.grids)
        return f"Baked {texels} texels in {self.seconds:.1f} s{end and f'; {end}'}"

    def failed(self):
        """Removes the passes. The file of the bake stays for Load Bake."""
        surface_material.forget_first_light()
        surface_object.forget_passes()

    def outcome(self):
        """Returns a text on the error that the last pass reached."""
        return outcome(
            self.latest,
            "it was stopped" if self.is_stopped else "another pass would not end in time",
        )


class LEAFLIGHT_OT_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Bake Flattened Illumination"
    bl_description = (
        "Compute the light on all isosurfaces of the isovalue range, until its error "
        "reaches the target. Esc stops the bake, and you can keep its finished light"
    )
    conditions = (jobs.is_free, stopped.is_decided, *checks.VOLUME)

    def invoke(self, context, event):
        if not bpy.app.background:
            if hidden.is_first_scene(context.scene):
                if self.call(bpy.ops.leaflight.stage) == {"CANCELLED"}:
                    return {"CANCELLED"}
                self.report(
                    {"INFO"}, "Staged first, because the scene had only Blender's cube and lamp"
                )
            viewport.show_light(context)
        return super().invoke(context, event)

    def start(self, context):
        return BakeJob(context, active_volume(context))


def _volume(name):
    """Returns the volume object of this name in the file, not linked, or None."""
    obj = bpy.data.objects.get((name, None))
    is_there = obj is not None and obj.leaflight.is_volume and obj.users_scene
    return obj if is_there else None


def _renamed(pointer):
    """Returns the object at an address, or None.

    Undo changes the addresses of objects, but renaming does not.
    """
    return next((o for o in bpy.data.objects if o.as_pointer() == pointer and not o.library), None)


def _check_own(obj):
    if obj.library is not None:
        raise LeaflightError(
            f'"{obj.name}" is linked from {bpy.path.basename(obj.library.filepath)} and cannot '
            "keep a bake here: make a library override of it, or disable it in renders."
        )


def _write(bake, path):
    """Writes a bake with its atlases. After an error none of the new files remain.

    Returns the columns of each volume's atlas. Raises LeaflightError.
    """
    before = {path, *atlases.beside(path)} if path.exists() else set()
    try:
        bake.save(path)
        return [atlases.write(grid, path, bake.id, index) for index, grid in enumerate(bake.grids)]
    except LeaflightError:
        for file in {path, *atlases.beside(path)} - before:
            file.unlink(missing_ok=True)
        raise
