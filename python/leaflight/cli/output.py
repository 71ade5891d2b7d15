# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the results of commands. A closed stdout or stderr does not fail a finished command."""

import json
import math
import os
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TextIO

# The return value of a command: its result, for --json, and sentences about it.
Output = tuple[dict[str, Any], Sequence[str]]
Command = Callable[[Namespace], Output]


def picked(options: Namespace, names: str) -> dict[str, Any]:
    """Returns some of the options, by their names in a text."""
    return {name: getattr(options, name) for name in names.split()}


def print_lines(lines: Iterable[str]) -> bool:
    """Prints lines to stdout. Returns False if that failed."""
    if sys.stdout is None:
        return True  # stdout was closed when the program started.
    try:
        for line in lines:
            print(_printable(line, sys.stdout))
        sys.stdout.flush()
        return True
    except OSError as error:
        print_error(
            f"The result cannot be printed: {error.strerror}; the command itself succeeded."
        )
        _send_to_nowhere(sys.stdout)
        return False


def print_error(sentence: str) -> None:
    """Prints one line to stderr, if that is open."""
    if sys.stderr is None:
        return
    try:
        print(_printable(f"leaflight: {sentence}", sys.stderr), file=sys.stderr, flush=True)
    except OSError:
        _send_to_nowhere(sys.stderr)


def json_line(result: Mapping[str, Any]) -> str:
    """Returns a result as one line of JSON, with null for infinite numbers."""
    return json.dumps(_finite(result), allow_nan=False)


def _printable(text: str, stream: TextIO) -> str:
    """Escapes characters that the stream cannot show, and names of files that are not UTF-8."""
    encoding = stream.encoding or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)


def _finite(value: object) -> object:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _send_to_nowhere(stream: TextIO) -> None:
    """Redirects the stream to the null device.

    Otherwise Python fails again when it flushes the stream at exit.
    """
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
    except (OSError, ValueError):
        pass
