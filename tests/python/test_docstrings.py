# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests docs/plain_docstrings.py, which turns plain docstrings into tables of the site."""

import importlib.util
import inspect
from pathlib import Path

import leaflight
import pytest

SOURCE = Path(__file__).resolve().parents[2] / "docs" / "plain_docstrings.py"


@pytest.fixture(scope="module")
def plain_docstrings():
    spec = importlib.util.spec_from_file_location(SOURCE.stem, SOURCE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def rewritten(plain_docstrings):
    return plain_docstrings.rewritten


def rows(lines):
    """Returns the rows of the only table."""
    cells = [line.strip(" *-") for line in lines if line.startswith(("   * - ", "     - "))]
    return [tuple(cells[i : i + 3]) for i in range(0, len(cells), 3)]


def test_parameters_become_a_table(rewritten):
    lines = [
        "Reads a file.",
        "",
        "path: of the file,",
        "    with its suffix. None: takes one; time: seconds",
        'kind ("a", "b"), end: of the values.',
        "Returns a dict: of *all* and `code`.",
    ]
    found = rewritten(lines, {"path": "str | None", "time": "", "kind": "str", "end": "str"})
    assert rows(found) == [
        ("Parameter", "Type", "Description"),
        ("``path``", "``str | None``", "of the file, with its suffix; None: takes one"),
        ("``time``", "", "seconds"),
        ("``kind``, ``end``", "``str``", '("a", "b"): of the values.'),
    ]
    assert found[1] == "Reads a file." and r"Returns a dict: of \*all\* and ``code``." in found


def test_options_are_parameters(plain_docstrings):
    lines = inspect.getdoc(leaflight.bake).splitlines()
    plain_docstrings._process(None, None, None, leaflight.bake, None, lines)
    described = " ".join(names for names, *_ in rows(lines))
    for name in ("isovalues", "error", "seed", "on_pass", "checkpoint"):
        assert f"``{name}``" in described


def test_a_paragraph_with_indentation_keeps_its_lines(rewritten):
    found = rewritten(["Use it:", "", "    one", "      two"], {})
    assert found[-6:-1] == ["::", "", "        one", "          two", ""] and not rows(found)
