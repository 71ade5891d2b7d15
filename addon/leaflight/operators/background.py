# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread, so that Blender stays usable, shows how far it is, and Esc ends it."""

import sys
import threading

import bpy
import leaflight

LeaflightError = leaflight.LeaflightError

# The one work in progress, for the panels and for Cancel.
_running = None


_CANCELLED = "The bake was cancelled; nothing has changed"


class Job:
    """What a BackgroundOperator does; its warnings are sentences for the user.

    run(progress) works in any thread and touches no Blender data. All else is called in Blender's
    own: apply() puts the result into the scene and returns a sentence for the user.
    """

    warnings = ()

    def show(self):
        """Called time and again while run() works, to show what it has reached."""

    def ended(self):
        """Called when run() was cancelled or failed; returns a sentence about the former."""
        return _CANCELLED


class BackgroundWork:
    """A function of a Progress, at work in a thread of its own."""

    def __init__(self, work):
        self.progress = leaflight.Progress()
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


def is_free(operator):
    """Whether no work is in progress; otherwise a greyed button of the operator shows why."""
    if _running is not None:
        operator.poll_message_set("A bake is running; Esc ends it")
    return _running is None


class BackgroundOperator:
    """An operator whose work is a Job: modal for users, straight on for scripts.

    start(context) returns the job, or raises LeaflightError.
    """

    is_free = classmethod(is_free)

    def invoke(self, context, _event):
        return self.execute(context) if bpy.app.background else self.run_modal(context)

    def run_modal(self, context):
        global _running
        try:
            job = self.start(context)
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
                text = f"Leaflight  {self._work.status()}  (Esc ends it)"
                context.workspace.status_text_set(text)
                self._job.show()
                _redraw_panels(context)
            return {"PASS_THROUGH"}
        self._release(context)
        return self._conclude(self._job, self._work.result, self._job.ended)

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
            job = self.start(context)
        except LeaflightError as error:
            return self._fail(error)
        work = BackgroundWork(job.run)
        _print_progress(work)
        # Nobody is there to be asked what shall become of it.
        return self._conclude(job, work.result, lambda: _CANCELLED)

    def _conclude(self, job, result, ended):
        """Calls result, which raises what went wrong with the work, and applies the job.

        ended: called when something did; returns a sentence about a cancelled job.
        """
        try:
            result()
        except leaflight.Cancelled:
            self.report({"INFO"}, ended())
            return {"CANCELLED"}
        except LeaflightError as error:
            ended()
            return self._fail(error)
        try:
            summary = job.apply()
        except LeaflightError as error:
            return self._fail(error)
        for warning in job.warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, summary)
        return {"FINISHED"}

    def _fail(self, error):
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}


def running():
    """The BackgroundWork in progress, or None."""
    return _running


def cancel_running():
    if _running is not None:
        _running.cancel()


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
