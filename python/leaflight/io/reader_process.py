# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a library which trusts them reads: by a process of their own.

A damaged file can end the process that opens it with OpenVDB or HDF5, or keep it busy for hours.
This one has limits of time and memory, and what it does, Blender survives.
"""

import io
import json
import math
import os
import subprocess
import sys
import threading
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from .._core import LeaflightError, Progress
from ..arrays import Array
from .process_limits import limit_process

# Seconds of a processor for any file, and bytes that are read in one more.
LEAST_SECONDS = 60
BYTES_PER_SECOND = 1e6
# A processor is not always there for us alone.
WAIT = 5
# Bytes of an answer, and of what is filled between looks at the progress.
_MOST_ANSWER, _PIECE = 1 << 24, 1 << 22
_CHILD = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
_CHILD += "from leaflight.io.reader_process import child; child()"


class ReaderProcess:
    """A process that calls function(path, *options) of a module of this package; a context manager.

    kind: of file, for people. The function returns (answer, pieces): what JSON can hold, and the
    arrays, C-contiguous, whose bytes fill() gets. options: what JSON can hold.
    """

    def __init__(
        self, path: str | os.PathLike[str], kind: str, module: str, function: str, *options: object
    ) -> None:
        self.path, self.kind = path, kind
        size = Path(path).stat().st_size
        self.seconds = math.ceil(LEAST_SECONDS + size / BYTES_PER_SECOND)
        job = json.dumps([str(path), self.seconds, module, function, *options])
        hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)
        try:
            self._process = subprocess.Popen(
                [_python(), "-c", _CHILD, json.dumps(sys.path), job],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                creationflags=hidden,
            )
        except OSError as error:
            raise LeaflightError(
                f"{path}: the process that is to read it cannot start: {error.strerror}; close "
                "other programs and try again."
            ) from None
        output = self._process.stdout
        assert isinstance(output, io.BufferedReader)
        self._output = output
        self._timer = threading.Timer(WAIT * self.seconds, self._process.kill)

    def __enter__(self) -> "ReaderProcess":
        self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        self._process.kill()
        self._output.close()
        self._process.wait()

    def answer(self) -> Any:
        """What the function answers.

        Raises LeaflightError and ModuleNotFoundError as it does, and ValueError where it raises
        anything else.
        """
        try:
            answer = json.loads(self._output.readline(_MOST_ANSWER))
        except ValueError:
            raise self.died() from None
        if "refusal" in answer:
            raise LeaflightError(answer["refusal"])
        if "absent" in answer:
            raise ModuleNotFoundError(name=answer["absent"])
        if "failure" in answer:
            raise ValueError(answer["failure"])
        return answer["answer"]

    def fill(self, values: Array, progress: Progress | None = None) -> None:
        """Fills an array with the pieces, in their order, and reports the bytes to a Progress."""
        left = values.data.cast("B")
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
            f"{self.path}: this {self.kind} is damaged, or needs too much memory or more than "
            f"{self.seconds} s: the process that read it did not live to its end; fetch the file "
            "again."
        )


def _python() -> str:
    """The interpreter: where Python is part of a program, sys.executable may be another one."""
    names = ("bin/python{}.{}", "bin/python3", "python.exe", "bin/python.exe")
    for name in names:
        path = Path(sys.prefix, name.format(*sys.version_info))
        if path.is_file():
            return str(path)
    return sys.executable


def child() -> NoReturn:
    """Calls the function and answers with a line of JSON, behind it the pieces."""
    path, seconds, module, function, *options = json.loads(sys.argv[2])
    limit_process(seconds)
    out = sys.stdout.buffer
    pieces: Iterable[Array] = ()
    try:
        called = getattr(import_module(module), function)
        answer, pieces = called(Path(path), *options)
        answer = {"answer": answer}
    except LeaflightError as error:
        answer = {"refusal": str(error)}
    except ImportError as error:
        answer = {"absent": error.name or str(error)}
    except Exception as error:
        # On damaged files libraries fail with whatever comes first.
        answer = {"failure": type(error).__name__}
    out.write(json.dumps(answer).encode() + b"\n")
    for piece in pieces:
        out.write(piece.data)
    out.flush()
    # What libraries do at the end of a process does not matter any more.
    os._exit(0)
