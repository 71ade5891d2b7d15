# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `leaflight`.

It is outside the package, because loading that takes time. So --help and errors in options appear
at once. If the package cannot be loaded, the error is one line.
"""

import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

from .parser import make_parser
from .shared_options import UsageError


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit status."""
    try:
        options = make_parser().parse_args(arguments)
        from leaflight.cli import run
    except KeyboardInterrupt:
        return 130
    except (UsageError, ImportError, MemoryError) as refusal:
        why = str(refusal) or "There is not enough memory to start: close other programs."
        if sys.stderr is not None:
            print(f"leaflight: {why}", file=sys.stderr)
        return 2
    return run(options)


def program() -> NoReturn:
    """Runs the command of the program's arguments and ends it with its exit status."""
    status = main()
    # Ignore Ctrl-C during exit, because the work is done and reported.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
