# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread of its own: a bar shows how far it is, and Ctrl-C ends it."""

import functools
import signal
import sys
import threading
import time
import warnings

from ._core import Cancelled, LeaflightError, Progress

# Work shorter than this shows nothing.
PATIENCE_SECONDS = 1.0
POLL_SECONDS = 0.1
BAR_CELLS = 30
NOTHING_WRITTEN = "cancelled, nothing written."


def with_progress(label):
    """Decorates a function that takes `progress`, a Progress, with what else its callers may give:

    None: a bar on stderr, if that is a terminal or a notebook; False: none; a function: called
    with the fraction and the stage, ten times a second, in the thread of the caller.
    """

    def decorate(function):
        @functools.wraps(function)
        def wrapper(*arguments, progress=None, **options):
            if isinstance(progress, Progress):
                return function(*arguments, progress=progress, **options)

            def work(own):
                return function(*arguments, progress=own, **options)

            if callable(progress):
                return _run(work, label, _Calls(progress), KeyboardInterrupt)
            # Threads of a program may be many, and have no Ctrl-C.
            if threading.current_thread() is not threading.main_thread():
                return work(Progress())
            display = _display(label) if progress is None else _Nothing()
            return _run(work, label, display, KeyboardInterrupt)

        return wrapper

    return decorate


def run_with_progress(work, label, stream=None, writes=False, cancelled=NOTHING_WRITTEN):
    """Returns work(progress), for a command line: see _run().

    A terminal gets a bar that is redrawn, anything else one line per tenth of the work. writes:
    whether the work ends with writing what it found, so that once it returns a cancel comes too
    late: from then on Ctrl-C is ignored, since only telling what was done is left. cancelled: the
    sentence of Cancelled.
    """
    stream = stream or sys.stderr
    # None where stderr was closed from the beginning.
    display = _Bar(label, stream, stream is not None and stream.isatty())
    return _run(work, label, display, lambda: Cancelled(cancelled), writes)


def _run(work, label, display, interrupted, writes=False):
    """Returns work(progress), run in a thread of its own while this thread shows how far it is.

    Ctrl-C cancels the work, waits for it and raises interrupted(); its other exceptions are raised
    here.
    """
    progress = Progress()
    outcome = {}

    def run():
        try:
            outcome["result"] = work(progress)
        except BaseException as error:
            outcome["error"] = error

    thread = threading.Thread(target=run, name=label)
    before = signal.getsignal(signal.SIGINT)
    # None: a program that embeds Python, such as Blender, has a handler that cannot be restored.
    takes_interrupts = before not in (None, signal.SIG_IGN)
    takes_interrupts &= threading.current_thread() is threading.main_thread()
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
        try:
            while thread.is_alive():
                thread.join(POLL_SECONDS)
                display.show(progress.fraction, progress.stage)
        except BaseException:
            progress.cancel()
            thread.join()
            raise
    finally:
        written = writes and "result" in outcome
        if takes_interrupts:
            signal.signal(signal.SIGINT, signal.SIG_IGN if written else before)
        display.close()
    if progress.cancelled and not written:
        raise interrupted()
    if "error" in outcome:
        raise outcome["error"]
    return outcome["result"]


def _display(label):
    """Of a terminal or a notebook: tqdm's bar where that is installed, else ours."""
    ipython = sys.modules.get("IPython")
    is_notebook = ipython is not None and hasattr(ipython.get_ipython(), "kernel")
    if not (is_notebook or (sys.stderr is not None and sys.stderr.isatty())):
        return _Nothing()
    try:
        with warnings.catch_warnings():
            # Of a notebook without ipywidgets, where it is text.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return _Bar(label, sys.stderr, redraws=True)
    return _Tqdm(tqdm, label)


class _Nothing:
    def show(self, fraction, stage):
        pass

    def close(self):
        pass


class _Calls(_Nothing):
    """Calls a function of the caller."""

    def __init__(self, function):
        self.show = function


class _Tqdm:
    def __init__(self, tqdm, label):
        self._bar = tqdm(
            total=100,
            desc=label,
            delay=PATIENCE_SECONDS,
            leave=False,
            bar_format="{desc} {percentage:3.0f} %|{bar}| {elapsed}{postfix}",
        )

    def show(self, fraction, stage):
        self._bar.set_postfix_str(stage, refresh=False)
        self._bar.update(100 * fraction - self._bar.n)

    def close(self):
        self._bar.close()


class _Bar:
    """redraws: one line again and again, else a line per tenth of the work."""

    def __init__(self, label, stream, redraws):
        self.label, self.stream, self.redraws = label, stream, redraws
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
