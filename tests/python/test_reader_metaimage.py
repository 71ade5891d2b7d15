# SPDX-License-Identifier: GPL-3.0-or-later
"""MetaImage: values within the header's file or beside it, compressed or not."""

import gzip
import zlib

import numpy as np
import pytest
from leaflight import LeaflightError, read_volume
from leaflight.io.readers import probe

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
    """The world of ITK is left-posterior-superior, ours right-anterior-superior."""
    values = values.astype("<i2") - 20
    path = write(tmp_path / name, values, "MET_SHORT", data, pack, "Offset = 10 20 30")
    stored = probe(path)
    assert (stored.dims, stored.voxel_size, stored.unit) == ((6, 5, 4), (1.5, 2, 4), "mm")
    volume = read_volume(path)
    assert volume.values.dtype == np.int16 and np.array_equal(volume.values, values)
    expected = np.diag([-1.5, -2, 4, 1])
    expected[:3, 3] = -10, -20, 30
    np.testing.assert_array_equal(volume.index_to_world, expected)


@pytest.mark.parametrize(
    "kind, dtype", [("MET_UCHAR", "u1"), ("MET_FLOAT", ">f4"), ("MET_DOUBLE", "<f8")]
)
def test_types(tmp_path, values, kind, dtype):
    msb = f"BinaryDataByteOrderMSB = {'>' in dtype}"
    path = write(tmp_path / "x.mha", values.astype(dtype), kind, "LOCAL", None, msb)
    assert np.array_equal(read_volume(path).values, values)


def test_a_turned_image(tmp_path, values):
    """Row i of the matrix is the direction of axis i."""
    turned = "TransformMatrix = 0 1 0 -1 0 0 0 0 1"
    path = write(tmp_path / "x.mha", values, "MET_FLOAT", "LOCAL", None, turned)
    matrix = read_volume(path).index_to_world
    np.testing.assert_array_equal(matrix[:3, 0], [0, -1.5, 0])
    np.testing.assert_array_equal(matrix[:3, 1], [2, 0, 0])


@pytest.mark.parametrize("lines, patient", [(["RAI"], True), (["???"], False), ([], False)])
def test_a_patient(tmp_path, values, lines, patient):
    lines = [f"AnatomicalOrientation = {line}" for line in lines]
    path = write(tmp_path / "x.mha", values, "MET_FLOAT", "LOCAL", None, *lines)
    assert probe(path).patient == patient


def test_frames(tmp_path, values):
    path = write(tmp_path / "x.mha", np.stack([values, values + 1]), "MET_FLOAT")
    assert probe(path).frames == 2
    assert np.array_equal(read_volume(path, frame=1).values, values + 1)
    with pytest.raises(LeaflightError, match="2 frames; choose one of 0..1"):
        read_volume(path)


def test_damaged(tmp_path, values):
    values = values.astype("<i2")
    path = tmp_path / "x.mhd"
    for data, sentence in (
        ("../x.raw", "outside its own folder"),
        ("/etc/passwd", "outside its own folder"),
        ("LIST", "several files"),
    ):
        header = write(tmp_path / "y.mha", values).read_bytes().replace(b"LOCAL", data.encode())
        path.write_bytes(header)
        with pytest.raises(LeaflightError, match=sentence):
            read_volume(path)
    write(path, values, data="x.raw")
    (tmp_path / "x.raw").write_bytes(values.tobytes()[:-1])
    with pytest.raises(LeaflightError, match="claims 6 x 5 x 4 values"):
        read_volume(path)
    (tmp_path / "scan").mkdir()
    header = write(tmp_path / "scan" / "z.mhd", values, data="link.raw")
    (tmp_path / "scan" / "link.raw").unlink(missing_ok=True)
    (tmp_path / "scan" / "link.raw").symlink_to("../x.raw")
    with pytest.raises(LeaflightError, match="outside its own folder"):
        read_volume(header)
    digits = path.read_bytes().replace(b"DimSize = 6", b"DimSize = " + b"1" * 400)
    (tmp_path / "y.mhd").write_bytes(digits)
    with pytest.raises(LeaflightError, match="claims 10.399 x 5 x 4 values"):
        read_volume(tmp_path / "y.mhd")
    (tmp_path / "x.raw").unlink()
    with pytest.raises(LeaflightError, match="no data file 'x.raw' beside it"):
        read_volume(path)
    write(path, values, "MET_SHORT", "x.zraw", lambda data: zlib.compress(data)[:-9])
    with pytest.raises(LeaflightError, match="x.mhd: .*ends before"):
        read_volume(path)
    with pytest.raises(LeaflightError, match="several values a voxel"):
        many = "ElementNumberOfChannels = 3"
        read_volume(write(tmp_path / "z.mha", values, "MET_SHORT", "LOCAL", None, many))
