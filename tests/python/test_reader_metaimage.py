# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests MetaImage: values in the header's file or another one, compressed or not."""

import gzip
import zlib
from importlib.util import find_spec

import numpy as np
import pytest
import vtk_files
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

LINES = (
    "ObjectType = Image",
    "NDims = {n}",
    "ElementSpacing = 1.5 2 4{more}",
    "DimSize = {dims}",
    "ElementType = {kind}",
)


def write(path, values, kind="MET_SHORT", data="LOCAL", pack=None, *lines):
    dims = values.shape[::-1]
    more = " 1" * (len(dims) - 3)
    text = "\n".join(LINES).format(n=len(dims), dims=" ".join(map(str, dims)), kind=kind, more=more)
    content = values.tobytes()
    if pack is not None:
        content, lines = pack(content), ("CompressedData = True", *lines)
    header = "\n".join([text, *lines, f"ElementDataFile = {data}\n"]).encode()
    path.write_bytes(header + (content if data == "LOCAL" else b""))
    if data != "LOCAL":
        (path.parent / data).write_bytes(content)
    return path


@pytest.mark.parametrize("name, data", [("x.mha", "LOCAL"), ("x.mhd", "x.zraw")])
@pytest.mark.parametrize("pack", [None, zlib.compress, gzip.compress])
def test_values_and_place(tmp_path, values, name, data, pack):
    """Checks positions: ITK's x and y axes point left and back, ours right and front."""
    values = values.astype("<i2") - 20
    path = write(tmp_path / name, values, "MET_SHORT", data, pack, "Offset = 10 20 30")
    stored = probe(path)
    assert (stored.dims, stored.voxel_size, stored.unit) == ((6, 5, 4), (1.5, 2, 4), "mm")
    volume = read_volume(path)
    assert volume.values.dtype == np.int16 and np.array_equal(volume.values, values)
    expected = np.diag([-1.5, -2, 4, 1])
    expected[:3, 3] = -10, -20, 30
    np.testing.assert_array_equal(volume.index_to_world, expected)


TYPES = {
    "MET_ASCII_CHAR": "i1",
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "<i2",
    "MET_USHORT": "<u2",
    "MET_INT": "<i4",
    "MET_UINT": "<u4",
    "MET_LONG": "<i4",
    "MET_ULONG": "<u4",
    "MET_LONG_LONG": "<i8",
    "MET_ULONG_LONG": "<u8",
    "MET_FLOAT": "<f4",
    "MET_DOUBLE": "<f8",
    "MET_DOUBLE_ARRAY": "<f8",
}


@pytest.mark.parametrize("kind", TYPES)
def test_types(tmp_path, values, kind):
    """Checks all types; a long has four bytes on every machine."""
    values = values - 60 if TYPES[kind][-2] in "if" else values
    path = write(tmp_path / "x.mha", values.astype(TYPES[kind]), kind)
    volume = read_volume(path)
    assert np.array_equal(volume.values, values) and volume.notes == ()
    # VTK ends the process for types that it does not know.
    if kind.count("_") == 1 and "LONG" not in kind:
        by_vtk(path, values)


def test_long_ones_of_eight_bytes(tmp_path, values):
    path = write(tmp_path / "x.mha", values.astype("<i8") - 60, "MET_LONG")
    volume = reads(values - 60, path)
    assert "eight bytes" in volume.notes[0]


@pytest.mark.parametrize("key", ["BinaryDataByteOrderMSB", "ElementByteOrderMSB"])
@pytest.mark.parametrize("word", ["True", "true", "TRUE", "T", "t", "1", "False", "F", "0", "no"])
def test_byte_orders(tmp_path, values, key, word):
    values = values.astype("<i2" if word[0] in "F0n" else ">i2")
    path = write(tmp_path / "x.mha", values, "MET_SHORT", "LOCAL", None, f"{key} = {word}")
    reads(values, path)
    by_vtk(path, values)


@pytest.mark.parametrize("name, data", [("x.mha", "LOCAL"), ("x.mhd", "x.txt")])
@pytest.mark.parametrize("kind", ["MET_SHORT", "MET_FLOAT", "MET_ULONG_LONG"])
def test_text(tmp_path, values, name, data, kind):
    values = values + (0.25 if kind == "MET_FLOAT" else 1)
    lines = ("BinaryData = False", "CompressedData = True")
    path = write(tmp_path / name, values, kind, data, None, *lines)
    words = " ".join(map(str, values.ravel().astype(float if kind == "MET_FLOAT" else int)))
    place = path if data == "LOCAL" else tmp_path / data
    content = place.read_bytes()
    place.write_bytes(content[: len(content) - values.nbytes] + words.encode())
    reads(values, path)
    for end in (b"", b"no number", b"9" * 30):
        place.write_bytes(content[: len(content) - values.nbytes] + words[:-7].encode() + end)
        refused("ends before", read_volume, path)


@pytest.mark.parametrize("size, before", [(7, 7), (-1, 9), (0, 0)])
def test_headers_of_the_values(tmp_path, values, size, before):
    """Checks values after a header of given size; with -1 the values are at the end of the file."""
    values = values.astype("<i2")
    path = write(tmp_path / "x.mhd", values, "MET_SHORT", "x.raw", None, f"HeaderSize = {size}")
    (tmp_path / "x.raw").write_bytes(bytes(range(before)) + values.tobytes())
    reads(values, path)
    by_vtk(path, values)
    (tmp_path / "x.raw").write_bytes(values.tobytes()[:-1])
    refused("x.raw: .*claims", read_volume, path)


@pytest.mark.parametrize("size", [-1, 500])
def test_headers_of_local_values(tmp_path, values, size):
    """Checks that such a size counts from the first byte of the file."""
    values = values.astype("<i2")
    path = write(tmp_path / "x.mha", values, "MET_SHORT", "LOCAL", None, f"HeaderSize = {size}")
    header = path.read_bytes()[: -values.nbytes]
    reads(values, written(path, header.ljust(500) + values.tobytes()))
    by_vtk(path, values)


SPREAD = {
    "LIST": 3,
    "list 2": 3,
    "LIST 2D": 3,
    "LIST 1": 2,
    "x%03d.raw": 3,
    "x%03d.raw 1": 3,
    "x%03d.raw 1 4": 3,
    "x%03d.raw 1 4 1": 3,
    "a x%03d.raw 1 4 1": 3,
}


@pytest.mark.parametrize("pack", [None, zlib.compress])
@pytest.mark.parametrize("field", SPREAD)
def test_several_files(tmp_path, values, field, pack):
    """Checks a list after the header and numbered names; each file may be compressed."""
    values = values.astype("<i2")
    parts = values if SPREAD[field] == 3 else values.reshape(-1, values.shape[-1])
    prefix = "a " if field.startswith("a ") else ""
    names = [f"{prefix}x{k + 1:03d}.raw" for k in range(len(parts))]
    for name, part in zip(names, parts):
        (tmp_path / name).write_bytes(b"header" + (pack or bytes)(part.tobytes()))
    packed = f"CompressedData = {pack is not None}"
    path = write(tmp_path / "x.mha", values, "MET_SHORT", "LOCAL", None, packed, "HeaderSize = 6")
    header = path.read_text("latin-1")
    header = header[: header.index("LOCAL")] + field + "\n"
    if "%" not in field:
        header += "\r\n".join(names) + "\n"
    path = written(tmp_path / "x.mhd", header)
    volume = reads(values, path)
    assert volume.name == "x"
    if pack is None and field not in ("list 2", "x%03d.raw 1 4"):
        by_vtk(path, values)
    (tmp_path / names[2]).write_bytes((tmp_path / names[2]).read_bytes()[:-9])
    refused("x003.raw|x001.raw", read_volume, path)
    (tmp_path / names[2]).unlink()
    refused("x003.raw'", read_volume, path)


def test_a_listed_file_outside_the_folder(tmp_path, values):
    folder = tmp_path / "scan"
    folder.mkdir()
    (tmp_path / "secret.raw").write_bytes(bytes(60))
    (folder / "link.raw").symlink_to("../secret.raw")
    text = write(tmp_path / "x.mha", values).read_bytes().split(b"LOCAL")[0] + b"LIST\n"
    for name in (b"../secret.raw", b"link.raw", b"/etc/hostname", b"C:/secret.raw"):
        (folder / "x.mhd").write_bytes(text + b"\n".join([name] * 4))
        refused("outside .* folder", read_volume, folder / "x.mhd")


def test_values_packed_afterwards(tmp_path, values):
    values = values.astype("<i2")
    path = write(tmp_path / "x.mhd", values, "MET_SHORT", "x.raw")
    (tmp_path / "x.raw.gz").write_bytes(gzip.compress((tmp_path / "x.raw").read_bytes()))
    (tmp_path / "x.raw").unlink()
    reads(values, path)
    by_vtk(path, values)


@pytest.mark.parametrize("pack", [None, zlib.compress])
def test_several_values_a_voxel_are_channels(tmp_path, values, pack):
    both = np.stack([values, values + 1], axis=-1).astype("<i2")
    path = write(tmp_path / "x.mha", both, "MET_SHORT", "LOCAL", pack)
    text = path.read_bytes().replace(b"DimSize = 2 6 5 4", b"DimSize = 6 5 4")
    text = text.replace(b"NDims = 4", b"NDims = 3").replace(b"2 4 1\n", b"2 4\n")
    file = b"ElementDataFile"
    written(path, text.replace(file, b"ElementNumberOfChannels = 2\n" + file))
    assert probe(path).channels == 2
    reads(values + 1, path, channel=1)
    refused("2 channels.* 0..1", read_volume, path)


def test_files_of_vtk(tmp_path, values):
    image = vtk_files.image_of(values, (1.5, 2, 4), (10, 20, 30))
    for pack in (False, True):
        vtk_files.write("MetaImage", tmp_path / "x.mhd", image, SetCompression=[pack])
        volume = reads(values, tmp_path / "x.mhd")
        np.testing.assert_allclose(volume.index_to_world[:3, 3], [-10, -20, 30])


def by_vtk(path, values):
    """Checks that VTK's reader, which is ITK's, reads the same values."""
    if find_spec("vtkmodules"):
        read = vtk_files.numbers_of(vtk_files.read("MetaImage", path).GetPointData())
        assert np.array_equal(read["MetaImage"].reshape(values.shape), values)


def test_a_turned_image(tmp_path, values):
    """Checks a rotated image: row i of the matrix is the direction of axis i."""
    turned = "TransformMatrix = 0 1 0 -1 0 0 0 0 1"
    path = write(tmp_path / "x.mha", values, "MET_FLOAT", "LOCAL", None, turned)
    matrix = read_volume(path).index_to_world[:3, :2]
    np.testing.assert_array_equal(matrix, [[0, 2], [-1.5, 0], [0, 0]])


@pytest.mark.parametrize("lines, patient", [(["RAI"], True), (["???"], False), ([], False)])
def test_a_patient(tmp_path, values, lines, patient):
    lines = [f"AnatomicalOrientation = {line}" for line in lines]
    path = write(tmp_path / "x.mha", values, "MET_FLOAT", "LOCAL", None, *lines)
    assert probe(path).patient == patient


def test_frames(tmp_path, values):
    path = write(tmp_path / "x.mha", np.stack([values, values + 1]), "MET_FLOAT")
    assert probe(path).frames == 2
    reads(values + 1, path, frame=1)
    refused("2 frames.* 0..1", read_volume, path)


def test_damaged(tmp_path, values):
    values = values.astype("<i2")
    path = tmp_path / "x.mhd"
    for data, sentence in (
        ("../x.raw", "outside .* folder"),
        ("/etc/passwd", "outside .* folder"),
        ("LIST", "names . data files"),
        ("x%03d.raw 1 3", "3 data files.* 6 x 5 x 4"),
        ("../x%d.raw 1 4 1", "outside .* folder"),
        ("x%d.raw 1 4 0", "steps of 0"),
        ("x%d.raw", "'x1.raw'"),
        ("x%s.raw", "'x%s.raw'"),
    ):
        header = write(tmp_path / "y.mha", values).read_bytes().replace(b"LOCAL", data.encode())
        refused(sentence, read_volume, written(path, header))
    write(path, values, data="x.raw")
    (tmp_path / "x.raw").write_bytes(values.tobytes()[:-1])
    refused("6 x 5 x 4", read_volume, path)
    (tmp_path / "scan").mkdir()
    header = write(tmp_path / "scan" / "z.mhd", values, data="link.raw")
    (tmp_path / "scan" / "link.raw").unlink(missing_ok=True)
    (tmp_path / "scan" / "link.raw").symlink_to("../x.raw")
    refused("outside .* folder", read_volume, header)
    digits = path.read_bytes().replace(b"DimSize = 6", b"DimSize = " + b"1" * 400)
    refused("10.399 x 5 x 4", read_volume, written(tmp_path / "y.mhd", digits))
    (tmp_path / "x.raw").unlink()
    refused("'x.raw'", read_volume, path)
    write(path, values, "MET_SHORT", "x.zraw", lambda data: zlib.compress(data)[:-9])
    refused("x.mhd: .*ends before", read_volume, path)
