# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench stage`: the clicks of a user in a window of Blender, from a file to a lit stage and back.

stage_scene.py runs in the window.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import driver
import nibabel
import numpy as np
from leaflight import LeaflightError
from leaflight.volume.volume import bump_box
from volume_recipes import COLIN27, absent_text
from written import table

from .page import measured_on

SCRIPT = Path(__file__).with_name("stage_scene.py")


@dataclass(frozen=True)
class Case:
    """A stage to bake.

    walls: True to light its walls, too; isovalue: in data units; quality: its identifier.
    """

    name: str
    path: Path
    stage: str
    walls: bool
    isovalue: float
    quality: str = "GOOD"


CASES = (
    Case("Colin27, Studio, lit walls", COLIN27, "STUDIO", True, 45.5),
    Case("Colin27, Cornell box", COLIN27, "CORNELL", False, 45.5),
)


def stage_section(options):
    """Returns lines of Markdown. Raises LeaflightError without a Blender that has windows."""
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        folder = Path(folder)
        blender = driver.with_addon(folder / "blender")
        if blender.no_window():
            raise LeaflightError(f"bench stage: {blender.no_window()}")
        cases = (small_case(folder),) if options.quick else CASES
        present = [case for case in cases if case.path.exists()]
        absent = [case.name for case in cases if not case.path.exists()]
        rows = []
        for case in present:
            if options.only in case.name:
                rows += measured(blender, case, folder)
    return [
        "## On a stage",
        "",
        measured_on(),
        "",
        f"- Seconds in a window of Blender {blender.about['blender']}, and processor seconds of "
        "Blender meanwhile. Each step begins with the click and ends when its result is in the "
        "scene. There is no graphics card, so the window draws boxes in place of surfaces, "
        "without light and without smooth edges.",
        "- The last pass of a bake is shown before its files are written.",
        "- The isovalue steps ten times, and the row has the median: *at rest* with all detail, "
        "*while it moves* as under the mouse, both before drawing.",
        "- With *Live* on, the lamp and then the clip box of a cut are moved once.",
        *absent_text(absent),
        "",
        *table(rows),
    ]


def small_case(folder):
    path = folder / "bumps.nii.gz"
    image = nibabel.Nifti1Image(bump_box(24).values.T.astype(np.float32), np.eye(4))
    nibabel.save(image, path)
    return Case("bump box, 24^3", path, "STUDIO", True, 47.0, "DRAFT")


def measured(blender, case, folder):
    """Returns a row for each step of a case."""
    arguments = case.path, case.stage, int(case.walls), case.isovalue, case.quality
    found = blender.in_window(SCRIPT, *arguments, folder / "bakes", by_hand=False)
    return [
        {
            "case": case.name,
            "step": name,
            "seconds": f"{seconds:.2f}",
            "processor seconds": f"{processor:.2f}",
        }
        for name, seconds, processor in found["steps"]
    ]
