# SPDX-License-Identifier: GPL-3.0-or-later
"""Text and HTML from numbers, for messages and notebooks."""

import math
from collections.abc import Iterable
from html import escape


def by(numbers: Iterable[float]) -> str:
    """Returns a text such as 181 x 217 x 181."""
    return " x ".join(f"{number:g}" for number in numbers)


def figures(*values: float) -> list[str]:
    """Returns values as text, with enough digits to tell close values apart."""
    span, most = max(values) - min(values), max(map(abs, values))
    digits = 6 if not 0 < span < most else max(6, math.ceil(math.log10(most / span)) + 3)
    return [f"{value:.{digits}g}" for value in values]


def html_table(title: str, facts: Iterable[tuple[str, str]]) -> str:
    """Returns an HTML table of [(label, value as text)]."""
    rows = "".join(
        f"<tr><th style='text-align: left'>{escape(what)}</th><td>{escape(text)}</td></tr>"
        for what, text in facts
    )
    return f"<table><caption>{escape(title)}</caption>{rows}</table>"
