# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on the command line, within the limits of the core."""

import argparse
import math
import re


def integer(text: str) -> int:
    """Returns an integer of 32 bits."""
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a whole number") from None
    if not -(2**31) <= value < 2**31:
        raise argparse.ArgumentTypeError(f"{text[:40]} is not within 32 bits")
    return value


def channel(text: str) -> int | str:
    """Returns the number of a channel, or its name."""
    return integer(text) if re.fullmatch("-?[0-9]+", text) else text


def memory(text: str) -> int:
    """Returns a number of bytes from text such as 4GiB, 800MiB or 16G."""
    units = {"M": 1 << 20, "G": 1 << 30, "T": 1 << 40, "MB": 10**6, "GB": 10**9, "TB": 10**12}
    found = re.fullmatch(r"([0-9.]+)\s*([MGT]B?|[MGT]iB)", text.strip())
    try:
        value = float(found[1]) * units[found[2].removesuffix("iB")] if found else math.nan
    except ValueError:
        value = math.nan
    if not 0 < value < 2**60:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a size, such as 4GiB or 800MiB")
    return int(value)


def number(text: str) -> float:
    """Returns a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not a finite number")
    return value
