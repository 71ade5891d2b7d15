# SPDX-License-Identifier: GPL-3.0-or-later
"""The bugs of validation/mutations fit the sources that they alter."""

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
