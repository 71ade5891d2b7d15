# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes documents of measurements, their tables and pictures."""

import argparse
from pathlib import Path

import numpy as np
from leaflight.io.images import write_png
from leaflight.io.output import check_writable, replaced


def parse_arguments(description, has_data=True):
    """Returns the options quick, out and data of a program that writes a document."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="less of everything")
    parser.add_argument(
        "--out", type=Path, default=Path("report"), metavar="DIR", help="folder (report)"
    )
    if has_data:
        parser.add_argument("--data", type=Path, metavar="DIR", help="folder of real data sets")
    return parser.parse_args()


def prepare(folder, name):
    """Makes the folder and its folder for images; checks that the named file can be written."""
    (folder / "images").mkdir(parents=True, exist_ok=True)
    check_writable(folder / name, ".md")


def write(folder, files):
    """Writes files, each completely or not at all. files: text, bytes or pictures by name."""
    for name, content in files.items():
        if isinstance(content, np.ndarray):
            write_png(folder / name, content)
            continue
        with replaced(folder / name) as temporary:
            temporary.write_bytes(content if isinstance(content, bytes) else content.encode())


def table(rows):
    """Returns the lines of a Markdown table. rows: Dicts of texts, or None, by the column."""
    if not rows:
        return []
    lines = [
        "| " + " | ".join("" if cell is None else cell for cell in row) + " |"
        for row in (rows[0], *(row.values() for row in rows))
    ]
    return [lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]
