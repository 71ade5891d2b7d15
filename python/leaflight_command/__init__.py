# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `leaflight`.

Outside the package, so that what the package says when it refuses to load comes as one line, not as
a traceback; and so that help and mistakes in the options need not wait until it is loaded.
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

    parser, command: of a program beside `leaflight`, see leaflight.cli.run.
    """
    try:
        options = parser().parse_args(arguments)
        from leaflight.cli import run
    except KeyboardInterrupt:
        return 130
    except (UsageError, ImportError, MemoryError) as refusal:
        why = str(refusal) or "there is not enough memory to begin with."
        if sys.stderr is not None:
            print(f"leaflight: {why}", file=sys.stderr)
        return 2
    return run(options, command)


def program(
    parser: Callable[[], Parser] = make_parser, command: "Command | None" = None
) -> NoReturn:
    """Runs the command of the program's arguments and ends it with its exit status."""
    status = main(None, parser, command)
    # The work is done and reported: Ctrl-C while Python ends changes nothing.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
