# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Flattened Illumination: in a thread, so that Blender stays usable and Esc cancels."""

import re
import sys
import threading
import time
import uuid
from pathlib import Path

import bpy

from . import (
    cache,
    core,
    isovalues,
    operator_checks,
    scene_export,
    shader,
    surface_object,
    walls,
)
from .core.output import check_writable

LeaflightError = core.LeaflightError

# The one bake in progress, for the panel and for Cancel.
_running = None


class BakeJob:
    """One bake: all it needs, read from the scene; the work; and lighting the volumes by it."""

    def __init__(self, context, obj):
        """Of all volumes that render, with the settings of `obj`.

        Raises LeaflightError when the scene or the settings cannot be baked.
        """
        settings = obj.leaflight
        self.output = settings.output
        self.path = bpy.path.abspath(settings.output)
        scene, volumes, self.warnings = scene_export.export_scene(context, obj)
        _check_not_in_use(self.path, volumes)
        _make_folder(self.path)
        for volume in volumes:
            check_writable(self.path, ".vdb", volume.leaflight.source)
        scene_export.check_light(scene)
        self.scene_name = context.scene.name
        self.leader = obj.name
        self.names = [volume.name for volume in volumes]
        self.matrices = [[x for row in obj.matrix_world for x in row] for obj in volumes]
        self.windows = [(obj.leaflight.low, obj.leaflight.high) for obj in volumes]
        self.fingerprint = scene_export.fingerprint(volumes, scene)
        self.bake = None
        self._arguments = {
            "volumes": [cache.world_volume(volume) for volume in volumes],
            "scene": scene,
            "isovalues": self.windows[0] if len(volumes) == 1 else None,
            "resolution": settings.resolution or None,
            "samples": settings.samples,
            "photons": settings.photons,
            "estimator": settings.estimator,
            "seed": settings.seed,
            "both_sides": settings.both_sides,
            "surroundings": settings.light_surroundings,
        }

    def run(self, progress):
        """Bakes and writes the files, in any thread: touches no Blender data."""
        start = time.perf_counter()
        bake = core.bake(**self._arguments, progress=progress)
        if progress.cancelled:
            raise core.Cancelled
        bake.save(self.path)
        self.atlas_columns = [
            _write_atlases(grid, self.path, index) for index, grid in enumerate(bake.grids)
        ]
        self.seconds = time.perf_counter() - start
        self.bake = bake

    def apply(self):
        """Lights the volumes by the bake. Raises LeaflightError when one has gone meanwhile."""
        volumes = [bpy.data.objects.get(name) for name in self.names]
        for name, obj in zip(self.names, volumes):
            if obj is None or not obj.leaflight.is_volume:
                raise LeaflightError(
                    f'"{name}" is gone, so the bake lights nothing: import it again. The bake is '
                    f"kept in {self.path}."
                )
        identifier = uuid.uuid4().hex
        cache.keep_bake(self.path, self.bake)
        for index, obj in enumerate(volumes):
            self._light(obj, index, identifier)
        cache.forget_unused()
        for obj in volumes:
            settings = obj.leaflight
            volume = cache.volume_of(obj)
            window = self.windows[settings.bake_index]
            settings.limit_isovalue(volume.data_range(), window, settings.isovalue)
            surface_object.update(obj, settings.isovalue)
        leader = bpy.data.objects[self.leader]
        isovalues.set_isovalue(leader, leader.leaflight.isovalue)
        scene = bpy.data.scenes.get(self.scene_name)
        if scene is not None:
            walls.refresh(scene)

    def _light(self, obj, index, identifier):
        settings = obj.leaflight
        settings.bake_path = self.output
        settings.bake_index = index
        settings.bake_matrix = self.matrices[index]
        settings.bake_low, settings.bake_high = self.windows[index]
        settings.bake_surroundings = self.bake.surroundings is not None
        settings.bake_fingerprint = self.fingerprint
        settings.bake_seconds = self.seconds
        settings.atlas_columns = self.atlas_columns[index]
        settings.bake_id = identifier
        for back in (False, True):
            shader.reload_image(shader.atlas_path(self.path, index, back))


class LEAFLIGHT_OT_bake(bpy.types.Operator):
    bl_idname = "leaflight.bake"
    bl_label = "Bake Flattened Illumination"
    bl_description = (
        "Compute the light on every isosurface of the window at once, in the surroundings of the "
        "scene. Esc cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if _running is not None:
            cls.poll_message_set("A bake is running; Esc cancels it")
            return False
        return operator_checks.has_volume(cls, context)

    def invoke(self, context, event):
        global _running
        if bpy.app.background:
            return self.execute(context)
        try:
            job = BakeJob(context, context.object)
        except LeaflightError as error:
            return self._fail(error)
        _running = BackgroundWork(job.run)
        self._job, self._work = job, _running
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
            return {"RUNNING_MODAL"}
        if self._work.is_alive():
            if event.type == "TIMER":
                text = f"Leaflight  {self._work.status()}  (Esc cancels)"
                context.workspace.status_text_set(text)
                _redraw_panels(context)
            return {"PASS_THROUGH"}
        self._release(context)
        return self._conclude(self._job, self._work.result)

    def cancel(self, context):
        """Blender quits or loads another file."""
        self._work.cancel()
        self._release(context)

    def _release(self, context):
        global _running
        _running = None
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        _redraw_panels(context)

    def execute(self, context):
        try:
            job = BakeJob(context, context.object)
        except LeaflightError as error:
            return self._fail(error)
        work = BackgroundWork(job.run)
        _print_progress(work)
        return self._conclude(job, work.result)

    def _conclude(self, job, result):
        """Calls result, which raises what went wrong with the work, and applies the bake."""
        try:
            result()
            job.apply()
        except core.Cancelled:
            self.report({"INFO"}, "The bake was cancelled; nothing has changed")
            return {"CANCELLED"}
        except LeaflightError as error:
            return self._fail(error)
        for warning in job.warnings:
            self.report({"WARNING"}, warning)
        texels = sum(grid.texels for grid in job.bake.grids)
        self.report({"INFO"}, f"Baked {texels} texels in {job.seconds:.1f} s")
        return {"FINISHED"}

    def _fail(self, error):
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}


class BackgroundWork:
    """A function of a Progress, at work in a thread of its own."""

    def __init__(self, work):
        self.progress = core.Progress()
        self._error = None
        self._thread = threading.Thread(target=self._run, args=(work,), name="Leaflight bake")
        self._thread.start()

    def _run(self, work):
        try:
            work(self.progress)
        except BaseException as error:  # result() raises it again, in the main thread
            self._error = error

    def is_alive(self):
        return self._thread.is_alive()

    def wait(self, seconds):
        self._thread.join(seconds)

    def cancel(self):
        self.progress.cancel()

    def status(self):
        return f"{100.0 * self.progress.fraction:3.0f} % {self.progress.stage}"

    def result(self):
        """Waits for the end and raises what the work raised."""
        self._thread.join()
        if self._error is not None:
            raise self._error


def running():
    """The BackgroundWork of the bake in progress, or None."""
    return _running


def cancel_running():
    if _running is not None:
        _running.cancel()


def default_output(obj):
    """Beside a saved .blend, otherwise among the user's Blender files under a name of its own."""
    name = re.sub(r"[^\w.-]+", "_", obj.name)
    if bpy.data.filepath:
        return f"//leaflight/{name}.vdb"
    folder = bpy.utils.user_resource("DATAFILES", path="leaflight")
    return str(Path(folder) / f"{name}_{time.strftime('%Y%m%d_%H%M%S')}.vdb")


def _check_not_in_use(path, volumes):
    for other in bpy.data.objects:
        theirs = other.leaflight.bake_path
        if other not in volumes and theirs and bpy.path.abspath(theirs) == path:
            raise LeaflightError(f'{path}: this bake lights "{other.name}"; choose another output.')


def _write_atlases(grid, path, index):
    """Writes the atlas of each side that was baked. Returns their columns, 0 if too large."""
    columns = shader.write_atlas(grid, shader.atlas_path(path, index))
    if columns and grid.has_back:
        shader.write_atlas(grid, shader.atlas_path(path, index, back=True), back=True)
    return columns


def _make_folder(path):
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(
            f"{path}: cannot make its folder: {error.strerror}; choose another output."
        ) from None


def _print_progress(work):
    """Waits for the work. A terminal gets a bar, anything else a line for each tenth."""
    tenths = 0
    while work.is_alive():
        work.wait(0.2)
        if sys.stdout.isatty():
            filled = int(30 * work.progress.fraction)
            bar = "#" * filled + "." * (30 - filled)
            print(f"\rBake [{bar}] {work.status():<40}", end="", flush=True)
        elif int(10 * work.progress.fraction) > tenths:
            tenths = int(10 * work.progress.fraction)
            print(f"Bake {work.status()}", flush=True)
    if sys.stdout.isatty():
        print()


def _redraw_panels(context):
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_bake)
