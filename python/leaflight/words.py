# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts in words, for people."""

from collections.abc import Iterable
from html import escape


def by(numbers: Iterable[float]) -> str:
    """Such as 181 x 217 x 181."""
    return " x ".join(f"{number:g}" for number in numbers)


def html_table(title: str, facts: Iterable[tuple[str, str]]) -> str:
    """Of [(what, its value as text)]."""
    rows = "".join(
        f"<tr><th style='text-align: left'>{escape(what)}</th><td>{escape(text)}</td></tr>"
        for what, text in facts
    )
    return f"<table><caption>{escape(title)}</caption>{rows}</table>"
