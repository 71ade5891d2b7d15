# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs long work in its own thread, with a progress bar. Ctrl-C ends the work."""

import functools
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable
from typing import Any, Literal, ParamSpec, Protocol, TextIO, TypeVar, overload

from ._core import Cancelled, LeaflightError, Progress

# Shorter work shows no bar.
PATIENCE_SECONDS = 1.0
POLL_SECONDS = 0.1
BAR_CELLS = 30
NOTHING_WRITTEN = "cancelled, nothing written."

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
P = ParamSpec("P")


class WithProgress(Protocol[P, T_co]):
    """A function that with_progress() decorated, with the wider type of `progress`."""

    @overload
    def __call__(self, *arguments: P.args, **options: P.kwargs) -> T_co: ...
    @overload
    def __call__(
        self,
        *arguments: Any,
        progress: Callable[[float, str], object] | Literal[False],
        **options: Any,
    ) -> T_co: ...


class _Display(Protocol):
    def show(self, fraction: float, stage: str) -> None: ...
    def close(self) -> None: ...


def with_progress(label: str) -> Callable[[Callable[P, T]], WithProgress[P, T]]:
    """Decorates a function with a Progress parameter `progress`, to accept other values, too.

    None shows a bar in a terminal, on stderr, or in the output of a notebook. False shows no bar. A
    function is called with the fraction and the stage, ten times a second, in the thread of the
    caller.
    """

    def decorate(function: Callable[P, T]) -> WithProgress[P, T]:
        call: Callable[..., T] = function

        @functools.wraps(function)
        def wrapper(*arguments: Any, progress: Any = None, **options: Any) -> T:
            if isinstance(progress, Progress):
                return call(*arguments, progress=progress, **options)

            def work(inner: Progress) -> T:
                return call(*arguments, progress=inner, **options)

            if callable(progress):
                return _run(work, label, _Calls(progress), KeyboardInterrupt)
            # Only the main thread gets Ctrl-C, and other threads would draw many bars.
            if threading.current_thread() is not threading.main_thread():
                return work(Progress())
            display: _Display = _display(label) if progress is None else _Nothing()
            return _run(work, label, display, KeyboardInterrupt)

        return wrapper

    return decorate


def run_with_progress(
    work: Callable[[Progress], T],
    label: str,
    stream: TextIO | None = None,
    writes: bool = False,
    cancelled: str = NOTHING_WRITTEN,
) -> T:
    """Returns work(progress), for a command line: see _run().

    A terminal gets a bar, any other stream one line per tenth of the work.

    writes: True if the work ends by writing its result. Ctrl-C is then ignored, because only the
        summary is left to print.
    cancelled: Message of Cancelled.
    """
    stream = stream or sys.stderr
    # stderr is None if it was closed when the program started.
    display = _Bar(label, stream, stream is not None and stream.isatty())
    return _run(work, label, display, lambda: Cancelled(cancelled), writes)


def _run(
    work: Callable[[Progress], T],
    label: str,
    display: _Display,
    interrupted: Callable[[], BaseException],
    writes: bool = False,
) -> T:
    """Runs work(progress) in another thread, shows its progress in this one, returns its result.

    Ctrl-C cancels the work, waits for its end and raises interrupted(). Exceptions of the work are
    raised here.
    """
    progress = Progress()
    results: list[T] = []
    errors: list[BaseException] = []

    def run() -> None:
        try:
            results.append(work(progress))
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run, name=label)
    before = signal.getsignal(signal.SIGINT)
    # Python cannot restore the handler of a program that embeds it, such as Blender. It is None
    # then.
    if before == signal.SIG_IGN or threading.current_thread() is not threading.main_thread():
        before = None
    if before is not None:
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
        written = writes and bool(results)
        if before is not None:
            signal.signal(signal.SIGINT, signal.SIG_IGN if written else before)
        display.close()
    if progress.cancelled and not written:
        raise interrupted()
    if errors:
        raise errors[0]
    return results[0]


def _display(label: str) -> _Display:
    """Returns the bar of a terminal or a notebook: that of tqdm if it is installed, else _Bar."""
    ipython = sys.modules.get("IPython")
    is_notebook = ipython is not None and hasattr(ipython.get_ipython(), "kernel")
    if not (is_notebook or (sys.stderr is not None and sys.stderr.isatty())):
        return _Nothing()
    # Notebooks color stderr red, also the blanks that erase a bar.
    stream = sys.stdout if is_notebook else sys.stderr
    try:
        with warnings.catch_warnings():
            # Ignore tqdm's warning about a notebook without ipywidgets; it then prints text.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return _Bar(label, stream, redraws=True)
    return _Tqdm(tqdm, label, stream)


class _Nothing:
    def show(self, fraction: float, stage: str) -> None:
        pass

    def close(self) -> None:
        pass


class _Calls(_Nothing):
    """A display that calls the caller's function."""

    def __init__(self, function: Callable[[float, str], object]) -> None:
        self._function = function

    def show(self, fraction: float, stage: str) -> None:
        self._function(fraction, stage)


class _Tqdm:
    def __init__(self, tqdm: Any, label: str, stream: TextIO) -> None:
        self._bar = tqdm(
            file=stream,
            total=100,
            desc=label,
            delay=PATIENCE_SECONDS,
            leave=False,
            bar_format="{desc} {percentage:3.0f} %|{bar}| {elapsed}{postfix}",
        )

    def show(self, fraction: float, stage: str) -> None:
        self._bar.set_postfix_str(stage, refresh=False)
        self._bar.update(100 * fraction - self._bar.n)

    def close(self) -> None:
        self._bar.close()


class _Bar:
    """A bar of text. redraws: True redraws one line; False prints a line per tenth of the work."""

    def __init__(self, label: str, stream: TextIO | None, redraws: bool) -> None:
        self.label, self.stream, self.redraws = label, stream, redraws
        self.start = time.monotonic()
        self.tenths = 0
        self.drawn = ""

    def show(self, fraction: float, stage: str) -> None:
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

    def close(self) -> None:
        if self.drawn:
            self._draw("")

    def _draw(self, line: str) -> None:
        # Pad with blanks to erase a longer previous line.
        self._print("\r" + line.ljust(len(self.drawn)) + ("" if line else "\r"))
        self.drawn = line

    def _print(self, text: str) -> None:
        try:
            if self.stream is not None:
                print(text, end="", file=self.stream, flush=True)
        except OSError:
            # The stream was closed. The work goes on without a bar.
            self.stream = None
