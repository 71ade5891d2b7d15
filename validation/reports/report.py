# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: figures, plots and the thesis's tables beside ours, as Markdown, CSV and PNG."""

import csv
import io
import os
import re
import shutil
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np

from leaflight._core import LeaflightError
from leaflight.io.images import write_png
from leaflight.io.output import check_writable, replaced
from leaflight.measure.cycles import find_blender
from . import cycles_section, sections
from .advice import advice
from .against_cycles import QUICK_CYCLES, CyclesEffort, measure_against_cycles
from .curves import QUICK_CURVES, CurveEffort, measure_curves
from .data_sets import QUICK_DATA, DataEffort, measure_data_sets
from .experiments import QUICK, Effort, table_3_1, table_4_2, table_4_9
from .fits import check_statistics
from .pictures import side_by_side
from .plots import break_even, check_plotting, convergence, error_against_seconds

TABLES = (table_3_1, table_4_2, table_4_9)
COLUMNS = ("strategy", "samples", "rays", "filter", "ours", "printed", "seconds", "verdict")
# Pixels, about, of each picture among those side by side.
BESIDE = 300
TABLES_SAY = (
    "Errors are RMS in percent (thesis Eq. 4.11, corrected) and the same in every run; "
    "seconds are those of each bake by the clock. Uniform, stratified, regular and importance "
    "samples must not exceed the error that the thesis prints for uniform ones, whatever their "
    "filter; nor must samples in each texel, which the thesis does not have. Strategies that leave "
    "gaps must err at least three times as much as our uniform samples. Percent are of a displayed "
    "colour of 1, so that they grow with a scene's brightness; the thesis's is not known."
)


@dataclass(frozen=True)
class ReportEffort:
    """How much work the report takes; its seed and threads are those of the tables."""

    tables: Effort = Effort()
    curves: CurveEffort = CurveEffort()
    data: DataEffort = DataEffort()
    cycles: CyclesEffort = CyclesEffort()


# Less work than `--tables --quick` alone, so that the whole report takes ten minutes.
QUICK_TABLES = replace(
    QUICK,
    flat_reference_samples=2_560_000,
    vertices=1000,
    picture_paths=64,
)
QUICK_REPORT = ReportEffort(QUICK_TABLES, QUICK_CURVES, QUICK_DATA, QUICK_CYCLES)


def report(folder, effort, run, data=None, tables=TABLES):
    """Measures everything; writes folder/report.md, folder/images/*.png and folder/csv/*.csv.

    effort: a ReportEffort
    run(work, label): see experiments.py
    data: the folder of the real data sets, or None

    Returns a dict: "out", "seed", "passed" (no row of the tables failed, and no row against Cycles
    is exceeded), and "rows" as in report_tables. "curves", "slopes", "break_even", "data_sets",
    "bakes_against_cycles", "against_cycles" and "memory" are lists of dicts.
    Raises LeaflightError, Cancelled, and then writes nothing.
    """
    folder = _prepared(folder, "report.md")
    check_plotting()
    check_statistics()
    seed, threads = effort.tables.seed, effort.tables.threads
    work = {"seed": seed, "threads": threads}
    has_cycles = shutil.which("blender") is not None
    curves = measure_curves(effort.curves, run, cycles=has_cycles, **work)
    rows, absent = measure_data_sets(effort.data, run, folder=data, **work)
    judged, unjudged = [], []
    if has_cycles:
        judged, unjudged = measure_against_cycles(effort.cycles, run, folder=data, **work)
    done = [table(effort.tables, run) for table in tables]

    analysis = sections.analysed(curves, seed)
    parts = {
        "Error against seconds": sections.curves_text(curves),
        "Convergence": sections.slopes_text(curves, analysis),
        "One bake against Cycles": sections.break_even_text(curves, analysis),
        "Against Cycles": (
            cycles_section.cycles_text(judged, unjudged, effort.cycles)
            if has_cycles
            else [sections.NO_BLENDER]
        ),
        "The thesis's data sets (Fig. 5.14)": sections.data_text(rows, absent, effort.data),
        "Memory": sections.memory_text(curves, rows),
    }
    text = _page(effort, parts, advice(curves, analysis, rows), done)
    found = {
        "curves": sections.curve_rows(curves),
        "slopes": _split(sections.slope_rows(curves, analysis)),
        "break_even": _split(analysis.break_even),
        "data_sets": sections.data_rows(rows),
        **_against_cycles(judged),
        "memory": sections.memory_rows(curves, rows),
    }
    files = {
        "images/curves.png": error_against_seconds(curves),
        "images/convergence.png": convergence(curves, analysis.errors),
        **{f"csv/{name}.csv": _csv(rows) for name, rows in found.items() if rows},
        **_table_files(done, seed, each=False),
        "report.md": text,
    }
    if analysis.break_even:
        picture = break_even(analysis.break_even, sections.THESIS_BREAK_EVEN)
        files["images/break_even.png"] = picture
    _write(folder, files)
    return {**_result(folder, seed, done, judged), **_finite(found)}


def _page(effort, parts, choices, tables):
    """Returns the text of the report. parts: lines by their title; choices: of advice()."""
    lines = [
        "# Report",
        "",
        f"Written by `validation/report` with seed {effort.tables.seed} on "
        f"{os.cpu_count()} cores, from nothing but the program, the data and the seed: errors come "
        "out the same in every run, seconds do not.",
        *_reductions(effort),
        "",
        "## What to choose when",
        "",
        *choices,
    ]
    for title, part in parts.items():
        lines += ["", f"## {title}", "", *part]
    lines += ["", "## The thesis's tables", "", TABLES_SAY, *_tables_text(tables, "###")]
    return "\n".join(lines) + "\n"


def report_tables(folder, effort, run, tables=TABLES):
    """Computes tables and writes folder/tables.md, folder/images/*.png, folder/csv/*.csv.

    effort: an Effort; run(work, label): see experiments.py. Returns a dict: "out", "seed",
    "passed" (no row failed) and "rows", a list of dicts with "table", "passed" and the COLUMNS.
    Raises LeaflightError, Cancelled, and then writes nothing.
    """
    folder = _prepared(folder, "tables.md")
    done = [table(effort, run) for table in tables]
    lines = [
        "# The thesis's tables, computed anew",
        "",
        f"Written by `validation/report --tables` with seed {effort.seed} on "
        f"{os.cpu_count()} cores. {TABLES_SAY}",
        *_tables_text(done, "##"),
    ]
    files = {**_table_files(done, effort.seed, each=True), "tables.md": "\n".join(lines) + "\n"}
    _write(folder, files)
    return _result(folder, effort.seed, done)


def report_cycles(folder, effort, run, data=None, *, seed=0, threads=0):
    """Measures bakes against Cycles; writes folder/cycles.md and folder/csv/cycles_*.csv.

    effort: a CyclesEffort; run, data: see report(). Returns a dict: "out", "seed", "passed" (none
    is exceeded), "rows" (none), "bakes_against_cycles" and "against_cycles", lists of dicts. Raises
    LeaflightError, Cancelled, and then writes nothing.
    """
    find_blender()
    folder = _prepared(folder, "cycles.md")
    work = {"seed": seed, "threads": threads}
    judged, absent = measure_against_cycles(effort, run, folder=data, **work)
    lines = [
        "# Against Cycles",
        "",
        f"Written by `validation/report --cycles` with seed {seed} on {os.cpu_count()} cores.",
        "",
        *cycles_section.cycles_text(judged, absent, effort),
    ]
    found = _against_cycles(judged)
    names = {"bakes_against_cycles": "cycles_bakes", "against_cycles": "cycles_isosurfaces"}
    files = {f"csv/{names[name]}.csv": _csv(rows) for name, rows in found.items()}
    _write(folder, {**files, "cycles.md": "\n".join(lines) + "\n"})
    return {**_result(folder, seed, judged=judged), **_finite(found)}


def _against_cycles(judged):
    """Tables of CyclesRows, by name."""
    return {
        "bakes_against_cycles": cycles_section.bake_rows(judged),
        "against_cycles": cycles_section.cycles_rows(judged),
    }


def _prepared(folder, name):
    """Makes the folder and those for images and figures; checks that it can hold the named file."""
    folder = Path(folder)
    try:
        for part in ("images", "csv"):
            (folder / part).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(
            f"{folder}: cannot make this folder: {error.strerror}; choose another (--out)."
        ) from None
    check_writable(folder / name, ".md")
    return folder


def _result(folder, seed, tables=(), judged=()):
    """judged: CyclesRows."""
    rows = [
        {"table": table.name, "passed": row.passed, **_cells(row)}
        for table in tables
        for row in table.rows
    ]
    passed = all([row["passed"] is not False for row in rows] + [row.passed for row in judged])
    return {"out": str(folder), "seed": seed, "passed": passed, "rows": rows}


def _reductions(effort):
    """Returns a paragraph on the efforts below those of the full report, if there are any."""
    full, parts = ReportEffort(), []
    titles = {"data": "data sets", "cycles": "against Cycles"}
    for name in (field.name for field in fields(effort)):
        own, other = getattr(effort, name), getattr(full, name)
        less = [
            f"{field.name} {_short(getattr(own, field.name))} instead of "
            f"{_short(getattr(other, field.name))}"
            for field in fields(own)
            if field.name not in ("seed", "threads")
            and getattr(own, field.name) != getattr(other, field.name)
        ]
        if less:
            parts.append(f"{titles.get(name, name)}: {', '.join(less)}")
    return ["", f"Reduced (`--quick`): {'; '.join(parts)}."] if parts else []


def _short(value):
    if isinstance(value, tuple):
        return f"({', '.join(map(_short, value))})"
    if hasattr(value, "name"):
        return value.name
    return f"{value:,}" if isinstance(value, int) else f"{value:g}"


def _split(rows):
    """Returns rows with three cells for each Estimate: value, low and high."""
    return [
        {
            key: cell
            for name, value in row.items()
            for key, cell in (
                ((name, value.value), (f"{name}, low", value.low), (f"{name}, high", value.high))
                if hasattr(value, "low")
                else ((name, value),)
            )
        }
        for row in rows
    ]


def _finite(found):
    """Returns rows that JSON can hold: infinite and unknown numbers are None."""
    return {
        name: [
            {
                key: None if isinstance(cell, float) and not np.isfinite(cell) else cell
                for key, cell in row.items()
            }
            for row in rows
        ]
        for name, rows in found.items()
    }


def _cells(row):
    """Returns the COLUMNS of a row; absent ones are None."""
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


def _table_files(tables, seed, each):
    """Pictures and figures by their names; each: every picture on its own, too."""
    files = {}
    for table in tables:
        rows = [
            {**_cells(row), "passed": row.passed, "seed": seed + row.trial.repetition}
            for row in table.rows
        ]
        files[f"csv/{table.name}.csv"] = _csv(rows)
        for kind, pictures in table.pictures.items():
            if each:
                for name, picture in pictures.items():
                    files[f"images/{table.name}_{kind}_{_file_name(name)}.png"] = picture
            reduction = max(1, round(max(map(np.shape, pictures.values()))[1] / BESIDE))
            row = side_by_side(list(pictures.values()), reduction)
            files[f"images/{table.name}_{kind}.png"] = row if each else _small_png(row)
    return files


def _small_png(picture):
    """Returns the bytes of a PNG file with 128 colors: a document does not need more."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(picture).quantize(128).save(file, "PNG", optimize=True)
    return file.getvalue()


def _csv(rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _tables_text(tables, heading):
    lines = []
    for table in tables:
        lines += ["", f"{heading} {table.title}", ""]
        lines += [_line(_columns(table)), "|" + "---|" * len(_columns(table))]
        for row in table.rows:
            lines += [_line(_printed(name, cell) for name, cell in _cells(row).items())]
        lines += ["", *(f"- {note}" for note in table.notes)]
        for kind, pictures in table.pictures.items():
            names = ", ".join(pictures)
            lines += ["", f"![{names}](images/{table.name}_{kind}.png)", ""]
            lines += [f"*{kind.capitalize()}: {names}.*"]
    return lines


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


def _write(folder, files):
    """files: by name in the folder, text, bytes or pictures; each is written whole or not."""
    for name, content in files.items():
        if isinstance(content, np.ndarray):
            write_png(folder / name, content)
            continue
        with replaced(folder / name) as temporary:
            temporary.write_bytes(content if isinstance(content, bytes) else content.encode())
