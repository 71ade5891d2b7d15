# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs: work in a separate thread, and its result in Blender."""

import sys
import threading
from collections.abc import Callable
from typing import TypeVar

import bpy
import leaflight

from .checks import needs

T = TypeVar("T")

# The work in progress, for the panels and for Cancel.
_running: "BackgroundWork | None" = None

is_free = needs(lambda _: _running is None, "Leaflight is busy; Esc stops it")


class Job:
    """The work of a BackgroundOperator.

    - name: its name in a terminal.
    - warnings: sentences for the user.
    - cancelled: sentence after a cancellation that leaves nothing.

    run(progress) works in any thread and touches no Blender data. All other methods run in
    Blender's main thread. apply() puts the result into the scene and returns a sentence for the
    user. Each method may raise an error, after which BackgroundWork ends the job.
    """

    warnings: tuple[str, ...] = ()
    name = "Bake"
    cancelled = "The bake was cancelled; nothing has changed"

    def fraction(self, progress: leaflight.Progress) -> float:
        """Returns the progress, 0 to 1, in any thread."""
        return progress.fraction

    def status(self, progress: leaflight.Progress) -> str:
        """Returns the progress as text for the panel, in any thread."""
        return status_of(self.fraction(progress), progress.stage)

    def run(self, progress: leaflight.Progress) -> None:
        raise NotImplementedError

    def apply(self) -> str:
        raise NotImplementedError

    def show(self) -> None:
        """Shows intermediate results. It is called repeatedly while run() works."""

    def ended(self) -> str:
        """Ends a job whose run() was canceled or failed. Returns a sentence on the cancellation."""
        return self.cancelled

    def failed(self) -> None:
        """Restores the scene after apply() has raised an error."""


class BackgroundWork:
    """A Job whose run() works in a separate thread.

    Whatever one of its callbacks raises ends the work. result() raises the first such error.
    """

    def __init__(self, job: Job) -> None:
        self.progress = leaflight.Progress()
        self._job = job
        self._error: BaseException | None = None
        # True once the window has shown the end of the work.
        self.is_shown_over = False
        self._thread = threading.Thread(target=self._run, name="Leaflight")
        self._thread.start()

    def _run(self) -> None:
        try:
            self._job.run(self.progress)
        except BaseException as error:  # result() raises it in the main thread
            self._keep(error)

    def _keep(self, error: BaseException) -> None:
        # Keep the first error, because an error causes a cancellation.
        self._error = self._error or error

    def _guarded(self, call: Callable[[], T], otherwise: T) -> T:
        """Returns the result of a callback of the job. An error in it ends the work."""
        try:
            return call()
        except Exception as error:
            self._keep(error)
            self.progress.cancel()
            return otherwise

    def is_alive(self) -> bool:
        return self._thread.is_alive()

    def wait(self, seconds: float) -> None:
        self._thread.join(seconds)

    def cancel(self) -> None:
        self.progress.cancel()

    def fraction(self) -> float:
        return self._guarded(lambda: self._job.fraction(self.progress), 0.0)

    def status(self) -> str:
        return self._guarded(lambda: self._job.status(self.progress), "")

    def show(self) -> None:
        self._guarded(self._job.show, None)

    def result(self) -> None:
        """Waits for the end and raises the first error of the work."""
        self._thread.join()
        if self._error is not None:
            raise self._error


def running() -> BackgroundWork | None:
    """Returns the BackgroundWork in progress, or None."""
    return _running


def set_running(work: BackgroundWork | None) -> None:
    """Sets the work in progress, or None."""
    global _running
    _running = work


def cancel_running() -> None:
    if _running is not None:
        _running.cancel()


def abandon() -> None:
    """Cancels and drops the work in progress, before another file is opened."""
    cancel_running()
    set_running(None)


def print_progress(name: str, work: BackgroundWork) -> None:
    """Waits for the work. Prints a bar to a terminal, or else a line for each tenth."""
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


def viewports() -> list[tuple[bpy.types.Window, bpy.types.Area]]:
    """Returns (window, area) of each open viewport."""
    windows = bpy.context.window_manager.windows
    found = [(window, area) for window in windows for area in window.screen.areas]
    return [(window, area) for window, area in found if area.type == "VIEW_3D"]


def status_of(fraction: float, stage: str) -> str:
    """Returns a progress, 0 to 1, and the name of the present work as text."""
    return f"{100.0 * fraction:3.0f} % {stage}"


def show_status(text: str | None) -> None:
    """Shows a text in the status bar. None removes it."""
    # Each workspace keeps its text, so remove it from those that were shown meanwhile, too.
    for workspace in bpy.data.workspaces:
        workspace.status_text_set(text)


def redraw_panels() -> None:
    """Redraws the sidebars and headers of viewports, but not the viewports, which are slow."""
    for _, area in viewports():
        for region in area.regions:
            if region.type in {"UI", "TOOL_HEADER"}:
                region.tag_redraw()
