# SPDX-License-Identifier: GPL-3.0-or-later
"""The program `leaflight`.

Outside the package, so that what the package says when it refuses to load comes as one line, not as
a traceback.
"""

import sys


def main():
    try:
        from leaflight.cli import main as command_line
    except ImportError as refusal:
        print(f"leaflight: {refusal}", file=sys.stderr)
        return 2
    return command_line()


if __name__ == "__main__":
    sys.exit(main())
