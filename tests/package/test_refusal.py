# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that the user reads the reason if the package cannot be used, and that no other part of the
add-on is active.
"""

import re

import pytest

ENABLE = """
import bpy, re, sys
from pathlib import Path
archive, file, old, new = sys.argv[-4:]
bpy.ops.preferences.addon_install(filepath=archive)
path = Path(bpy.utils.user_resource("SCRIPTS")) / "addons" / "modules" / "leaflight" / file
changed = re.sub(old, new, path.read_text())
assert changed != path.read_text()
path.write_text(changed)
bpy.ops.preferences.addon_enable(module="leaflight_addon")
print("panels:", [n for n in dir(bpy.types) if n.startswith("LEAFLIGHT_PT")])
preferences = bpy.context.preferences.addons["leaflight_addon"].preferences
print("preferences:", type(preferences).__name__)
"""


@pytest.mark.parametrize(
    "file, old, new, sentence",
    [
        (
            "self_check.py",
            r"OLDEST_NUMPY = .*",
            "OLDEST_NUMPY = (9, 0)",
            "Leaflight needs NumPy 9.0 or newer",
        ),
        (
            "version.py",
            r'"\d.*"',
            '"99.0"',
            "but version 99.0 of the package leaflight is loaded from",
        ),
    ],
)
def test_the_sentence_comes_instead_of_the_addon(
    run, plain_environment, made, tmp_path, file, old, new, sentence
):
    for name in ("config", "scripts"):
        (tmp_path / name).mkdir()
    shown = run(
        *("blender", "--background", "--factory-startup", "--python-exit-code", "1"),
        *("--python-expr", ENABLE, "--", made["legacy"], file, old, new),
        env=plain_environment(
            BLENDER_USER_CONFIG=str(tmp_path / "config"),
            BLENDER_USER_SCRIPTS=str(tmp_path / "scripts"),
        ),
    )
    assert sentence in shown and "Traceback" not in shown
    assert "panels: ['LEAFLIGHT_PT_refused']" in shown
    assert re.search("preferences: LeaflightRefused", shown)
