# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/plain_docstrings.py: what the site makes of a docstring in plain text."""

import importlib.util
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "docs" / "plain_docstrings.py"


@pytest.fixture(scope="module")
def rewritten():
    spec = importlib.util.spec_from_file_location(SOURCE.stem, SOURCE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.rewritten


def fields(lines):
    return [line for line in lines if line.startswith(":param ")]


def test_parameters_become_a_list(rewritten):
    lines = [
        "Reads a file.",
        "",
        "path: of the file,",
        "    with its suffix. None: takes one; time: seconds",
        'kind ("a", "b"), end: of the values.',
        "Returns a dict: of *all* and `code`.",
    ]
    found = rewritten(lines, {"path", "time", "kind", "end"})
    assert fields(found) == [
        ":param path: of the file, with its suffix; None: takes one",
        ":param time: seconds",
        ':param kind,end: ("a", "b"): of the values.',
    ]
    assert found[1] == "Reads a file." and r"Returns a dict: of \*all\* and ``code``." in found


def test_a_paragraph_with_indentation_keeps_its_lines(rewritten):
    found = rewritten(["Use it:", "", "    one", "      two"], set())
    assert found[-5:] == ["::", "", "        one", "          two", ""] and not fields(found)
