# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads files in memory that holds one pattern, then another, and names those that differ.

The reader never wrote the values that differ (tests/python/poisoned.py). An archive .tar.gz is
unpacked, and the files and folders in it are read. cases.json beside the files may give options of
read_volume.

    [{"file": ..., "inner": within an archive, "options": {...}}, ...]
"""

import argparse
import json
import sys
import tarfile
import tempfile
from pathlib import Path

from poisoned import answers


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("paths", nargs="+", help="files, or folders of files")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        files = [
            each
            for number, path in enumerate(map(Path, options.paths))
            for each in files_of(path, Path(work, str(number)))
        ]
        first, second = answers(files)
    differ = 0
    for (path, _), one, two in zip(files, first, second):
        outcome = "read" if one.startswith("read ") else one.replace(str(path), "")
        if one != two:
            differ, outcome = differ + 1, "NOT WRITTEN"
        print(f"{path.name}: {outcome}", flush=True)
    read = sum(one.startswith("read ") for one in first)
    print(f"{len(files)} files, {read} read, {differ} with memory that was not written")
    sys.exit(1 if differ else 0)


def files_of(path, work):
    """Returns (file, options) of a file, or of each file in a folder; work: folder for archives."""
    if not path.is_dir():
        return [(path, {})]
    listed = path / "cases.json"
    cases = json.loads(listed.read_text()) if listed.exists() else []
    known = {case["file"]: case for case in cases}
    found = []
    for file in sorted(path.iterdir()):
        case = known.get(file.name, {"inner": None, "options": {}})
        if file.name.endswith(".tar.gz"):
            folder = work / file.name
            with tarfile.open(file) as archive:
                archive.extractall(folder)
            inner = [folder / case["inner"]] if case["inner"] else sorted(folder.iterdir())
            found += [(each, case["options"]) for each in inner]
        elif file.is_file() and file.suffix not in (".json", ".py", ".md"):
            found.append((file, case["options"]))
    return found
