# SPDX-License-Identifier: GPL-3.0-or-later
"""The bugs of validation/mutations fit the sources that they alter, and their tests exist."""

import re
import sys
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_each_bug_fits_one_place(monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    loader = SourceFileLoader("mutations", str(ROOT / "validation" / "mutations"))
    mutations = module_from_spec(spec_from_loader("mutations", loader))
    monkeypatch.setitem(sys.modules, "mutations", mutations)
    loader.exec_module(mutations)
    places = {
        mutation.name: (ROOT / "core" / mutation.file).read_text().count(mutation.right)
        for mutation in mutations.MUTATIONS
    }
    assert set(places.values()) == {1}, places


def test_the_tests_that_catch_them_exist():
    rows = re.findall(
        r"^\| .+ \| `src/.+` \| `(\w+)\.(\w+)` \|$",
        (ROOT / "tests" / "README.md").read_text(),
        re.MULTILINE,
    )
    sources = "".join(path.read_text() for path in (ROOT / "tests/core").glob("*.cpp"))
    absent = [row for row in rows if not re.search(rf"TEST(_\w)?\({row[0]}, {row[1]}\)", sources)]
    assert len(rows) > 10 and not absent
