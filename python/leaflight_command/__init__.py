# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `leaflight`.

It is outside the package, because loading that takes time. So --help and errors in options appear
at once. If the package cannot be loaded, the error is one line.
"""

import signal
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NoReturn

from .parser import make_parser
from .shared_options import Parser, UsageError

if TYPE_CHECKING:
    from leaflight.cli.output import Command


def main(
    arguments: Sequence[str] | None = None,
    parser: Callable[[], Parser] = make_parser,
    command: "Command | None" = None,
) -> int:
    """Runs one command; returns the exit status.

    parser, command: Parser and function of another program than `leaflight`, see leaflight.cli.run.
    """
    try:
        options = parser().parse_args(arguments)
        from leaflight.cli import run
    except KeyboardInterrupt:
        return 130
    except (UsageError, ImportError, MemoryError) as refusal:
        why = str(refusal) or "There is not enough memory to start: close other programs."
        if sys.stderr is not None:
            print(f"leaflight: {why}", file=sys.stderr)
        return 2
    return run(options, command)


def program(
    parser: Callable[[], Parser] = make_parser, command: "Command | None" = None
) -> NoReturn:
    """Runs the command of the program's arguments and ends it with its exit status."""
    status = main(None, parser, command)
    # Ignore Ctrl-C during exit, because the work is done and reported.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
