# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests files without a known suffix, whose contents show their format."""

import gzip
from fnmatch import fnmatchcase

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import SUFFIXES, format_of, name_patterns, sniffing
from leaflight.io.readers.formats import FORMATS
from leaflight.io.readers.sniffing import module_of
from outcomes import refused, written
from test_damaged_files import FORMATS as FILES
from test_reader_crystals import mtz

# Reader of each file of test_damaged_files.py by its contents.
MODULES = {
    "x.mha": "metaimage",
    "x.dcm": "dicom",
    "x.mrc": "mrc",
    "x.vti": "vti",
    "x.cube": "cube",
    "x.npy": "numpy_file",
    "x.npz": "numpy_file",
    "x.h5": "hdf5",
    "x.nii": "nifti",
    "x.nii.gz": "nifti",
    "x.nrrd": "nrrd",
    "plain.tif": "tiff",
    "x.vtk": "vtk_legacy",
    "x.dx": "opendx",
    "LOCPOT": "vasp",
    "x.xsf": "xsf",
    "x.brix": "dsn6",
    "x.mtz": "mtz",
}


def good(path):
    """Returns the bytes of the small file of this name."""
    if path.name != "x.mtz":
        return FILES[path.name](path)
    pytest.importorskip("gemmi")
    mtz(path, [("FWT", "F", [30.0, 20, 10]), ("PHWT", "P", [10.0, 100, -50])])
    return path.read_bytes()


@pytest.mark.parametrize("name", MODULES)
def test_the_reader_of_contents(tmp_path, name):
    path = written(tmp_path / "no_suffix_that_is_known.foo", good(tmp_path / name))
    assert module_of(path) == format_of(path).module == MODULES[name]


@pytest.mark.parametrize("name", ["x.cube", "x.dx", "x.xsf", "x.brix", "x.mrc"])
def test_packed_contents(tmp_path, name):
    known, packed = tmp_path / name, tmp_path / "packed"
    known.write_bytes(good(known))
    packed.write_bytes(gzip.compress(known.read_bytes()))
    np.testing.assert_array_equal(read_volume(packed).values, read_volume(known).values)


@pytest.mark.parametrize("name", ["x.vti", "x.nrrd", "x.h5", "x.vtk", "plain.tif", "x.npy"])
def test_packed_contents_that_must_be_unpacked(tmp_path, name):
    path = written(tmp_path / f"{name}.gz", gzip.compress(good(tmp_path / name)))
    refused("decompress it first", read_volume, path)


@pytest.mark.parametrize("name", sorted(MODULES.keys() - {"LOCPOT", "x.nii", "x.nii.gz"}))
def test_it_is_read(tmp_path, name):
    known, unknown = tmp_path / name, tmp_path / "unknown"
    known.write_bytes(good(known))
    unknown.write_bytes(known.read_bytes())
    np.testing.assert_array_equal(read_volume(unknown).values, read_volume(known).values)


def test_names_without_a_suffix(tmp_path):
    for name, module in (
        ("CHGCAR", "vasp"),
        ("AECCAR0.gz", "vasp"),
        ("PARCHG.0001.ALLK", "vasp"),
        ("my_LOCPOT", "vasp"),
        ("CHGCAR.cube", "cube"),
        ("CHGCAR.h5", "hdf5"),
    ):
        (tmp_path / name).write_bytes(b"")
        assert format_of(tmp_path / name).module == module
    for name in ("chgcar notes.txt", "x", "x.gz"):
        (tmp_path / name).write_bytes(b"")
        refused("suffix .*content are unknown", format_of, tmp_path / name)


@pytest.mark.parametrize(
    "content",
    [
        b"0.5 1 2\n" * 1000,
        b"some words\n" * 100,
        b"\x1f\x8b damaged",
        gzip.compress(b"some words", mtime=0),
        b"PK\x03\x04 damaged",
        b"1 2 3 4\n" * 1000,
        bytes(70000),
        b"\n" * 70000,
        b"#\n" * 40000,
        b" " * 70000,
        b"<!--" * 20000,
        b"1" * 70000,
    ],
    ids=lambda content: repr(content[:8]),
)
def test_contents_that_are_not_known(tmp_path, content):
    path = written(tmp_path / "x.foo", content)
    assert module_of(path) is None
    refused("x.foo: .*suffix .foo .*content are unknown", read_volume, path)


def test_every_reader_that_contents_name_is_there():
    named = {module for module, *_ in (*sniffing._SIGNATURES, *sniffing._TEXTS)}
    assert named <= {kind.module for kind in FORMATS}


def test_the_patterns_of_the_file_browser():
    """Checks Blender's limits: 15 characters per pattern, and 255 in total."""
    patterns = name_patterns().split(";")
    assert len(name_patterns()) <= 255 and max(map(len, patterns)) <= 15
    for name in (*(f"x{suffix}" for suffix in SUFFIXES), "CHGCAR", "LOCPOT_1", "my_PARCHG.0001"):
        assert any(fnmatchcase(name, pattern) for pattern in patterns), name
    for name in ("x.txt", "x.zip"):
        assert not any(fnmatchcase(name, pattern) for pattern in patterns), name
