# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators whose work is a Job. Blender stays usable and shows progress, and Esc ends it."""

from collections.abc import Callable
from typing import Any, Optional

import bpy
import leaflight

from ..store import cache
from ..store.reading import StillReading
from ..translations import iface_
from . import failures, jobs
from .checks import LeaflightOperator
from .jobs import BackgroundWork, Job

# Function that returns a Job or None.
Start = Callable[[bpy.types.Context], Optional[Job]]

# Class and state of an operator whose window was closed, until another window takes it over.
_left_behind: "tuple[type[BackgroundOperator], dict[str, Any]] | None" = None


class BackgroundOperator(LeaflightOperator):
    """An operator whose work is a Job: modal for users, blocking for scripts.

    start(context) returns the job. Any error in it or in the job becomes a report.
    """

    # The BackgroundWork of this operator: None while only its dialog is open.
    _work: BackgroundWork | None = None
    # The present text of the status bar.
    _status: str | None = None
    # Seconds that the window waits for work which may be short.
    _patience = 0.0

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        return self.execute(context) if bpy.app.background else self.run_modal(context)

    def call(self, operator: Any, *how: str, **chosen: Any) -> set[str]:
        """Calls another operator and returns its result. Reports its error as that of this one."""
        try:
            return operator(*how, **chosen)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            return {"CANCELLED"}

    def next_job(self, context: bpy.types.Context) -> Job | None:
        """Returns another job to do after one that was applied, or None."""
        return None

    def run_modal(self, context: bpy.types.Context) -> set[str]:
        failures.forget()
        result = self._begin(context, self.start)
        if result == {"RUNNING_MODAL"}:
            context.window_manager.modal_handler_add(self)  # type: ignore[arg-type]
        return result

    def _begin(self, context: bpy.types.Context, start: Start) -> set[str]:
        try:
            job = start(context)
        except Exception as error:
            return self._fail(error)
        if job is None:
            return {"FINISHED"}
        work = BackgroundWork(job)
        if self._patience:
            work.wait(self._patience)
            if not work.is_alive():
                return self._conclude(job, work, job.ended)
        jobs.set_running(work)
        self._job, self._work = job, work
        self._attend(context)
        return {"RUNNING_MODAL"}

    def _attend(self, context: bpy.types.Context) -> None:
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
            return {"RUNNING_MODAL"}
        if self._work.is_alive():
            if event.type == "TIMER":
                self._work.show()
                self._show_status(context)
            return {"PASS_THROUGH"}
        if not self._work.is_shown_over:
            # Draw the window once more before apply() blocks it.
            self._work.is_shown_over = True
            self._show_status(context)
            return {"PASS_THROUGH"}
        self._release(context)
        ended = self._conclude(self._job, self._work, self._job.ended)
        return self._begin(context, self.next_job) if ended == {"FINISHED"} else ended

    def cancel(self, context: bpy.types.Context) -> None:
        """Ends the modal operator when Blender quits, loads a file or closes the window."""
        global _left_behind
        work = self._work
        if work is None:
            return
        context.window_manager.event_timer_remove(self._timer)
        if work.progress.cancelled:
            jobs.show_status(None)
            jobs.set_running(None)
            return
        # The timer runs only if a window was closed: not after quitting or loading.
        _left_behind = type(self), dict(vars(self))
        bpy.app.timers.register(_go_on_elsewhere, first_interval=0.0)

    def _release(self, context: bpy.types.Context) -> None:
        jobs.set_running(None)
        context.window_manager.event_timer_remove(self._timer)
        self._status = None
        jobs.show_status(None)
        # After Esc nothing else does: they would show the progress and Stop until the mouse moves.
        jobs.redraw_panels()

    def _show_status(self, context: bpy.types.Context) -> None:
        """Shows the progress in the status bar and redraws the panels."""
        text = iface_("Leaflight  %s  (Esc ends it)") % self._work.status()
        if text != self._status:
            self._status = text
            context.workspace.status_text_set(text)
            jobs.redraw_panels()

    def execute(self, context: bpy.types.Context) -> set[str]:
        failures.forget()
        ended = self._do(self.start, context)
        while ended == {"FINISHED"}:
            again = self._do(self.next_job, context)
            if again is None:
                break
            ended = again
        return ended or {"FINISHED"}

    def _do(self, start: Start, context: bpy.types.Context) -> set[str] | None:
        """Does a job to its end, and waits for its files. Returns None if there is no job."""
        try:
            with cache.waiting():
                job = start(context)
        except Exception as error:
            return self._fail(error)
        if job is None:
            return None
        work = BackgroundWork(job)
        jobs.print_progress(job.name, work)
        # Pass job.cancelled, because without a window no user can decide on a stopped job.
        return self._conclude(job, work, lambda: job.cancelled)

    def _conclude(self, job: Job, work: BackgroundWork, ended: Callable[[], str]) -> set[str]:
        """Applies the job if its work was successful.

        ended: called otherwise. It returns a sentence about a canceled job.
        """
        try:
            work.result()
        except Exception as error:
            return self._end(error, ended)
        try:
            with cache.waiting():
                summary = job.apply()
        except Exception as error:
            failed = self._fail(error)
            self._attempt(job.failed)
            return failed
        for warning in job.warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, summary)
        return {"FINISHED"}

    def _end(self, error: Exception, ended: Callable[[], str]) -> set[str]:
        sentence = self._attempt(ended)
        if not isinstance(error, leaflight.Cancelled):
            return self._fail(error)
        if sentence is not None:
            self.report({"INFO"}, sentence)
        return {"CANCELLED"}

    def _attempt(self, call: Callable[[], Any]) -> Any:
        """Returns what a callback of the job returns, or None after an error, which is reported."""
        try:
            return call()
        except Exception as error:
            self._fail(error)
            return None

    def _fail(self, error: BaseException) -> set[str]:
        # The panels show that a file is still being read, as long as it is.
        is_early = isinstance(error, StillReading)
        self.report({"ERROR"}, str(error) if is_early else failures.record(error))
        return {"CANCELLED"}


class AskingOperator(BackgroundOperator):
    """An operator that first asks for its options, in a dialog or the file browser.

    Blender does not let an operator that these execute become modal. It therefore calls itself
    again with the chosen options.
    """

    asked: bpy.props.BoolProperty(options={"HIDDEN", "SKIP_SAVE"})
    _by_hand = False

    def ask(self, context: bpy.types.Context, _event: bpy.types.Event) -> Any:
        return context.window_manager.invoke_props_dialog(self)  # type: ignore[arg-type]

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self.asked:
            return self.run_modal(context)
        self._by_hand = True
        return self.ask(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        # Adjust Last Operation does the work at once.
        if not self._by_hand or jobs.running() is not None:
            return super().execute(context)
        self._by_hand = False
        again = getattr(bpy.ops.leaflight, type(self).bl_idname.partition(".")[2])
        return self.call(again, "INVOKE_DEFAULT", asked=True, **self.chosen())

    def chosen(self) -> dict[str, Any]:
        """Returns the options that were chosen."""
        return self.as_keywords(ignore=("filter_glob", "all_files", "asked"))


class LEAFLIGHT_OT_go_on(BackgroundOperator, bpy.types.Operator):
    """Attends to work whose window was closed, in another window."""

    bl_label = "Leaflight"
    bl_options = {"INTERNAL", "UNDO"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[Any]:
        global _left_behind
        if _left_behind is None:
            return {"CANCELLED"}
        (self._class, state), _left_behind = _left_behind, None
        for name, value in state.items():
            setattr(self, name, value)
        self._attend(context)
        context.window_manager.modal_handler_add(self)  # type: ignore[arg-type]
        return {"RUNNING_MODAL"}

    def next_job(self, context: bpy.types.Context) -> Job | None:
        return self._class.next_job(self, context)


def _go_on_elsewhere() -> None:
    if _left_behind is None:
        return
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        bpy.ops.leaflight.go_on("INVOKE_DEFAULT")
