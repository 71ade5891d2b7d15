# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: the thesis's tables beside ours, as Markdown, CSV and pictures."""

import csv
import io
import os
import re
from pathlib import Path

import numpy as np

from ._core import LeaflightError
from .experiments import table_3_1, table_4_2, table_4_9
from .images import write_png
from .output import check_writable, replaced
from .pictures import side_by_side

TABLES = (table_3_1, table_4_2, table_4_9)
COLUMNS = ("strategy", "samples", "rays", "filter", "ours", "printed", "seconds", "verdict")
# Pixels, about, of each picture among those side by side.
BESIDE = 300


def report_tables(folder, effort, run, tables=TABLES):
    """Computes tables and writes folder/tables.md, a .csv each and folder/images/*.png.

    effort: an Effort; run(work, label): see experiments.py. Returns a dict: "out", "seed",
    "passed" (no row failed) and "rows", a list of dicts with "table", "passed" and the COLUMNS.
    Raises LeaflightError, Cancelled, and then writes nothing.
    """
    folder = Path(folder)
    images = folder / "images"
    try:
        images.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(
            f"{folder}: cannot make this folder: {error.strerror}; choose another (--out)."
        ) from None
    check_writable(folder / "tables.md", ".md")
    done = [table(effort, run) for table in tables]
    for table in done:
        _write(folder / f"{table.name}.csv", _csv(table, effort.seed))
        for kind, pictures in table.pictures.items():
            for name, picture in pictures.items():
                write_png(images / f"{table.name}_{kind}_{_file_name(name)}.png", picture)
            reduction = max(1, round(max(map(np.shape, pictures.values()))[1] / BESIDE))
            row = side_by_side(list(pictures.values()), reduction)
            write_png(images / f"{table.name}_{kind}.png", row)
    _write(folder / "tables.md", _markdown(done, effort.seed))
    rows = [
        {"table": table.name, "passed": row.passed, **_cells(row)}
        for table in done
        for row in table.rows
    ]
    passed = all(row["passed"] is not False for row in rows)
    return {"out": str(folder), "seed": effort.seed, "passed": passed, "rows": rows}


def _cells(row):
    """The COLUMNS of a row; what it has not is None."""
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
    return {**dict(zip(COLUMNS, cells, strict=True)), **row.others}


def _columns(table):
    return [*COLUMNS, *table.rows[0].others]


def _csv(table, seed):
    text = io.StringIO()
    writer = csv.DictWriter(text, [*_columns(table), "passed", "seed"], lineterminator="\n")
    writer.writeheader()
    for row in table.rows:
        own = seed + row.trial.repetition
        writer.writerow({**_cells(row), "passed": row.passed, "seed": own})
    return text.getvalue()


def _markdown(tables, seed):
    lines = [
        "# The thesis's tables, computed anew",
        "",
        f"Written by `scripts/leaflight report --tables` with seed {seed} on {os.cpu_count()} "
        "cores. Errors are RMS in percent (thesis Eq. 4.11, corrected) and the same in every run; "
        "seconds are those of each bake. Uniform, stratified, regular and importance samples must "
        "not exceed the error that the thesis prints for uniform ones, whatever their filter; nor "
        "must samples in each texel, which the thesis does not have. Strategies that leave gaps "
        "must err at least three times as much as our uniform samples. Percent are of a displayed "
        "colour of 1, so that they grow with a scene's brightness; the thesis's is not known.",
    ]
    for table in tables:
        lines += ["", f"## {table.title}", ""]
        lines += [_line(_columns(table)), "|" + "---|" * len(_columns(table))]
        for row in table.rows:
            lines += [_line(_printed(name, cell) for name, cell in _cells(row).items())]
        lines += ["", *(f"- {note}" for note in table.notes)]
        for kind, pictures in table.pictures.items():
            names = ", ".join(pictures)
            lines += ["", f"![{names}](images/{table.name}_{kind}.png)", ""]
            lines += [f"*{kind.capitalize()}: {names}.*"]
    return "\n".join(lines) + "\n"


def _printed(name, cell):
    if cell is None:
        return ""
    number = "{:.2f}" if isinstance(cell, float) else "{}"
    formats = {"samples": "{:,}", "printed": "{:g}", "seconds": "{:.1f}"}
    return formats.get(name, number).format(cell)


def _line(cells):
    return "| " + " | ".join(cells) + " |"


def _file_name(name):
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def _write(path, text):
    with replaced(path) as temporary:
        temporary.write_text(text)
