# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests rules for the sources: imports and includes run downwards (docs/architecture.md),
functions are short, and no error outside the command line names a flag.

A package or folder there is a room.
"""

import ast
import re
from dataclasses import fields
from graphlib import TopologicalSorter
from pathlib import Path
from typing import get_type_hints

import pytest
from leaflight.bake.settings import BakeOptions, BakeSettings, CommonOptions, CommonSettings
from leaflight.measure.sampling import Sampling, SamplingOptions

ROOT = Path(__file__).resolve().parents[2]

# Packages from the bottom up. Files in no package are below all, except FACES at the top.
PACKAGE = "volume scene io bake cluster stills measure export flatland cli".split()
ADDON = "store operators show stage bake compare export importing edit ui".split()
FACES = ("__init__.py", "__main__.py", "blender.py")
CORE = "base field surface lights scene trace transport".split()
CORE += [f"bake/{room}" for room in "plan texels direct walls output indirect driver".split()]
CORE += ["io", "thesis"]


@pytest.mark.parametrize(
    "folder, rooms", [("python/leaflight", PACKAGE), ("addon/leaflight", ADDON)]
)
def test_no_import_runs_back_up(folder, rooms):
    found = imports(ROOT / folder)
    assert all((ROOT / folder / room).is_dir() for room in rooms) and found
    wrong = [
        f"{file}:{line} imports {target}"
        for room, target, file, line in found
        if floor(target, rooms) > floor(room, rooms)
    ]
    assert not wrong, "\n".join(wrong)


def test_no_include_runs_back_up():
    found = [(path, target) for path in core_sources() for target in includes(path)]
    assert {room(target) for _, target in found} == set(CORE)
    wrong = [
        f"{path.relative_to(ROOT)} includes {target.relative_to(ROOT)}"
        for path, target in found
        if CORE.index(room(target)) > CORE.index(room(path))
    ]
    assert not wrong, "\n".join(wrong)


def test_no_modules_of_the_addon_import_each_other():
    folder = ROOT / "addon/leaflight"
    known = {path.relative_to(folder).with_suffix("").parts for path in folder.rglob("*.py")}
    graph = {}
    for place in known - {("__init__",)}:
        tree = ast.parse((folder / Path(*place)).with_suffix(".py").read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.level:
                base = (*place[: len(place) - node.level], *filter(None, [node.module]))
                found = {(*base, alias.name) for alias in node.names} | {base}
                graph.setdefault(place, set()).update(found & known)
    assert len(graph) > 50
    TopologicalSorter(graph).prepare()  # raises CycleError


def test_the_addon_imports_no_compiled_module():
    files = [*(ROOT / "addon").rglob("*.py")]
    wrong = [path for path in files if "_core" in path.read_text()]
    assert len(files) > 50 and not wrong, wrong


SOURCES = ROOT / "core/src"
THESIS = ROOT / "core/thesis"


def core_sources():
    folders = (SOURCES, THESIS)
    return [path for end in ("h", "cpp") for of in folders for path in sorted(of.rglob(f"*.{end}"))]


def room(path):
    return "thesis" if path.is_relative_to(THESIS) else path.parent.relative_to(SOURCES).as_posix()


def includes(path):
    """Returns our headers that a file of the core includes."""
    names = re.findall(r'#include "(.+)"', path.read_text())
    return [(THESIS.parent if name.startswith("thesis/") else SOURCES) / name for name in names]


def floor(room, rooms):
    """Returns the number of a room from the bottom up; 0 is below all rooms."""
    return rooms.index(room) + 1 if room in rooms else 0


def imports(folder):
    """Returns (room, imported room, file, line) of the imports within a folder of modules."""
    found = []
    for path in sorted(folder.rglob("*.py")):
        place = path.relative_to(folder).parts
        if place[0] in FACES:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                # One dot is the module's own folder; each further dot is one folder up.
                base = place[: len(place) - node.level]
                target = (*base, *(node.module or "").split("."))
                names = [a.name for a in node.names] if target[-1] == "" else [None]
                for name in names:
                    whole = [part for part in (*target, name) if part]
                    found.append((place[0], whole[0], path.relative_to(ROOT), node.lineno))
    return found


def functions():
    """Yields (place, node) of each function of the package and of the add-on."""
    files = [*(ROOT / "python").rglob("*.py"), *(ROOT / "addon").rglob("*.py")]
    assert len(files) > 200
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef):
                yield f"{file.relative_to(ROOT)}:{node.lineno} {node.name}", node


def test_functions_are_short():
    """Checks for at most 60 lines without docstrings."""
    long = []
    for place, node in functions():
        text = ast.get_docstring(node, clean=False)
        lines = node.end_lineno - node.lineno - (text.count("\n") if text else -1)
        if lines > 60:
            long.append(f"{place}: {lines}")
    assert not long, "\n".join(long)


def test_functions_have_few_parameters():
    """Checks for at most 8 parameters; the fields of a settings dataclass count as one."""
    many = []
    for place, node in functions():
        known = node.args
        names = [one.arg for one in (*known.posonlyargs, *known.args, *known.kwonlyargs)]
        names += [one.arg for one in (known.vararg, known.kwarg) if one is not None]
        count = len([name for name in names if name not in ("self", "cls")])
        if count > 8:
            many.append(f"{place}: {count}")
    assert not many, "\n".join(many)


@pytest.mark.parametrize(
    "settings, options",
    [(CommonSettings, CommonOptions), (BakeSettings, BakeOptions), (Sampling, SamplingOptions)],
)
def test_options_are_the_settings_by_their_names(settings, options):
    types = {one.name: one.type for one in fields(settings)}
    assert types == get_type_hints(options)


def test_functions_of_the_core_are_short():
    """Checks for at most 60 lines, from a first column to the closing brace there."""
    start = re.compile(r"(?!namespace|struct|class|enum|using|template|inline constexpr)[A-Za-z]")
    long, found = [], 0
    for path in core_sources():
        lines = path.read_text().splitlines()
        for i, line in enumerate(lines):
            head = next((j for j in range(i, len(lines)) if lines[j].endswith(("{", ";", "}"))), i)
            if not start.match(line) or not lines[head].endswith("{"):
                continue
            found += 1
            count = lines.index("}", head) - i + 1
            if count > 60:
                long.append(f"{path.relative_to(ROOT)}:{i + 1}: {count}")
    assert found > 500 and not long, "\n".join(long)


def test_no_error_outside_the_command_line_names_a_flag():
    package = ROOT / "python/leaflight"
    paths = [path for path in package.rglob("*.py") if (package / "cli") not in path.parents]
    wrong = [place for path in paths for place in flags_in_errors(path)]
    assert len(paths) > 30 and not wrong, wrong


def test_no_error_of_the_core_names_a_flag():
    sources = core_sources()
    wrong = [path for path in sources if re.search(r'"[^"\n]*--[a-z][^"\n]*"', path.read_text())]
    assert len(sources) > 30 and not wrong, wrong


@pytest.mark.parametrize("text", ["give --dims", "check it (--type)."])
def test_a_flag_is_seen(tmp_path, text):
    path = tmp_path / "x.py"
    body = f"'Writes --dims.'\n    raise ValueError(f'{{x}}: {text}')"
    path.write_text(f"\ndef f(x):\n    {body}\n")
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
