# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests every operator of the add-on in a window, as a user presses it (window/rows.py).

Each is pressed four times: normally, cancelled halfway, with its object deleted meanwhile, and with
a new file opened meanwhile. Background work also runs while the previous step is undone, and while
its window is closed. The part `window` of scripts/test writes to build/test/window.md how long the
window was frozen. It needs a Blender with a window and xvfb-run.
"""

import json
import re
from pathlib import Path

import leaflight
import nibabel
import numpy as np
import pytest
from rows import BESIDE, HAPPY, ROWS, UNPRESSED, WAYS

BLOCKED = Path(__file__).resolve().parents[2] / "build" / "test" / "window.md"

EVERY = [(number, way) for number, row in enumerate(ROWS) for way in row.ways]
SHORT = [(number, way) for number, way in EVERY if way == HAPPY and ROWS[number].short]
assert len(SHORT) == 12

# Pattern of errors that Python and Blender write to the console.
WRONG = re.compile(r"Traceback \(most recent|WARN \(bpy|rna_uiItemR|unknown operator|: not found:")
# Seconds for which a frozen window goes unnoticed.
UNNOTICED = 0.5


def _params(presses):
    return [pytest.param(press, id=f"{ROWS[press[0]].name}, {press[1]}") for press in presses]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Writes small files to import: patients, parts, a series, labels and an image."""
    folder = tmp_path_factory.mktemp("files")
    head = leaflight.bump_box(24).values.T
    other = head[::-1]
    parts = head.copy()
    parts[6:8] = 0
    (folder / "names.txt").write_text('1 255 0 0 1 1 1 "Outside"\n2 0 0 255 1 1 1 "Inside"\n')
    for name, values in (
        ("head", head),
        ("other", other),
        ("parts", parts),
        ("beating", np.stack([head, other], axis=-1)),
        ("regions", np.digitize(head, (40.0, 70.0))),
    ):
        image = nibabel.Nifti1Image(values.astype(np.float32), np.diag([2.0, 2.0, 2.0, 1.0]))
        image.header.set_xyzt_units("mm")
        image.set_qform(image.affine, 1)
        nibabel.save(image, folder / f"{name}.nii.gz")
    return folder


def press(blender, folder, presses):
    """Returns {press: result} and all operators, from as many Blenders as needed.

    A result has the failures and Blender's output. A Blender ends after a failed press.
    """
    results, operators, left = {}, [], list(presses)
    while left:
        _, said = blender.show("press_operators.py", folder, json.dumps(left), size=(900, 640))
        before = len(results)
        for part in said.split("\nROW ")[1:]:
            number, way = part.splitlines()[0].split(" ", 1)
            words, _, after = part.partition("\nPRESSED ")
            ended = after.splitlines()[0] if after else '{"failures": ["Blender crashed"]}'
            result = json.loads(ended)
            result["failures"] += [words] if WRONG.search(words) else []
            results[int(number), way] = {"seconds": 0.0, "where": "", **result, "said": words}
        assert len(results) > before, said
        line = next(line for line in said.splitlines() if line.startswith("OPERATORS "))
        operators = json.loads(line.removeprefix("OPERATORS "))
        left = [press for press in presses if press not in results]
    return results, operators


@pytest.fixture(scope="module")
def short(blender, files):
    return press(blender, files, SHORT)[0]


@pytest.fixture(scope="module")
def pressed(blender, files):
    results, operators = press(blender, files, EVERY)
    BLOCKED.parent.mkdir(parents=True, exist_ok=True)
    BLOCKED.write_text(table(results, blender.about["blender"]))
    return results, operators


@pytest.mark.parametrize("which", _params(SHORT))
def test_the_main_way(short, which):
    assert not short[which]["failures"], short[which]


@pytest.mark.slow
def test_each_operator_has_a_row(pressed):
    names = {row.operator for row in ROWS} | set(UNPRESSED)
    assert {f"leaflight.{name}" for name in names} == set(pressed[1])


def test_each_way_is_pressed_or_has_a_reason():
    for row in ROWS:
        assert set(row.without) <= set(WAYS) and all(row.without.values())
        assert row.held or set(row.ways) <= {HAPPY, BESIDE}, row


@pytest.mark.slow
@pytest.mark.parametrize("which", _params(EVERY))
def test_pressed(pressed, which):
    result = pressed[0][which]
    assert not result["failures"], result


def table(results, version):
    """Returns a page with the longest time that the window was frozen for each press."""
    lines = [
        f"# How long Blender {version}'s window stood still",
        "",
        "The longest time between two steps of Blender, and what Leaflight was at work on then.",
        f"Above {UNNOTICED:g} s it is bold. In the shading Solid, without a graphics card, of",
        "small volumes.",
        "",
        "| operator | way | seconds | in |",
        "|---|---|---|---|",
    ]
    for (number, way), result in sorted(results.items(), key=lambda r: -r[1]["seconds"]):
        seconds = f"{result['seconds']:.2f}"
        mark = "**" if result["seconds"] > UNNOTICED else ""
        name = ROWS[number].name
        lines.append(f"| {name} | {way} | {mark}{seconds}{mark} | {result['where']} |")
    return "\n".join(lines) + "\n"
