# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of labels in files of their own: names and colors by number.

3D Slicer writes .ctbl, FreeSurfer a ColorLUT, ITK-SNAP a label description, BIDS a _dseg.tsv.
"""

import re
from pathlib import Path

from ..._core import LeaflightError
from ...arrays import Array
from ...paths import AnyPath
from ...volume.label_table import Label, label_numbers
from ...volume.setting_error import SettingError

# Upper bound on the bytes of a table.
_MOST = 1 << 24
_NUMBER = r"(\d{1,9})"
# Number, name, red, green, blue and opacity, as FreeSurfer and 3D Slicer write them.
_NAME_FIRST = re.compile(_NUMBER + r'\s+"?(.*?)"?' + 3 * (r"\s+" + _NUMBER) + r"(?:\s+\d+)?")
# Number, red, green, blue, opacity, two flags and the name, as ITK-SNAP writes them.
_COLOR_FIRST = re.compile(_NUMBER + 3 * (r"\s+" + _NUMBER) + r"\s+[\d.]+\s+[01]\s+[01]\s+\"(.*)\"")
# Folders of a file in which BIDS has its table: of the image, the session, the subject, all.
_ABOVE = 4
# Suffixes of tables, by which they are found.
_SUFFIXES = (".ctbl", ".tsv", ".txt")


def read_label_table(path: AnyPath) -> tuple[Label, ...]:
    """Returns the labels above 0 of a table. Raises LeaflightError."""
    path = Path(path)
    try:
        with open(path, "rb") as file:
            content = file.read(_MOST).decode("utf-8-sig", "replace")
    except OSError as error:
        raise SettingError(
            f"{path}: cannot read the label table: {error.strerror}.", "label_table"
        ) from None
    lines = content.splitlines()
    found = _of_bids(path, lines) if path.suffix.lower() == ".tsv" else _of_lines(path, lines)
    if not found:
        raise SettingError(
            f"{path}: the label table has no labels; give one of 3D Slicer, FreeSurfer, ITK-SNAP "
            "or BIDS.",
            "label_table",
        )
    return tuple(label for label in found if label.number > 0)


def labels_for(
    path: Path, values: Array, table: AnyPath | None
) -> tuple[tuple[Label, ...], tuple[str, ...]]:
    """Returns (labels of the file `path` by a table, notes about it).

    table: None takes the file of that name beside it, if there is one. Raises LeaflightError.
    """
    if table is not None:
        return matching_table(path.name, values, table), ()
    beside = _beside(path)
    if beside is None:
        return (), ()
    try:
        return matching_table(path.name, values, beside), ()
    except LeaflightError as error:
        # Other programs write notes as text files.
        return (), () if beside.suffix == ".txt" else (f"{error}",)


def matching_table(name: str, values: Array, table: AnyPath) -> tuple[Label, ...]:
    """Returns the labels of a table that has some of those in a label map. Raises LeaflightError.

    name: The path of the label map, for the error.
    """
    labels = read_label_table(table)
    if not {label.number for label in labels}.intersection(label_numbers(values)):
        raise SettingError(
            f"{table}: the label table has none of the labels in {name}: give the table of "
            "this file.",
            "label_table",
        )
    return labels


def _beside(path: Path) -> Path | None:
    """Returns the label table with the name of a file, in the same folder, or None.

    By BIDS a table in a folder above may lack parts of the name, such as the subject.
    """
    name = path.name.removesuffix(".gz")
    stem = name.rpartition(".")[0]
    found = [path.parent / f"{each}{suffix}" for each in (stem, name) for suffix in _SUFFIXES]
    if stem.endswith("_dseg"):
        parts = set(stem.split("_"))
        above = (table for folder in path.parents[:_ABOVE] for table in folder.glob("*dseg.tsv"))
        found += [table for table in above if parts.issuperset(table.stem.split("_"))]
    return next((table for table in found if table != path and table.is_file()), None)


def _of_lines(path: Path, lines: list[str]) -> list[Label]:
    found = []
    for number, line in enumerate(lines, 1):
        # Single spaces keep the patterns from trying many divisions.
        line = " ".join(line.split())
        if not line or line.startswith("#"):
            continue
        name_first, color_first = (each.fullmatch(line) for each in (_NAME_FIRST, _COLOR_FIRST))
        if color_first:
            key, *color, name = color_first.groups()
        elif name_first:
            key, name, *color = name_first.groups()
        else:
            raise _damaged(path, number, "a number, a name and a color")
        # 3D Slicer writes spaces as underscores.
        name = name.replace("_", " ") if path.suffix.lower() == ".ctbl" else name
        found.append(Label.of(int(key), name.strip(), [int(part) / 255.0 for part in color]))
    return found


def _of_bids(path: Path, lines: list[str]) -> list[Label]:
    """Returns the labels of a BIDS table. Its column of colors may be absent."""
    names = lines[0].split("\t") if lines else []
    found = []
    for number, line in enumerate(lines[1:], 2):
        row = {name.strip(): word.strip() for name, word in zip(names, line.split("\t"))}
        key = re.fullmatch(_NUMBER, row.get("index", ""))
        if key is None or "name" not in row:
            raise _damaged(path, number, "a number and a name under index and name")
        color = re.fullmatch(r"#?([0-9a-fA-F]{6})", row.get("color", ""))
        parts = [byte / 255.0 for byte in bytes.fromhex(color[1])] if color else None
        found.append(Label.of(int(key[0]), row["name"], parts))
    return found


def _damaged(path: Path, line: int, what: str) -> LeaflightError:
    return SettingError(
        f"{path}: line {line} of the label table is not {what}: repair it.", "label_table"
    )
