# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any


def table(rows: Sequence[Mapping[str, Any]], formats: Mapping[str, str]) -> list[str]:
    """Returns the lines of a Markdown table. formats: Format of each column, by its name."""
    if not rows:
        return []
    lines = [_line(rows[0]), "|" + "---|" * len(rows[0])]
    return [*lines, *(_line(_cell(row[name], formats.get(name)) for name in row) for row in rows)]


def _cell(value: Any, form: str | None) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    assert form is not None
    if hasattr(value, "low"):
        return f"{form.format(value.value)} ({form.format(value.low)} .. {form.format(value.high)})"
    return form.format(value)


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"
