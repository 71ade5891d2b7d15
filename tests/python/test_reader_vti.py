# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's image data in all the ways that VTK writes them."""

import base64
import lzma
import zlib

import numpy as np
import pytest
from leaflight import LeaflightError, read_volume
from leaflight.io.readers import probe


def header(size, data, *blocks):
    """Of compressed VTK data in blocks: their number, two sizes, and that of each."""
    lengths = [len(block) for block in blocks]
    return np.array([len(blocks), 50, len(data) - 50, *lengths], size).tobytes()


def vti(
    values,
    kind,
    form,
    size="UInt64",
    compressed=True,
    order="LittleEndian",
    compressor="ZLib",
    more='Spacing="1 2 3"',
    first=(0, 0, 0),
    data_of="PointData",
    components=1,
):
    """VTK image data, compressed in two blocks or plain."""
    mark = "<" if order == "LittleEndian" else ">"
    data = values.astype(values.dtype.newbyteorder(mark)).tobytes()
    number = mark + {"UInt32": "u4", "UInt64": "u8"}[size]
    head, body = np.array([len(data)], number).tobytes(), data
    if compressed:
        compress = zlib.compress if compressor == "ZLib" else lzma.compress
        blocks = [compress(data[:50]), compress(data[50:])]
        head, body = header(number, data, *blocks), b"".join(blocks)
    if form == "ascii":
        inline, appended = " ".join(map(str, values.ravel().tolist())).encode(), b""
    elif form == "appended64":
        encoded = b"".join(map(base64.b64encode, [head, body] if compressed else [head + body]))
        inline, appended = b"", b'<AppendedData encoding="base64">_unused' + encoded
        appended += b"</AppendedData>"
    elif form == "appended":
        inline, appended = b"", b'<AppendedData encoding="raw">\n _unused' + head + body
        appended += b"</AppendedData>"
    else:
        parts = [head, body] if compressed else [head + body]
        inline, appended = b"\n ".join([b"", b"".join(map(base64.b64encode, parts))]), b""
    ends = np.array(values.shape[2::-1]) + first - (data_of == "PointData")
    extent = " ".join(f"{low} {high}" for low, high in zip(first, ends))
    compressor = f'compressor="vtk{compressor}DataCompressor"' if compressed else ""
    form = "appended" if form == "appended64" else form
    xml = (
        f'<VTKFile type="ImageData" byte_order="{order}" header_type="{size}" {compressor}>'
        f'<ImageData WholeExtent="{extent}" {more}><Piece><{data_of}>'
        f'<DataArray Name="h" type="{kind}" format="{form}" offset="6" '
        f'NumberOfComponents="{components}">'
    )
    close = f"</DataArray></{data_of}></Piece></ImageData>".encode()
    return xml.encode() + inline + close + appended + b"</VTKFile>"


def read_back(path, content, **options):
    path.write_bytes(content)
    return read_volume(path, **options)


@pytest.mark.parametrize(
    "kind, layout",
    [
        ("UInt8", {"form": "appended"}),
        ("Float32", {"form": "binary", "size": "UInt32"}),
        ("Float64", {"form": "appended", "compressed": False}),
        ("Float32", {"form": "binary", "compressed": False}),
    ],
)
def test_vtk_images(tmp_path, values, kind, layout):
    values = values.astype(kind.lower())
    volume = read_back(tmp_path / "x.vti", vti(values, kind, **layout))
    assert np.array_equal(volume.values, values) and volume.name == "x"
    assert np.diag(volume.index_to_world).tolist() == [1, 2, 3, 1]


@pytest.mark.parametrize(
    "layout",
    [
        {"form": "ascii", "compressed": False},
        {"form": "appended64"},
        {"form": "appended64", "compressed": False},
        {"form": "binary", "compressor": "LZMA"},
        {"form": "appended", "order": "BigEndian"},
        {"form": "binary", "order": "BigEndian", "compressed": False, "size": "UInt32"},
    ],
)
def test_other_writers(tmp_path, values, layout):
    values = values.astype(np.int16)
    volume = read_back(tmp_path / "x.vti", vti(values, "Int16", **layout))
    assert np.array_equal(volume.values, values)


def test_a_place_in_space(tmp_path, values):
    """VTK: the point of an index is origin + direction (spacing index)."""
    more = 'Origin="10 20 30" Spacing="1 2 3" Direction="0 -1 0 1 0 0 0 0 1"'
    data = vti(values, "Float32", "appended", more=more, first=(2, 0, 0))
    volume = read_back(tmp_path / "x.vti", data)
    np.testing.assert_array_equal(volume.index_to_world @ [0, 0, 0, 1], [10, 22, 30, 1])
    np.testing.assert_array_equal(volume.index_to_world @ [0, 1, 1, 1], [8, 22, 33, 1])


def test_cells_have_their_values_in_the_middle(tmp_path, values):
    volume = read_back(tmp_path / "x.vti", vti(values, "Float32", "binary", data_of="CellData"))
    assert np.array_equal(volume.values, values)
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], [0.5, 1, 1.5])


def test_components_are_channels(tmp_path, values):
    both = np.stack([values, values + 1], axis=-1)
    path = tmp_path / "x.vti"
    data = vti(both, "Float32", "appended", components=2)
    assert np.array_equal(read_back(path, data, channel=1).values, values + 1)
    assert probe(path).channels == 2 and probe(path).dims == (6, 5, 4)
    with pytest.raises(LeaflightError, match="2 channels; choose one of 0..1"):
        read_volume(path)


def test_several_arrays_are_datasets(tmp_path, values):
    path = tmp_path / "x.vti"
    data = vti(values, "Float32", "ascii", compressed=False)
    one = data[data.index(b"<DataArray") : data.index(b"</PointData>")]
    other = vti(values + 1, "Float32", "ascii", compressed=False).replace(b'"h"', b'"g"')
    two = other[other.index(b"<DataArray") : other.index(b"</PointData>")]
    path.write_bytes(data.replace(one, one + two))
    assert probe(path).datasets == ("h", "g")
    assert np.array_equal(read_volume(path, dataset="g").values, values + 1)
    with pytest.raises(LeaflightError, match="2 volumes; choose one of h, g"):
        read_volume(path)
    with pytest.raises(LeaflightError, match="no volume 'f' in it; choose one of h, g"):
        read_volume(path, dataset="f")


def test_damaged(tmp_path, values):
    values = values.astype(np.uint8)
    whole = vti(values, "UInt8", "appended")
    for broken in (whole[:-200], whole.replace(b"0 5 0 4", b"0 5 0 9"), b"<x", b""):
        with pytest.raises(LeaflightError, match="x.vti: .*(truncated|damaged)"):
            read_back(tmp_path / "x.vti", broken)
    with pytest.raises(LeaflightError, match="no volume of real numbers"):
        read_back(tmp_path / "x.vti", vti(values, "String", "appended"))
    with pytest.raises(LeaflightError, match="LZ4DataCompressor is not supported"):
        read_back(tmp_path / "x.vti", whole.replace(b"ZLib", b"LZ4"))
    with pytest.raises(LeaflightError, match="claims"):
        read_back(tmp_path / "x.vti", whole.replace(b"0 5 0 4", b"0 99999999 0 99999999"))
