# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in the background of a command line: a progress display and Ctrl-C."""

import signal
import sys
import threading
import time

from .._core import Cancelled, LeaflightError, Progress

# Work shorter than this shows nothing.
PATIENCE_SECONDS = 1.0
POLL_SECONDS = 0.1
BAR_CELLS = 30
NOTHING_WRITTEN = "cancelled, nothing written."


def run_with_progress(work, label, stream=None, writes=False, cancelled=NOTHING_WRITTEN):
    """Returns work(progress), run in a thread of its own while the main thread shows how far it is.

    A terminal gets a bar that is redrawn, anything else one line per tenth of the work. Ctrl-C
    cancels the work, waits for it and raises Cancelled; its other exceptions are raised here.
    writes: whether the work ends with writing what it found, so that once it returns a cancel comes
    too late: from then on Ctrl-C is ignored, since only telling what was done is left. cancelled:
    the sentence of Cancelled.
    """
    progress = Progress()
    outcome = {}

    def run():
        try:
            outcome["result"] = work(progress)
        except BaseException as error:
            outcome["error"] = error

    thread = threading.Thread(target=run, name=label)
    display = _Display(label, stream or sys.stderr)
    before = signal.getsignal(signal.SIGINT)
    # None: a program that embeds Python, such as Blender, has a handler that cannot be restored.
    takes_interrupts = before not in (None, signal.SIG_IGN)
    if takes_interrupts:
        signal.signal(signal.SIGINT, lambda *_: progress.cancel())
    try:
        try:
            thread.start()
        except RuntimeError:
            raise LeaflightError(
                "There is not enough memory for another thread; close other programs, or raise "
                "the limit (ulimit)."
            ) from None
        while thread.is_alive():
            thread.join(POLL_SECONDS)
            display.show(progress.fraction, progress.stage)
    finally:
        written = writes and "result" in outcome
        if takes_interrupts:
            signal.signal(signal.SIGINT, signal.SIG_IGN if written else before)
        display.close()
    if progress.cancelled and not written:
        raise Cancelled(cancelled)
    if "error" in outcome:
        raise outcome["error"]
    return outcome["result"]


class _Display:
    def __init__(self, label, stream):
        self.label = label
        self.stream = stream
        # None where stderr was closed from the beginning.
        self.redraws = stream is not None and stream.isatty()
        self.start = time.monotonic()
        self.tenths = 0
        self.drawn = ""

    def show(self, fraction, stage):
        seconds = time.monotonic() - self.start
        if seconds < PATIENCE_SECONDS:
            return
        line = f"{100 * fraction:3.0f} % {stage}, {seconds:.0f} s"
        if self.redraws:
            filled = int(BAR_CELLS * fraction)
            bar = "#" * filled + "." * (BAR_CELLS - filled)
            self._draw(f"{self.label} [{bar}] {line}")
        elif int(10 * fraction) > self.tenths:
            self.tenths = int(10 * fraction)
            self._print(f"{self.label}: {line}\n")

    def close(self):
        if self.drawn:
            self._draw("")

    def _draw(self, line):
        # Padding wipes the rest of a longer line drawn before.
        self._print("\r" + line.ljust(len(self.drawn)) + ("" if line else "\r"))
        self.drawn = line

    def _print(self, text):
        try:
            if self.stream is not None:
                print(text, end="", file=self.stream, flush=True)
        except OSError:
            # Nobody listens any more, which is no reason to lose the work.
            self.stream = None
