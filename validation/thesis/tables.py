# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the thesis's tables on sampling, computed again, with a verdict for each row."""

import io
import os

import numpy as np
from written import parse_arguments, prepare, table, write

from .experiments import QUICK, Effort, table_3_1, table_4_2, table_4_9
from .pictures import side_by_side

TABLES = (table_3_1, table_4_2, table_4_9)
COLUMNS = ("strategy", "samples", "rays", "filter", "ours", "printed", "seconds", "verdict")
# Approximate size in pixels of each picture in a row.
BESIDE = 300
TABLES_SAY = (
    "Errors are RMS in percent (thesis Eq. 4.11, corrected) and the same in every run. "
    "Seconds are those of each bake by the clock. Uniform, stratified, regular and importance "
    "samples must not exceed the error that the thesis prints for uniform ones. Nor must samples "
    "in each texel, which the thesis does not have. Strategies that leave gaps must err at least "
    "three times as much as our uniform samples. Percent are of a displayed color of 1, so that "
    "they grow with a scene's brightness. The thesis does not state its brightness."
)


def main():
    """Returns 1 if an error fails its verdict."""
    options = parse_arguments(__doc__, has_data=False)
    prepare(options.out, "tables.md")
    effort = QUICK if options.quick else Effort()
    done = [compute(effort) for compute in TABLES]
    lines = [
        "# The thesis's tables",
        "",
        f"Written by `validation/run tables{' --quick' * options.quick}` on {os.cpu_count()} "
        f"cores. {TABLES_SAY}",
        *(line for made in done for line in _text(made)),
    ]
    files = {name: content for made in done for name, content in _files(made).items()}
    write(options.out, {**files, "tables.md": "\n".join(lines) + "\n"})
    print("\n".join(lines))
    return int(any(row.passed is False for made in done for row in made.rows))


def _cells(row):
    """Returns the texts of a row, by COLUMNS and further errors."""
    trial, scattered = row.trial, row.trial.scattered
    cells = (
        trial.name,
        trial.samples if scattered else None,
        trial.rays,
        f"{scattered.filter} {scattered.radius}" if scattered else None,
        row.error,
        trial.printed,
        row.seconds,
        row.verdict,
    )
    found = {**dict(zip(COLUMNS, cells, strict=True)), **row.others}
    return {name: _printed(name, cell) for name, cell in found.items()}


def _files(made):
    """Returns pictures by their names."""
    files = {}
    for kind, pictures in made.pictures.items():
        reduction = max(1, round(max(map(np.shape, pictures.values()))[1] / BESIDE))
        row = side_by_side(list(pictures.values()), reduction)
        files[f"images/{made.name}_{kind}.png"] = _small_png(row)
    return files


def _small_png(picture):
    """Returns the bytes of a PNG file with 128 colors, which are enough for a document."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(picture).quantize(128).save(file, "PNG", optimize=True)
    return file.getvalue()


def _text(made):
    lines = ["", f"## {made.title}", "", *table([_cells(row) for row in made.rows])]
    lines += ["", *(f"- {note}" for note in made.notes)]
    for kind, pictures in made.pictures.items():
        names = ", ".join(pictures)
        lines += ["", f"![{names}](images/{made.name}_{kind}.png)", ""]
        lines += [f"*{kind.capitalize()}: {names}.*"]
    return lines


def _printed(name, cell):
    if cell is None:
        return ""
    number = "{:.2f}" if isinstance(cell, float) else "{}"
    formats = {"samples": "{:,}", "printed": "{:g}", "seconds": "{:.1f}"}
    return formats.get(name, number).format(cell)
