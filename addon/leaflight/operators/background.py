# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread, so that Blender stays usable, shows how far it is, and Esc ends it."""

import sys
import threading
from collections.abc import Callable
from typing import Any, Optional

import bpy
import leaflight

from ..translations import iface_

LeaflightError = leaflight.LeaflightError

# The one work in progress, for the panels and for Cancel.
_running: "BackgroundWork | None" = None

# Why the last work failed, for the panels: reports are gone in seconds.
_failure = ""


class Job:
    """What a BackgroundOperator does; its warnings are sentences for the user.

    name: of what it does, for a terminal; cancelled: what to say when it was cancelled without
    leaving anything.

    run(progress) works in any thread and touches no Blender data. All else is called in Blender's
    own: apply() puts the result into the scene and returns a sentence for the user.
    """

    warnings: tuple[str, ...] = ()
    name = "Bake"
    cancelled = "The bake was cancelled; nothing has changed"

    def fraction(self, progress: leaflight.Progress) -> float:
        """How much of it is done, 0..1; in any thread."""
        return progress.fraction

    def status(self, progress: leaflight.Progress) -> str:
        """How far it is, for the panel; in any thread."""
        return f"{100.0 * self.fraction(progress):3.0f} % {progress.stage}"

    def run(self, progress: leaflight.Progress) -> None:
        raise NotImplementedError

    def apply(self) -> str:
        raise NotImplementedError

    def show(self) -> None:
        """Called time and again while run() works, to show what it has reached."""

    def ended(self) -> str:
        """Called when run() was cancelled or failed; returns a sentence about the former."""
        return self.cancelled


# Makes a Job, or none.
Start = Callable[[bpy.types.Context], Optional[Job]]


class BackgroundWork:
    """A function of a Progress, at work in a thread of its own."""

    def __init__(self, work: Callable[[leaflight.Progress], None], job: Job = Job()) -> None:
        self.progress = leaflight.Progress()
        self._job = job
        self._error: BaseException | None = None
        # Whether the window has shown that it ended.
        self.is_shown_over = False
        self._thread = threading.Thread(target=self._run, args=(work,), name="Leaflight")
        self._thread.start()

    def _run(self, work: Callable[[leaflight.Progress], None]) -> None:
        try:
            work(self.progress)
        except BaseException as error:  # result() raises it again, in the main thread
            self._error = error

    def is_alive(self) -> bool:
        return self._thread.is_alive()

    def wait(self, seconds: float) -> None:
        self._thread.join(seconds)

    def cancel(self) -> None:
        self.progress.cancel()

    def fraction(self) -> float:
        return self._job.fraction(self.progress)

    def status(self) -> str:
        return self._job.status(self.progress)

    def result(self) -> None:
        """Waits for the end and raises what the work raised."""
        self._thread.join()
        if self._error is not None:
            raise self._error


def is_free(operator: Any) -> bool:
    """Whether no work is in progress; otherwise a greyed button of the operator shows why."""
    if _running is not None:
        operator.poll_message_set("Leaflight is at work; Esc ends it")
    return _running is None


class BackgroundOperator:
    """An operator whose work is a Job: modal for users, straight on for scripts.

    start(context) returns the job, or raises LeaflightError.
    """

    is_free = classmethod(is_free)
    # The BackgroundWork of this operator: None while only its dialog is open.
    _work: BackgroundWork | None = None
    # The present text of the status bar.
    _status: str | None = None
    # Seconds that the window waits for work which may be short.
    _patience = 0.0

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        return self.execute(context) if bpy.app.background else self.run_modal(context)

    def next_job(self, context: bpy.types.Context) -> Job | None:
        """Another job to do after one that was applied, or None. Raises LeaflightError."""
        return None

    def run_modal(self, context: bpy.types.Context) -> set[str]:
        forget_failure()
        result = self._begin(context, self.start)
        if result == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)  # type: ignore[arg-type]
        return result

    def _begin(self, context: bpy.types.Context, start: Start) -> set[str]:
        global _running
        try:
            job = start(context)
        except LeaflightError as error:
            return self._fail(error)
        if job is None:
            return {"FINISHED"}
        work = BackgroundWork(job.run, job)
        if self._patience:
            work.wait(self._patience)
            if not work.is_alive():
                return self._conclude(job, work.result, job.ended)
        _running = work
        self._job, self._work = job, work
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
            return {"RUNNING_MODAL"}
        if self._work.is_alive():
            if event.type == "TIMER":
                self._job.show()
                self._show_status(
                    context, iface_("Leaflight  %s  (Esc ends it)") % self._work.status()
                )
            return {"PASS_THROUGH"}
        if not self._work.is_shown_over:
            # The window is drawn once more before it waits for apply().
            self._work.is_shown_over = True
            self._show_status(context, iface_("Leaflight  %s  (Esc ends it)") % self._work.status())
            return {"PASS_THROUGH"}
        self._release(context)
        ended = self._conclude(self._job, self._work.result, self._job.ended)
        return self._begin(context, self.next_job) if ended == {"FINISHED"} else ended

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender quits or loads another file."""
        if self._work is not None:
            self._work.cancel()
            self._release(context)

    def _release(self, context: bpy.types.Context) -> None:
        global _running
        _running = None
        context.window_manager.event_timer_remove(self._timer)
        self._show_status(context, None)

    def _show_status(self, context: bpy.types.Context, text: str | None) -> None:
        """Shows a text in the status bar, and draws the panels anew."""
        if text != self._status:
            self._status = text
            context.workspace.status_text_set(text)
            redraw_panels()

    def execute(self, context: bpy.types.Context) -> set[str]:
        forget_failure()
        ended = self._do(self.start, context)
        while ended == {"FINISHED"}:
            again = self._do(self.next_job, context)
            if again is None:
                break
            ended = again
        return ended

    def _do(self, start: Start, context: bpy.types.Context) -> set[str] | None:
        """Does a job to its end; None where there is none."""
        try:
            job = start(context)
        except LeaflightError as error:
            return self._fail(error)
        if job is None:
            return None
        work = BackgroundWork(job.run, job)
        _print_progress(job.name, work)
        # There is no user to choose what becomes of it.
        return self._conclude(job, work.result, lambda: job.cancelled)

    def _conclude(self, job: Job, result: Callable[[], None], ended: Callable[[], str]) -> set[str]:
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

    def _fail(self, error: leaflight.LeaflightError) -> set[str]:
        global _failure
        _failure = str(error)
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}


def failure() -> str:
    """Why the last work failed, or an empty text."""
    return _failure


def forget_failure() -> None:
    """When another file is opened, or the scene is staged anew."""
    global _failure
    _failure = ""


def running() -> BackgroundWork | None:
    """The BackgroundWork in progress, or None."""
    return _running


def cancel_running() -> None:
    if _running is not None:
        _running.cancel()


def _print_progress(name: str, work: BackgroundWork) -> None:
    """Waits for the work. A terminal gets a bar, anything else a line for each tenth."""
    tenths = 0
    while work.is_alive():
        work.wait(0.2)
        if sys.stdout.isatty():
            filled = int(30 * work.fraction())
            bar = "#" * filled + "." * (30 - filled)
            print(f"\r{name} [{bar}] {work.status():<40}", end="", flush=True)
        elif int(10 * work.fraction()) > tenths:
            tenths = int(10 * work.fraction())
            print(f"{name} {work.status()}", flush=True)
    if sys.stdout.isatty():
        print()


def redraw_panels() -> None:
    """Draws the sides and heads of viewports anew, not the viewports: these take long."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type in {"UI", "TOOL_HEADER"}:
                        region.tag_redraw()
