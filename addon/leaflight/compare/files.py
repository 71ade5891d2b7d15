# SPDX-License-Identifier: GPL-3.0-or-later
"""What a comparison leaves in a folder."""

import csv
import json
from pathlib import Path

import leaflight._core as _core
import numpy as np
from leaflight.io.output import replaced

from . import render, sheet

# In the PNG of the difference, which would be all black otherwise. The EXR holds it signed and as
# it is.
_DIFFERENCE_GAIN = 5.0

_STILLS = ("baked", "cycles", "local", "difference")


def write(scene, folder, name, result):
    """Writes the result of stills.compare(): STEM_{baked,cycles,local,difference}.{exr,png},
    STEM_comparison.{png,csv,json}.

    The .csv has a row for each still, the .json all numbers. Returns the path of the .json.
    """
    stem = str(Path(folder) / f"{name}_{result['isovalue']:g}".replace("/", "_"))
    for still in _STILLS:
        image = np.ascontiguousarray(result[still])
        _core.write_exr(f"{stem}_{still}.exr", image)
        shown = _DIFFERENCE_GAIN * np.abs(image) if still == "difference" else image
        render.write_png(scene, f"{stem}_{still}.png", shown)
    sheet.write_sheet(f"{stem}_comparison.png", name, result)
    numbers = {key: value for key, value in result.items() if not isinstance(value, np.ndarray)}
    numbers = {"name": name, **numbers}
    _write_table(f"{stem}_comparison.csv", numbers)
    path = Path(f"{stem}_comparison.json")
    with replaced(path) as temporary:
        temporary.write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    return path


def _write_table(path, numbers):
    rows = [
        ("baked", "baked_seconds", "isosurface_rms_percent"),
        ("local", "local_seconds", "local_rms_percent"),
        ("cycles", "cycles_seconds", None),
    ]
    with replaced(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["name", "isovalue", "still", "render_seconds", "rms_percent_on_isosurface"])
        for still, seconds, rms in rows:
            error = "" if rms is None else f"{numbers[rms]:.4f}"
            isovalue = f"{numbers['isovalue']:g}"
            table.writerow([numbers["name"], isovalue, still, f"{numbers[seconds]:.3f}", error])
