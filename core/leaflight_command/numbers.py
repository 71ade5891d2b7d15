# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on the command line, within the bounds that the core has for them."""

import argparse
import math


def integer(text):
    """A whole number as the core holds them."""
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a whole number") from None
    if not -(2**31) <= value < 2**31:
        raise argparse.ArgumentTypeError(f"{text[:40]} is beyond 2^31")
    return value


def number(text):
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a finite number")
    return value
