# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests all ways in which VTK writes image data."""

import base64
import lzma
import re
import sys
import zlib

import numpy as np
import pytest
import vtk_files
from leaflight import read_volume
from leaflight.io.readers import MissingPackage, probe
from outcomes import reads, refused, written


def header(size, data, *blocks):
    """Returns the header of VTK's compressed data: number of blocks, and sizes."""
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
    """Returns VTK image data, compressed in two blocks or plain."""
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
    volume = reads(values, written(tmp_path / "x.vti", vti(values, kind, **layout)))
    assert volume.name == "x"
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
    reads(values, written(tmp_path / "x.vti", vti(values, "Int16", **layout)))


def test_a_place_in_space(tmp_path, values):
    """Checks VTK's formula: a point is origin + direction (spacing index)."""
    more = 'Origin="10 20 30" Spacing="1 2 3" Direction="0 -1 0 1 0 0 0 0 1"'
    data = vti(values, "Float32", "appended", more=more, first=(2, 0, 0))
    volume = read_volume(written(tmp_path / "x.vti", data))
    np.testing.assert_array_equal(volume.index_to_world @ [0, 0, 0, 1], [10, 22, 30, 1])
    np.testing.assert_array_equal(volume.index_to_world @ [0, 1, 1, 1], [8, 22, 33, 1])


def test_cells_have_their_values_in_the_middle(tmp_path, values):
    data = vti(values, "Float32", "binary", data_of="CellData")
    volume = reads(values, written(tmp_path / "x.vti", data))
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], [0.5, 1, 1.5])


def test_components_are_channels(tmp_path, values):
    both = np.stack([values, values + 1], axis=-1)
    path = written(tmp_path / "x.vti", vti(both, "Float32", "appended", components=2))
    reads(values + 1, path, channel=1)
    assert probe(path).channels == 2 and probe(path).dims == (6, 5, 4)
    refused("2 channels.* 0..1", read_volume, path)


def test_several_arrays_are_datasets(tmp_path, values):
    path = tmp_path / "x.vti"
    data = vti(values, "Float32", "ascii", compressed=False)
    one = data[data.index(b"<DataArray") : data.index(b"</PointData>")]
    other = vti(values + 1, "Float32", "ascii", compressed=False).replace(b'"h"', b'"g"')
    two = other[other.index(b"<DataArray") : other.index(b"</PointData>")]
    path.write_bytes(data.replace(one, one + two))
    assert probe(path).datasets == ("h", "g")
    reads(values + 1, path, dataset="g")
    refused("2 volumes.* h, g", read_volume, path)
    refused("'f'.* h, g", read_volume, path, dataset="f")


def test_damaged(tmp_path, values):
    values = values.astype(np.uint8)
    whole, extent = vti(values, "UInt8", "appended"), b"0 5 0 4"
    damaged = "x.vti: .*(truncated|damaged)"
    for broken, sentence in (
        (whole[:-200], damaged),
        (whole.replace(extent, b"0 5 0 9"), damaged),
        (b"<x", damaged),
        (b"", damaged),
        (vti(values, "String", "appended"), "real numbers"),
        (whole.replace(b"ZLib", b"ZStd"), "ZStdDataCompressor is not supported"),
        (whole.replace(b"ZLib", b"LZ4"), "ends before"),
        (whole.replace(extent, b"0 99999999 0 99999999"), "claims"),
    ):
        refused(sentence, read_volume, written(tmp_path / "x.vti", broken))


def image_of_vtk(values, cells=None):
    """Returns a vtkImageData whose first point has the index -2."""
    image = vtk_files.image_of(values, (1, 2, 3), (10, 20, 30))
    nz, ny, nx = values.shape
    image.SetExtent(-2, nx - 3, 1, ny, 0, nz - 1)
    image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    if cells is not None:
        image.GetCellData().SetScalars(vtk_files.array_of(cells.ravel(), "h"))
    return image


@pytest.mark.parametrize("big_endian", [False, True])
@pytest.mark.parametrize("compressor", ["None", "ZLib", "LZ4", "LZMA"])
@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended", "Raw"])
def test_all_that_vtk_writes(tmp_path, values, mode, compressor, big_endian):
    if compressor == "LZ4":
        pytest.importorskip("lz4")
    image = image_of_vtk(values, cells=-values[:3, :4, :5])
    vtk_files.write(
        "XMLImageData",
        tmp_path / "x.vti",
        image,
        SetDataMode=[{"Ascii": 0, "Binary": 1}.get(mode, 2)],
        SetEncodeAppendedData=[int(mode != "Raw")],
        **{f"SetCompressorTypeTo{compressor}": []},
        SetBlockSize=[96],
        SetByteOrder=[int(not big_endian)],
    )
    points = reads(values, tmp_path / "x.vti")
    assert "other datasets are h (cells)" in points.notes[0]
    cells = reads(-values[:3, :4, :5], tmp_path / "x.vti", dataset="h (cells)")
    for volume, shift in ((points, 0), (cells, 0.5)):
        for index in ((0, 0, 0), (3, 2, 1)):
            theirs = np.zeros(3)
            place = np.array([index[0] - 2, index[1] + 1, index[2]]) + shift
            image.TransformContinuousIndexToPhysicalPoint(place, theirs)
            np.testing.assert_allclose((volume.index_to_world @ [*index, 1])[:3], theirs)


def in_pieces(folder, image, **settings):
    """Writes five files along x, which share the points between them."""
    from vtkmodules.vtkImagingCore import vtkExtractVOI

    paths = []
    for number in range(5):
        part = vtkExtractVOI()
        part.SetInputData(image)
        part.SetVOI(number - 2, number - 1, 1, 5, 0, 3)
        part.Update()
        paths.append(folder / f"x_{number}.vti")
        vtk_files.write("XMLImageData", paths[-1], part.GetOutput(), **settings)
    return paths


HEAD = """WholeExtent="-2 3 1 5 0 3" Origin="10 20 30" Spacing="1 2 3" {}>"""
DIRECTION = 'Direction="0 -1 0 1 0 0 0 0 1"'


@pytest.mark.parametrize("direction", ["", DIRECTION])
def test_pieces_in_files_of_their_own(tmp_path, values, direction):
    """Checks VTK 9.1, whose file leaves out the direction and takes it from the pieces."""
    path = tmp_path / "x.pvti"
    cells = -values[:3, :4, :5]
    paths = in_pieces(tmp_path, image_of_vtk(values, cells))
    pieces = [
        f'<Piece Extent="{number - 2} {number - 1} 1 5 0 3" Source="{one.name}"/>'
        for number, one in enumerate(paths)
    ]
    text = f'<VTKFile type="PImageData"><PImageData {HEAD.format(direction)}{"".join(pieces)}'
    volume = reads(values, written(path, text + "</PImageData></VTKFile>"))
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [8, 18, 30])
    reads(cells, path, dataset="h (cells)")
    paths[2].unlink()
    refused("x.pvti: .*'x_2.vti'", read_volume, path)
    path.write_text(path.read_text().replace("x_1.vti", "../x_1.vti"))
    refused("outside .* folder", read_volume, path)
    path.write_text(path.read_text().replace("../x_1.vti", "x.pvti"))
    refused("consists of pieces", read_volume, path)


def test_missing_pieces(tmp_path, values):
    """Checks missing pieces: at an end the image is smaller, otherwise there are no data."""
    path = tmp_path / "x.vti"
    paths = in_pieces(tmp_path, image_of_vtk(values), SetDataModeToAscii=[], SetCompressor=[None])
    pieces = [re.search(r"<Piece .*?</Piece>", one.read_text(), re.DOTALL)[0] for one in paths]

    def of_pieces(*numbers):
        image = f"<ImageData {HEAD.format(DIRECTION)}{''.join(pieces[n] for n in numbers)}"
        path.write_text(f'<VTKFile type="ImageData">{image}</ImageData></VTKFile>')
        return read_volume(path)

    volume = of_pieces(0, 1, 2, 3, 4)
    np.testing.assert_array_equal(volume.values, values)
    assert not volume.notes
    volume = of_pieces(4, 2, 1, 3)
    np.testing.assert_array_equal(volume.values, values[..., 1:])
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [8, 19, 30])
    assert volume.notes == ("The pieces hold 5 x 5 x 4 of the 6 x 5 x 4 points in the header.",)
    # Both pieces contain the points on their border.
    volume = of_pieces(0, 2, 4)
    np.testing.assert_array_equal(volume.values, values)
    volume = of_pieces(0, 3, 4)
    assert np.isnan(volume.values[..., 2]).all() and "20 of 120 voxels" in volume.notes[0]
    kept = [0, 1, 3, 4, 5]
    np.testing.assert_array_equal(volume.values[..., kept], values[..., kept])


def test_pieces_that_claim_too_much(tmp_path, values):
    path, extent = tmp_path / "x.vti", b'"0 5 0 4 0 3"'
    data = vti(values, "Float32", "appended").replace(b"<Piece>", b"<Piece Extent=%b>" % extent)
    far = b'<Piece Extent="99999 99999 99999 99999 9999 9999"/><Piece '
    for broken, sentence in (
        (data.replace(b"<Piece ", far), "nearly all of the"),
        (data.replace(extent, b'"0 9999 0 9999 0 9999"'), "claims"),
        (data.replace(extent, b'"0 -1 0 -1 0 -1"'), "has 0 pieces"),
    ):
        refused(sentence, read_volume, written(path, broken))


def test_other_data_of_vtk(tmp_path, values):
    data = vti(values, "Float32", "appended").replace(b"ImageData", b"RectilinearGrid")
    sentence = "holds RectilinearGrid data.*Resample To Image"
    for name in ("x.vti", "x.vtr"):
        refused(sentence, read_volume, written(tmp_path / name, data))


def test_lz4_is_not_installed(tmp_path, values, monkeypatch):
    monkeypatch.setitem(sys.modules, "lz4", None)
    data = vti(values, "Float32", "appended").replace(b"ZLib", b"LZ4")
    with pytest.raises(MissingPackage, match="x.vti: .*lz4"):
        read_volume(written(tmp_path / "x.vti", data))
