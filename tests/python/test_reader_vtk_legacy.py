# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests VTK's legacy files, written by VTK and other programs."""

import locale

import numpy as np
import pytest
import vtk_files
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

HEADER = """# vtk DataFile Version 3.0
a title
{}
DATASET STRUCTURED_POINTS
DIMENSIONS {}
ORIGIN 1 2 3
SPACING 0.5 1 2
"""


@pytest.fixture(autouse=True)
def own_locale():
    """Restores the process's locale, which VTK's writers of these files change."""
    before = locale.setlocale(locale.LC_ALL)
    yield
    locale.setlocale(locale.LC_ALL, before)


def by_hand(values, form="ASCII", kind="float", more="LOOKUP_TABLE default\n"):
    """Returns a handwritten file with one array of points."""
    dims = " ".join(map(str, values.shape[::-1]))
    head = HEADER.format(form, dims) + f"POINT_DATA {values.size}\nSCALARS h {kind}\n{more}"
    if form == "ASCII":
        rows = (" ".join(map(str, row)) for row in values.reshape(-1, values.shape[2]))
        return (head + "\n".join(rows)).encode()
    return head.encode() + values.astype(values.dtype.newbyteorder(">")).tobytes()


TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "f4", "f8"]


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("ascii", [False, True])
@pytest.mark.parametrize("dtype", TYPES)
def test_all_that_vtk_writes(tmp_path, values, dtype, ascii, version):
    def array(name, numbers, channels=1):
        return vtk_files.array_of(numbers.reshape(-1, channels).astype(dtype), name)

    image = vtk_files.image_of(values, (0.5, 1, 2), (1, 2, 3))
    vectors = np.stack([values, 119 - values, values // 2], axis=-1)
    cells = values[:3, :4, :5]
    image.GetPointData().SetScalars(array("density", values))
    image.GetPointData().SetVectors(array("velocity", vectors, 3))
    image.GetPointData().AddArray(array("2 theta", 119 - values))
    image.GetPointData().RemoveArray("h")
    image.GetCellData().AddArray(array("label", cells))
    words = vtk_files.vtk().vtkStringArray()
    words.SetName("words")
    words.InsertNextValue("of no length that is known")
    image.GetFieldData().AddArray(words)
    form = {"SetFileType": [1 if ascii else 2], "SetFileVersion": [version]}
    vtk_files.write("StructuredPoints", tmp_path / "x.vtk", image, **form)

    path = tmp_path / "x.vtk"
    assert probe(path).datasets == ("label", "density", "velocity", "2 theta")
    reads(values, path, dataset="density")
    reads(119 - values, path, dataset="2 theta")
    volume = reads(119 - values, path, dataset="velocity", channel=1)
    matrix = [[0.5, 0, 0, 1], [0, 1, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]]
    np.testing.assert_array_equal(volume.index_to_world, matrix)
    volume = reads(cells, path, dataset="label")
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], [1.25, 2.5, 4])


@pytest.mark.parametrize(
    "change",
    [
        ("", ""),
        ("\n", "\r\n"),
        ("a title", ""),
        ("SPACING", "ASPECT_RATIO"),
        ("\nPOINT_DATA", "\n\n\nPOINT_DATA"),
        ("LOOKUP_TABLE default\n", ""),
        ("SCALARS h float", "scalars h float 1"),
    ],
)
@pytest.mark.parametrize("form", ["ASCII", "BINARY"])
def test_files_by_hand(tmp_path, values, form, change):
    head, mark, numbers = by_hand(values, form).partition(b"default\n")
    if form == "BINARY":
        content = (head + mark).decode().replace(*change).encode() + numbers
    else:
        content = (head + mark + numbers).decode().replace(*change).encode()
    volume = reads(values, written(tmp_path / "x.vtk", content))
    assert np.diag(volume.index_to_world).tolist() == [0.5, 1, 2, 1]


def test_colors_and_their_table(tmp_path, values):
    bytes_of = values.astype(np.uint8)
    content = HEADER.format("BINARY", "6 5 4").encode() + b"POINT_DATA 120\nCOLOR_SCALARS c 2\n"
    content += np.stack([bytes_of, 119 - bytes_of], axis=-1).tobytes()
    content += b"\nLOOKUP_TABLE t 2\n" + b"\nSCALARS" + b"\nMETADATA\nINFORMATION 0\n\n"
    content += b"SCALARS h unsigned_char\nLOOKUP_TABLE t\n" + bytes_of.tobytes()
    path = written(tmp_path / "x.vtk", content)
    reads(119 - bytes_of, path, dataset="c", channel=1)
    reads(bytes_of, path, dataset="h")


def test_missing_numbers_are_numbers(tmp_path, values):
    content = by_hand(values).replace(b"\n58.0 ", b"\n nan ").replace(b"\n61.0 ", b"\n-Inf ")
    content += b"\nSCALARS g float\nLOOKUP_TABLE default\n" + b"1 2 3 4 5 6\n" * 20
    path = written(tmp_path / "x.vtk", content)
    assert probe(path).datasets == ("h", "g")
    assert read_volume(path, dataset="g").values.max() == 6


def test_damaged(tmp_path, values):
    path = tmp_path / "x.vtk"
    whole, binary = by_hand(values), by_hand(values, "BINARY")
    for broken, sentence in (
        (whole[:-20], "ends before"),
        (binary[:-20], "claims"),
        (whole.replace(b"120", b"-120"), "legacy VTK"),
        (whole.replace(b"120", b"99999999999999"), "ends before|claims"),
        (whole.replace(b"6 5 4", b"9 9 9"), "real numbers"),
        (whole.replace(b"6 5 4", b"-6 -5 4"), "shape -6 x -5 x 4"),
        (whole.replace(b"0.5 1 2", b"0 0 0"), "not invertible"),
        (whole.replace(b"float", b"bit"), "real numbers"),
        (whole.replace(b"ASCII", b"PLAIN"), "legacy VTK"),
        (whole.replace(b"STRUCTURED_POINTS", b"RECTILINEAR_GRID"), "rectilinear grid.*Resample"),
        (whole[:44], "holds no data"),
        (b"", "legacy VTK"),
    ):
        refused(f"x.vtk: .*({sentence})", read_volume, written(path, broken))
