# SPDX-License-Identifier: GPL-3.0-or-later
"""Compressed pages of pictures, which one process decodes for all that a volume takes."""

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

from ...arrays import Array
from ..reader_process import ENDLESS, ReaderProcess


@dataclass
class _Processes:
    """By (module, function), and what ends them."""

    started: dict[tuple[str, str], ReaderProcess] = field(default_factory=dict)
    ends: ExitStack = field(default_factory=ExitStack)


_kept: ContextVar[_Processes | None] = ContextVar("_kept", default=None)


@contextmanager
def kept_processes() -> Iterator[None]:
    """While this lasts, decoded() needs no more than one process of each kind."""
    processes = _Processes()
    with processes.ends:
        before = _kept.set(processes)
        try:
            yield
        finally:
            _kept.reset(before)


def decoded(
    path: str | os.PathLike[str], kind: str, function: tuple[str, str], most: int, *request: object
) -> Array:
    """Returns the page of a file that a function decodes in a subprocess.

    kind: of file, for people; function: (module, name) of one that answers reader_process
    .requests() of (path, *request); most: bytes that the page may have.
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
        # It has ended.
        del processes.started[function]
        raise
