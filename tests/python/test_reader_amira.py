# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests amira's lattices: plain, zipped, run-length encoded or text, scalars and vectors."""

import zlib

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.export.amira import write_amira
from leaflight.io.readers import probe
from outcomes import reads, refused, written

HEADER = """# {first}

define Lattice 6 5 4

Parameters {{
    Materials {{
        Exterior {{ }}
        Inside {{ Color 0.8 0.1 0.1 }}
    }}
    Units {{
        Coordinates "µm"
    }}
    BoundingBox 1 11 2 14 3 18{more},
    CoordType "{kind}"
}}

{arrays}

# Data section follows
"""
LITTLE = "AmiraMesh BINARY-LITTLE-ENDIAN 2.1"


def header(arrays, first=LITTLE, kind="uniform", more=""):
    return HEADER.format(first=first, arrays=arrays, kind=kind, more=more).encode()


def runs(data):
    """Returns labels in amira's run-length encoding: counts above 128 precede different bytes."""
    packed, place = b"", 0
    while place < len(data):
        same = 1
        while same < 127 and data[place : place + same + 1] == data[place : place + 1] * (same + 1):
            same += 1
        if same > 1:
            packed, place = packed + bytes([same, data[place]]), place + same
        else:
            packed, place = packed + bytes([129, data[place]]), place + 1
    return packed


KINDS = [
    (LITTLE, "short", "<i2", ""),
    ("AmiraMesh 3D BINARY 2.0", "float", ">f4", ""),
    ("Avizo BINARY-LITTLE-ENDIAN 3.0", "double", "<f8", "HxZip"),
    (LITTLE, "ushort", "<u2", "HxZip"),
    (LITTLE, "byte", "u1", "HxByteRLE"),
    ("AmiraMesh 3D ASCII 2.0", "float", "<f4", ""),
]


@pytest.mark.parametrize("first, name, dtype, packing", KINDS)
def test_values_and_place(tmp_path, values, first, name, dtype, packing):
    """Checks that the box extends from the first point to the last."""
    values = np.sort(values // 30, axis=0) if packing == "HxByteRLE" else values
    data = values.astype(dtype).tobytes()
    data = {"HxZip": zlib.compress, "HxByteRLE": runs}.get(packing, bytes)(data)
    if "ASCII" in first:
        data = "\n".join(map(str, values.ravel())).encode() + b"\n"
    packed = f"({packing},{len(data)})" if packing else ""
    content = header(f"Lattice {{ {name} Data }} @1{packed}", first) + b"@1\n" + data + b"\n"
    path = written(tmp_path / "x.am", content)
    volume = reads(values, path)
    np.testing.assert_allclose(np.diag(volume.index_to_world), [2, 3, 5, 1])
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [1, 2, 3])
    assert volume.unit == "µm" and volume.name == "x"
    refused("x.am: .*(claims|ends before)", read_volume, written(path, content[: -len(data) // 2]))


@pytest.mark.parametrize("first", [LITTLE, "AmiraMesh 3D ASCII 2.0"])
def test_several_arrays_and_vectors(tmp_path, values, first):
    """Checks arrays by name, and vectors by channel."""
    arrays = "Lattice { float Data } @1\nLattice { float[3] Flow } = @2\nNodes { float X } @3"
    vectors = np.stack([values, -values, 2 * values], -1).astype("<f4")
    content = header(arrays, first)
    for number, array in ((1, values), (2, vectors)):
        text = " ".join(map(str, array.ravel())).encode()
        content += b"@%d\n" % number + (text if "ASCII" in first else array.tobytes()) + b"\n\n"
    path = written(tmp_path / "x.am", content)
    assert probe(path).datasets == ("Data", "Flow") and probe(path).dims is None
    refused("Data, Flow", read_volume, path)
    reads(values, path, dataset="Data")
    assert probe(path, dataset="Flow").channels == 3
    reads(-values, path, dataset="Flow", channel=1)


def test_a_turned_lattice(tmp_path, values):
    """Checks a lattice rotated by a matrix that is stored by columns."""
    turn = "TransformationMatrix 0 1 0 0 -1 0 0 0 0 0 1 0 7 8 9 1"
    start = header("Lattice { float Data } @1", more=f",\n{turn}")
    path = written(tmp_path / "x.am", start + b"@1\n" + values.tobytes())
    matrix = read_volume(path).index_to_world[:3, [0, 1, 3]]
    np.testing.assert_allclose(matrix, [[0, -3, 7 - 2], [2, 0, 8 + 1], [0, 0, 9 + 3]])


def test_what_export_writes(tmp_path, box_bake):
    write_amira(tmp_path / "x.am", box_bake)
    assert probe(tmp_path / "x.am").channels == 4
    volume = read_volume(tmp_path / "x.am", channel=0)
    np.testing.assert_allclose(volume.index_to_world, box_bake.volume.index_to_world, atol=1e-6)


def test_damaged(tmp_path, values):
    one = "Lattice { float Data } @1"
    path = tmp_path / "x.am"
    for start, sentence in (
        (header(one, kind="rectilinear"), "not evenly spaced"),
        (header(one).replace(b"define Lattice 6 5 4", b"define Nodes 9"), "no lattice"),
        (header(one).replace(b"6 5 4", b"60 50 40"), "60 x 50 x 40"),
        (header("Lattice { float Data } @1(HxWavelet,9)"), "HxWavelet"),
        (header("Lattice { float[2] Data } @9"), "real numbers"),
        (b"# HyperSurface 0.1 ASCII\n", "AmiraMesh"),
        (b"", "AmiraMesh"),
    ):
        content = start + (b"@1\n" + values.tobytes() if start else b"")
        refused(f"x.am: .*{sentence}", read_volume, written(path, content))
