# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that messages which the add-on can also show name no flags of the command line."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
OF_THE_COMMAND_LINE = {"cli"}


def test_no_error_outside_the_command_line_names_a_flag():
    package = ROOT / "python/leaflight"
    paths = [
        path
        for path in sorted(package.rglob("*.py"))
        if path.relative_to(package).parts[0] not in OF_THE_COMMAND_LINE
    ]
    wrong = [place for path in paths for place in flags_in_errors(path)]
    assert len(paths) > 30 and not wrong, wrong


def test_no_error_of_the_core_names_a_flag():
    sources = sorted((ROOT / "core/src").rglob("*.cpp"))
    wrong = [path for path in sources if re.search(r'"[^"\n]*--[a-z][^"\n]*"', path.read_text())]
    assert len(sources) > 30 and not wrong, wrong


@pytest.mark.parametrize("text", ["give --dims", "check it (--type)."])
def test_a_flag_is_seen(tmp_path, text):
    path = tmp_path / "x.py"
    path.write_text(
        f"""
def f(x):
    "Writes --dims."
    raise ValueError(f"{{x}}: {text}")
"""
    )
    assert flags_in_errors(path) == [f"{path}:4"]


def flags_in_errors(path):
    """Returns the places where the text of a raised error names a flag."""
    raised = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Raise)]
    return [
        f"{path}:{statement.lineno}"
        for statement in raised
        for node in ast.walk(statement)
        if isinstance(node, ast.Constant) and "--" in str(node.value)
    ]
