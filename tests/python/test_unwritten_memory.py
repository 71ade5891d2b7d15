# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that no reader returns memory that it has not filled."""

import platform
import shutil
import sys
from pathlib import Path

import pytest
from leaflight.io.readers.reading import OPTIONS
from leaflight_command.parser import make_parser
from poisoned import PATTERNS, UNWRITTEN, answers

sys.path.append(str(Path(__file__).resolve().parents[1] / "fuzz"))

from targets import TARGETS, missing_library, seeds_of  # noqa: E402

# Targets of the fuzzer: at least one for each reader.
READ = [target for target in TARGETS if target.arguments[0] == "info"]

pytestmark = pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="the GNU C library fills what it allocates"
)


def test_what_is_read_is_the_same_whatever_the_memory_held(tmp_path):
    files, names = [(UNWRITTEN, {})], [UNWRITTEN]
    for target in READ:
        if missing_library(target):
            continue
        made = tmp_path / target.name
        for number, data in enumerate(seeds_of(target, made)):
            names.append(f"{target.name} {number}")
            # Copy the folder, because the file refers to others.
            path = shutil.copytree(made, tmp_path / names[-1]) / f"input{target.suffix}"
            (path / target.within).write_bytes(data)
            files.append((path, _options(target)))
    first, second = answers(files)
    # An unfilled array must show the patterns.
    assert [first.pop(0), second.pop(0)] == [[[hex(pattern)]] * 6 for pattern in PATTERNS]
    refused = [text for text in first if not text.startswith("read ")]
    assert [text for text in refused if "needs the Python package" not in text] == []
    assert [name for name, one, two in zip(names[1:], first, second) if one != two] == []


def _options(target):
    """Returns the options of read_volume() among the arguments of a target."""
    given = vars(make_parser().parse_args(target.arguments))
    return {name: given[name] for name in OPTIONS if given[name] is not None}
