# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports run one way: a room knows only the rooms below it (docs/architecture.md)."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

# From the ground up. What stands in no room is below all of them, save the faces at the top.
PACKAGE = ("volume", "scene", "io", "bake", "flatland", "measure", "report", "bench", "cli")
ADDON = ("store", "operators", "show", "stage", "bake", "compare", "importing", "ui")
FACES = ("__init__.py", "__main__.py")


@pytest.mark.parametrize("folder, rooms", [("core/leaflight", PACKAGE), ("addon/leaflight", ADDON)])
def test_no_import_runs_back_up(folder, rooms):
    found = imports(ROOT / folder)
    assert all((ROOT / folder / room).is_dir() for room in rooms) and found
    wrong = [
        f"{file}:{line} imports {target}"
        for room, target, file, line in found
        if floor(target, rooms) > floor(room, rooms)
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("room", ["report", "bench"])
def test_the_addon_ships_without(room):
    sources = (ROOT / "addon/leaflight").rglob("*.py")
    assert not [path for path in sources if f"leaflight.{room}" in path.read_text()]


def floor(room, rooms):
    """0 below all rooms."""
    return rooms.index(room) + 1 if room in rooms else 0


def imports(folder):
    """(room, imported room, file, line) of all that the modules below a folder import of it."""
    found = []
    for path in sorted(folder.rglob("*.py")):
        place = path.relative_to(folder).parts
        if place[0] in FACES:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                # One dot is the module's own folder, each more the one above.
                base = place[: len(place) - node.level]
                target = (*base, *(node.module or "").split("."))
                names = [a.name for a in node.names] if target[-1] == "" else [None]
                for name in names:
                    whole = [part for part in (*target, name) if part]
                    found.append((place[0], whole[0], path.relative_to(ROOT), node.lineno))
    return found
