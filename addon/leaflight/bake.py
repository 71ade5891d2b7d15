# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Flattened Illumination: in a thread, so that Blender stays usable and Esc cancels."""

import re
import sys
import threading
import time
import uuid
from pathlib import Path

import bpy

from . import cache, core, operator_checks, scene_export, shader, surface_object
from .core.output import check_writable

LeaflightError = core.LeaflightError

# The one bake in progress, for the panel and for Cancel.
_running = None


class BakeJob:
    """One bake: all it needs, read from the scene; the work; and lighting the object by it."""

    def __init__(self, context, obj):
        """Raises LeaflightError when the scene or the settings cannot be baked."""
        settings = obj.leaflight
        self.object_name = obj.name
        self.output = settings.output
        self.path = bpy.path.abspath(settings.output)
        _check_not_in_use(self.path, obj)
        _make_folder(self.path)
        check_writable(self.path, ".vdb", settings.source)
        scene, self.warnings = scene_export.export_scene(context, obj)
        if not scene.lights:
            raise LeaflightError(
                "No Area light renders, so all would be black: add one, then bake."
            )
        self.matrix = [x for row in obj.matrix_world for x in row]
        self.fingerprint = scene_export.fingerprint(obj, scene)
        self.bake = None
        self._arguments = {
            "volume": cache.world_volume(obj),
            "scene": scene,
            "isovalues": (settings.low, settings.high),
            "resolution": settings.resolution or None,
            "samples": settings.samples,
            "photons": settings.photons,
            "estimator": settings.estimator,
            "seed": settings.seed,
        }

    def run(self, progress):
        """Bakes and writes the files, in any thread: touches no Blender data."""
        start = time.perf_counter()
        bake = core.bake(**self._arguments, progress=progress)
        if progress.cancelled:
            raise core.Cancelled
        bake.save(self.path)
        self.atlas_columns = shader.write_atlas(bake.grid, shader.atlas_path(self.path))
        self.seconds = time.perf_counter() - start
        self.bake = bake

    def apply(self):
        """Lights the object by the bake. Raises LeaflightError when it has gone meanwhile."""
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or not obj.leaflight.is_volume:
            raise LeaflightError(
                f'"{self.object_name}" is gone, so the bake lights nothing: import it again. '
                f"The bake is kept in {self.path}."
            )
        settings = obj.leaflight
        settings.bake_path = self.output
        settings.bake_matrix = self.matrix
        settings.bake_fingerprint = self.fingerprint
        settings.bake_seconds = self.seconds
        settings.atlas_columns = self.atlas_columns
        settings.bake_id = uuid.uuid4().hex
        cache.keep_bake(self.path, self.bake)
        cache.forget_unused()
        shader.reload_image(shader.atlas_path(self.path))
        volume = cache.volume_of(obj)
        settings.limit_isovalue(volume.field().range, self.bake.isovalues, settings.isovalue)
        surface_object.update(obj, settings.isovalue)


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
        self.report({"INFO"}, f"Baked {job.bake.grid.texels} texels in {job.seconds:.1f} s")
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


def _check_not_in_use(path, obj):
    for other in bpy.data.objects:
        theirs = other.leaflight.bake_path
        if other != obj and theirs and bpy.path.abspath(theirs) == path:
            raise LeaflightError(f'{path}: this bake lights "{other.name}"; choose another output.')


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
