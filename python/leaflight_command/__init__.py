# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `leaflight`.

Outside the package, so that what the package says when it refuses to load comes as one line, not as
a traceback; and so that help and mistakes in the options need not wait until it is loaded.
"""

import signal
import sys

from .parser import make_parser
from .shared_options import UsageError


def main(arguments=None):
    """Runs one command; returns the exit status."""
    try:
        options = make_parser().parse_args(arguments)
        from leaflight.cli import run
    except KeyboardInterrupt:
        return 130
    except (UsageError, ImportError, MemoryError) as refusal:
        why = str(refusal) or "there is not enough memory to begin with."
        if sys.stderr is not None:
            print(f"leaflight: {why}", file=sys.stderr)
        return 2
    return run(options)


def program():
    """Runs the command of the program's arguments and ends it with its exit status."""
    status = main()
    # What was done is done and told: Ctrl-C while Python takes its leave changes nothing.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
