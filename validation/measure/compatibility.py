# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the table of docs/reliability.md from the results of tests in build/compatibility.

Only whole sets count, those of `scripts/test blender-VERSION -m ''`, not those of the short suite.
"""

import argparse
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "build" / "compatibility"
TARGET = ROOT / "docs" / "reliability.md"
BEGIN, END = "<!-- compatibility -->", "<!-- /compatibility -->"

# Names of checks in check_lights.py, by the lamp that they measure.
LAMPS = {
    "area": "check_area_lights",
    "point": "check_a_point_light_whose_object_is_scaled",
    "spot": "check_a_spot",
    "sun": "check_a_sun",
}

COLUMNS = "Blender Python NumPy system package passed failed area point spot sun".split()
HEAD = f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}\n"


def main():
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    before, _, rest = TARGET.read_text().partition(BEGIN)
    TARGET.write_text(f"{before}{BEGIN}\n\n{table(RESULTS)}\n{END}{rest.partition(END)[2]}")
    print(TARGET)


def table(results):
    """Returns lines of Markdown about the whole sets of checks in a folder."""
    rows = []
    for about_file in sorted(results.glob("*/about.json")):
        about = json.loads(about_file.read_text())
        missing = [x for x in about["checks"] if not (about_file.parent / f"{x}.json").exists()]
        if missing:
            print(f"Left out: {about_file.parent.name}, without {', '.join(missing)}.")
        else:
            rows.append((about["version"], row(about, about_file.parent)))
    if not rows:
        sys.exit(f"{results}: holds no whole set of checks; run scripts/test blender -m '' first.")
    return HEAD + "".join(f"| {' | '.join(cells)} |\n" for _, cells in sorted(rows))


def row(about, folder):
    checks = {}
    for file in sorted(folder.glob("check_*.json")):
        checks |= json.loads(file.read_text())
    outcomes = [check["outcome"] for check in checks.values()]
    passed = outcomes.count("passed")
    program = "PyPI's module" if about["module"] else "program"
    return [
        f"{about['blender']} ({program})",
        about["python"],
        about["numpy"],
        about["system"],
        "extension" if about["version"] >= [4, 2] else "legacy zip",
        str(passed),
        str(len(outcomes) - passed),
        *(ratio(checks, name) for name in LAMPS.values()),
    ]


def ratio(checks, name):
    """Returns the ratio of Cycles to the bake for one kind of lamp."""
    found = [
        x
        for check, what in checks.items()
        if check.partition("::")[2].partition("[")[0] == name
        for x in what.get("cycles_over_bake", [])
    ]
    return f"{max(found, key=lambda x: abs(x - 1)):.4f}" if found else "-"
