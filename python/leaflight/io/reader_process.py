# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the readers of compiled libraries in a subprocess.

A damaged file can crash OpenVDB or HDF5, or keep them busy for hours. The subprocess has limits on
time and memory, and Blender survives its end. Only the subprocess imports h5py, numcodecs,
imagecodecs and the plug-ins of pydicom. Their copies of libraries would clash with those in
Blender.
"""

import io
import json
import math
import os
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from importlib import import_module
from importlib.machinery import PathFinder
from math import prod
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from .._core import LeaflightError, Progress
from ..arrays import Array
from ..paths import AnyPath
from ..volume.memory import bytes_of
from ..volume.setting_error import SettingError
from .process_limits import limit_process

# Limit on processor time: seconds for any file, and bytes for each second more.
LEAST_SECONDS = 60
BYTES_PER_SECOND = 1e6
ENDLESS = 10**12
# Limit on wall-clock time over processor time, because other programs use the processor, too.
WAIT = 5
# Upper bounds on the bytes of an answer, and on those filled between two progress reports.
_MOST_ANSWER, _PIECE = 1 << 24, 1 << 22
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
_CHILD += "from leaflight.io.reader_process import child; child()"
# Folders of packages that the subprocess imports before installed ones. Blender's process does not
# find them.
PACKAGES = [
    str(Path(__file__).parents[2] / name) for name in ("leaflight_readers", "leaflight_codecs")
]


def has_package(name: str) -> bool:
    """Returns True if reader processes find a package."""
    return PathFinder.find_spec(name, [*PACKAGES, *sys.path]) is not None


class ReaderProcess:
    """A context manager: a subprocess that calls function(path, *options) of a module of this
        package.

    The function returns (answer, pieces): JSON data, and C-contiguous arrays for fill() and
        array().

    kind: Kind of file, for messages.
    options: JSON data.
    size: Bytes to read. None is the size of the file. ENDLESS is for a function that answers
        requests(), each with its own limit.
    """

    def __init__(
        self,
        path: AnyPath,
        kind: str,
        module: str,
        function: str,
        *options: object,
        size: int | None = None,
    ) -> None:
        self.path, self.kind = path, kind
        self.seconds = _seconds(Path(path).stat().st_size if size is None else size)
        job = json.dumps([str(path), self.seconds, module, function, *options])
        hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)
        try:
            self._process = subprocess.Popen(
                [_python(), "-c", _CHILD, json.dumps([*PACKAGES, *sys.path]), job],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                creationflags=hidden,
            )
        except OSError as error:
            raise LeaflightError(
                f"{path}: the subprocess that reads it cannot start: {error.strerror}; close "
                "other programs and try again."
            ) from None
        output = self._process.stdout
        assert isinstance(output, io.BufferedReader) and self._process.stdin is not None
        self._output, self._input = output, self._process.stdin
        self._timer = self._started_timer()

    def _started_timer(self) -> threading.Timer:
        timer = threading.Timer(WAIT * self.seconds, self._process.kill)
        timer.daemon = True
        timer.start()
        return timer

    def __enter__(self) -> "ReaderProcess":
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        self._process.kill()
        self._output.close()
        with suppress(OSError):
            self._input.close()
        self._process.wait()

    def ask(self, path: AnyPath, most: int, *request: object) -> Array:
        """Returns the answer to a request about a file: an array of at most `most` bytes."""
        self.path, self.seconds = path, _seconds(most)
        self._timer.cancel()
        self._timer = self._started_timer()
        try:
            self._input.write(json.dumps([str(path), *request]).encode() + b"\n")
            self._input.flush()
        except OSError:
            raise self.died() from None
        try:
            return self.array(most)
        finally:
            self._timer.cancel()

    def answer(self) -> Any:
        """Returns the answer of the function.

        Raises its LeaflightError and ModuleNotFoundError. Other exceptions become ValueError.
        fill() and array() do the same.
        """
        return self._message()["answer"]

    def fill(self, values: Array, progress: Progress | None = None) -> None:
        """Fills an array with the next pieces, and reports the bytes to a Progress."""
        left = bytes_of(values)
        while left:
            shape, dtype = self._piece()
            size = prod(shape) * dtype.itemsize
            if size > len(left):
                raise self.died()
            self._read(left[:size], progress)
            left = left[size:]

    def array(self, most: int) -> Array:
        """Returns the next array, of at most `most` bytes."""
        shape, dtype = self._piece()
        if prod(shape) * dtype.itemsize > most:
            raise self.died()
        values = np.empty(shape, dtype)
        self._read(bytes_of(values), None)
        return values

    def _piece(self) -> tuple[tuple[int, ...], np.dtype[Any]]:
        message = self._message()
        shape, dtype = tuple(map(int, message["shape"])), np.dtype(message["dtype"])
        if min(shape, default=1) < 0 or dtype.kind not in "biuf":
            raise self.died()
        return shape, dtype

    def _message(self) -> dict[str, Any]:
        try:
            message: dict[str, Any] = json.loads(self._output.readline(_MOST_ANSWER))
        except ValueError:
            raise self.died() from None
        if "refusal" in message:
            sentence, settings = message["refusal"], message["settings"]
            raise SettingError(sentence, *settings) if settings else LeaflightError(sentence)
        if "missing" in message:
            raise ModuleNotFoundError(name=message["missing"])
        if "failure" in message:
            raise ValueError(message["failure"])
        return message

    def _read(self, left: memoryview, progress: Progress | None) -> None:
        while left:
            if progress is not None:
                progress.check()
            count = self._output.readinto(left[:_PIECE])
            if not count:
                raise self.died()
            if progress is not None:
                progress.advance(count)
            left = left[count:]

    def died(self) -> LeaflightError:
        return LeaflightError(
            f"{self.path}: the subprocess that read this {self.kind} crashed or exceeded its "
            f"limits of memory or {self.seconds} s: fetch the file again, or use a smaller one."
        )


def _seconds(size: int) -> int:
    """Returns the limit of processor seconds for this many bytes."""
    return math.ceil(LEAST_SECONDS + size / BYTES_PER_SECOND)


def _python() -> str:
    """Returns the Python interpreter. In Blender, sys.executable may be another program."""
    names = ("bin/python{}.{}", "bin/python3", "python.exe", "bin/python.exe")
    for name in names:
        path = Path(sys.prefix, name.format(*sys.version_info))
        if path.is_file():
            return str(path)
    return sys.executable


def requests() -> Iterator[list[Any]]:
    """Yields [path, ...] of each request in the subprocess. One array answers each."""
    for line in sys.stdin.buffer:
        yield json.loads(line)


def child() -> NoReturn:
    """Calls the function in the subprocess. Writes a line of JSON for the answer and each array."""
    path, seconds, module, function, *options = json.loads(sys.argv[2])
    limit_process(seconds)
    out = sys.stdout.buffer

    def tell(message: dict[str, Any]) -> None:
        out.write(json.dumps(message).encode() + b"\n")

    pieces: Iterable[Array]
    try:
        called = getattr(import_module(module), function)
        answer, pieces = called(Path(path), *options)
        tell({"answer": answer})
        out.flush()
        for piece in pieces:
            tell({"shape": piece.shape, "dtype": piece.dtype.str})
            out.write(piece.data)
            out.flush()
    except LeaflightError as error:
        tell({"refusal": str(error), "settings": getattr(error, "settings", ())})
    except ImportError as error:
        tell({"missing": error.name or str(error)})
    except Exception as error:
        # On damaged files libraries raise many types of exceptions.
        tell({"failure": type(error).__name__})
    out.flush()
    # Skip the exit handlers of libraries.
    os._exit(0)


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
