# SPDX-License-Identifier: GPL-3.0-or-later
"""Decodes compressed pages of pictures in one subprocess for all pages of a volume."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

from ...arrays import Array
from ...paths import AnyPath
from ..reader_process import ENDLESS, ReaderProcess


@dataclass
class _Processes:
    """Processes by (module, function), and the stack that ends them."""

    started: dict[tuple[str, str], ReaderProcess] = field(default_factory=dict)
    ends: ExitStack = field(default_factory=ExitStack)


_kept: ContextVar[_Processes | None] = ContextVar("_kept", default=None)


@contextmanager
def kept_processes() -> Iterator[None]:
    """Keeps a process of each kind alive for decoded() within the context."""
    processes = _Processes()
    with processes.ends:
        before = _kept.set(processes)
        try:
            yield
        finally:
            _kept.reset(before)


def decoded(
    path: AnyPath, kind: str, function: tuple[str, str], most: int, *request: object
) -> Array:
    """Returns the page of a file that a function decodes in a subprocess.

    kind: Kind of file, for messages.
    function: (module, name) of a function that answers reader_process.requests() of (path,
        *request).
    most: Upper bound on the bytes of the page.
    Raises LeaflightError, ModuleNotFoundError and ValueError as ReaderProcess does.
    """
    processes = _kept.get()
    if processes is None:
        with kept_processes():
            return decoded(path, kind, function, most, *request)
    process = processes.started.get(function)
    if process is None:
        process = processes.ends.enter_context(ReaderProcess(path, kind, *function, size=ENDLESS))
        process.answer()
        processes.started[function] = process
    try:
        return process.ask(path, most, *request)
    except Exception:
        # The process has ended.
        del processes.started[function]
        raise
