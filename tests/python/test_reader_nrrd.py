# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests NRRD headers: the start of the values, the number of data files, and the axes."""

import bz2
import gzip

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

HEADER = "NRRD0005\ntype: int16\ndimension: {n}\nsizes: {sizes}\nendian: little\n"
PACK = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}


def header(sizes=(6, 5, 4), encoding="raw", *lines):
    start = HEADER.format(n=len(sizes), sizes=" ".join(map(str, sizes)))
    return "\n".join([start.rstrip(), f"encoding: {encoding}", *lines, ""])


@pytest.fixture
def shorts(values):
    return values.astype("<i2")


def write(path, text, data):
    path.write_bytes(text.encode() + b"\n" + data)
    return path


# Bytes to skip, and bytes before and after the values.
SKIPS = [
    (3, b"xyz", b""),
    (0, b"", b"more"),
    (-1, b"any", b""),
    (-1, b"", b""),
    (-4, b"any", b"xyz"),
]


@pytest.mark.parametrize("encoding", PACK)
@pytest.mark.parametrize("skip, before, behind", SKIPS)
@pytest.mark.parametrize("lines", [0, 2])
def test_skips(tmp_path, shorts, encoding, skip, before, behind, lines):
    """Checks that lines are skipped before values are unpacked, and bytes afterwards."""
    fields = (f"line skip: {lines}", f"byte skip: {skip}", "data file: x.bin")
    path = written(tmp_path / "x.nhdr", header((6, 5, 4), encoding, *fields))
    data = b"a line\n" * lines + PACK[encoding](before + shorts.tobytes() + behind)
    (tmp_path / "x.bin").write_bytes(data)
    volume = reads(shorts, path)
    # Bytes behind the values may be those of a header before them.
    is_noted = len(behind) if skip >= 0 and encoding in ("raw", "gzip") else 0
    assert [note for note in volume.notes if f"hold {len(behind)} bytes more" in note] == (
        list(volume.notes) if is_noted else []
    )
    if lines == 0 and skip == -1:
        by_pynrrd(path, shorts)
    short = b"a line\n" * lines + PACK[encoding](shorts.tobytes()[: -1 - len(before)])
    (tmp_path / "x.bin").write_bytes(short)
    refused("x.bin: .*(claims|ends before)", read_volume, path)


@pytest.mark.parametrize("encoding", ["ascii", "hex"])
def test_text_is_not_found_from_its_end(tmp_path, shorts, encoding):
    text = shorts.tobytes().hex() if encoding == "hex" else " ".join(map(str, shorts.ravel()))
    text_header = header((6, 5, 4), encoding, "byte skip: 2")
    path = write(tmp_path / "x.nrrd", text_header, b"zz" + text.encode())
    reads(shorts, path)
    write(path, header((6, 5, 4), encoding, "byte skip: -1"), text.encode())
    refused("number of bytes", read_volume, path)


# Value of the field, number of axes in a file, order of the files.
SPREAD = [
    ("LIST", 2, 1),
    ("LIST 2", 2, 1),
    ("LIST 1", 1, 1),
    ("LIST 3", 3, 1),
    ("x%03d.bin 0 3 1", 2, 1),
    ("x%03d.bin 3 0 -1", 2, -1),
    ("x%03d.bin 0 19 1 1", 1, 1),
    ("x%03d.bin 0 1 1 3", 3, 1),
]


@pytest.mark.parametrize("encoding", PACK)
@pytest.mark.parametrize("field, axes, order", SPREAD)
def test_several_files(tmp_path, shorts, encoding, field, axes, order):
    """Checks files in a list or by numbers; files with all axes are slabs along the last axis."""
    parts = {1: shorts.reshape(20, 6), 2: shorts, 3: shorts.reshape(2, 2, 5, 6)}[axes][::order]
    names = [f"x{k:03d}.bin" for k in range(len(parts))]
    for name, part in zip(names, parts):
        (tmp_path / name).write_bytes(PACK[encoding](b"head" + part.tobytes()))
    text = header((6, 5, 4), encoding, "byte skip: -1", f"data file: {field}")
    path = written(tmp_path / "x.nhdr", text + ("\n".join(names) + "\n" if "LIST" in field else ""))
    reads(shorts, path)
    (tmp_path / names[1]).unlink()
    refused("'x001.bin'", read_volume, path)


def test_lists_that_do_not_fit(tmp_path, shorts):
    (tmp_path / "x.bin").write_bytes(bytes(60))
    path = tmp_path / "x.nhdr"
    for field, sentence in (
        ("LIST\nx.bin\nx.bin", "2 data files.* 6 x 5 x 4"),
        ("LIST 3\nx.bin\nx.bin\nx.bin", "names 3 data files"),
        ("LIST 9\nx.bin", "names 1 data files"),
        ("x%d.bin 1 999999999 1", "names 999999999 data files"),
        ("x%d.bin 0 3 0", "steps of 0"),
        ("LIST\n../x.bin\nx.bin\nx.bin\nx.bin", "outside .* folder"),
    ):
        refused(sentence, read_volume, written(path, header() + f"data file: {field}\n"))


# Fields, voxel size and position of the first voxel.
PLACES = [
    ("axis mins: 1 2 3|axis maxs: 4 12 11", (0.5, 2, 2), (1.25, 3, 4)),
    ("axismins: 1 2 3|axismaxs: 4 12 11|centers: cell ??? none", (0.5, 2, 2), (1.25, 3, 4)),
    ("axis mins: 1 2 3|axis maxs: 6 6 9|centerings: node node node", (1, 1, 2), (1, 2, 3)),
    ("axis mins: 1 2 0|axis maxs: 4 6 8|centerings: cell node cell", (0.5, 1, 2), (1.25, 2, 1)),
    ("spacings: 1 2 3|axis mins: 4 5 6", (1, 2, 3), (4.5, 6, 7.5)),
    ("spacings: 1 nan 3|axis mins: nan 5 nan|axis maxs: nan 10 nan", (1, 1, 3), (0, 5.5, 0)),
    ("axis mins: 4 5 6|axis maxs: 1 10 10", (-0.5, 1, 1), (3.75, 5.5, 6.5)),
    ("spacings: nan nan nan", (1, 1, 1), (0, 0, 0)),
]


@pytest.mark.parametrize("lines, steps, origin", PLACES)
def test_places_without_directions(tmp_path, shorts, lines, steps, origin):
    path = write(tmp_path / "x.nrrd", header((6, 5, 4), "raw", *lines.split("|")), shorts.tobytes())
    matrix = read_volume(path).index_to_world
    np.testing.assert_allclose(matrix[:3, :3], np.diag(steps))
    np.testing.assert_allclose(matrix[:3, 3], origin)


@pytest.mark.parametrize(
    "line, scale, unit",
    [
        ('space units: "um" "um" "um"', (1, 1, 1), "µm"),
        ('space units: "mm" "um" "mm"', (1, 1e-3, 1), "mm"),
        ('units: "" "nm" "um" "nm"', (1, 1e3, 1), "nm"),
    ],
)
def test_a_unit_for_each_axis(tmp_path, shorts, line, scale, unit):
    sizes, more = (6, 5, 4), "space directions: (1,0,0) (0,2,0) (0,0,3)"
    if line.startswith("units"):
        sizes, more = (1, 6, 5, 4), "kinds: vector domain domain domain\nspacings: nan 1 2 3"
    path = write(tmp_path / "x.nrrd", header(sizes, "raw", line, more), shorts.tobytes())
    volume = read_volume(path)
    np.testing.assert_allclose(np.diag(volume.index_to_world)[:3], np.multiply(scale, (1, 2, 3)))
    assert volume.unit == unit


THREE = "(1,0,0) (0,2,0) (0,0,3)"
# Sizes, fields, role and position of the axis beside x, y and z, and a word of the note.
FOURTH = [
    ((2, 6, 5, 4), "kinds: vector domain domain domain", "channels", -1, ""),
    ((2, 6, 5, 4), "kinds: list space space space", "channels", -1, ""),
    ((2, 6, 5, 4), "kinds: complex ??? ??? ???", "channels", -1, ""),
    ((2, 6, 5, 4), f"space directions: none {THREE}", "channels", -1, ""),
    ((2, 6, 5, 4), f"space directions: (nan,nan,nan) {THREE}", "channels", -1, ""),
    ((6, 5, 4, 2), f"space directions: {THREE} none", "channels", 0, ""),
    ((6, 5, 4, 2), "kinds: domain domain domain list", "channels", 0, ""),
    ((6, 5, 4, 2), "kinds: domain domain domain time", "frames", 0, ""),
    ((6, 5, 4, 2), "kinds: domain domain domain domain", "frames", 0, ""),
    ((6, 5, 2, 4), "kinds: domain domain RGB-color domain", "channels", 1, ""),
    ((6, 5, 4, 2), "content: x", "frames", 0, "the last, of 2, is read as frames"),
    ((2, 6, 5, 4), "content: x", "channels", -1, "the first, of 2, is read as channels"),
    ((6, 5, 4, 1), "content: x", "", 0, ""),
    ((1, 6, 5, 4), "content: x", "", -1, ""),
    ((1, 6, 5, 4), "kinds: vector domain domain domain", "", -1, ""),
]


@pytest.mark.parametrize("encoding", ["raw", "gzip"])
@pytest.mark.parametrize("sizes, fields, role, place, note", FOURTH)
def test_a_fourth_axis(tmp_path, shorts, encoding, sizes, fields, role, place, note):
    """Checks the fourth axis of diffusion data, segmentations and series."""
    count = 2 if role else 1
    data = np.stack([shorts + i for i in range(count)], axis=place if place < 1 else 1)
    assert data.shape == sizes[::-1]
    packed = PACK[encoding](data.tobytes())
    path = write(tmp_path / "x.nrrd", header(sizes, encoding, fields), packed)
    stored = probe(path)
    assert stored.dims == (6, 5, 4)
    found = {"frames": stored.frames, "channels": stored.channels}
    assert found == {"frames": 1, "channels": 1, **({role: 2} if role else {})}
    chosen = {role[:-1]: 1} if role else {}
    volume = reads(shorts + count - 1, path, **chosen)
    assert note in " ".join(volume.notes) and bool(note) == bool(volume.notes)
    if "directions" in fields:
        np.testing.assert_array_equal(np.diag(volume.index_to_world)[:3], (1, 2, 3))


def test_time_as_a_fourth_dimension_of_space(tmp_path, shorts):
    """Checks ITK's way to write images of four dimensions."""
    fields = (
        "space: right-anterior-superior-time",
        "space directions: (1,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,0,4)",
        "space origin: (7,8,9,0)",
    )
    data = np.stack([shorts, shorts + 1]).tobytes()
    path = write(tmp_path / "x.nrrd", header((6, 5, 4, 2), "raw", *fields), data)
    volume = reads(shorts + 1, path, frame=1)
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], (7, 8, 9))
    assert volume.patient


@pytest.mark.parametrize(
    "space, unit, patient",
    [("left-posterior-superior", "mm", True), ("LAS", "mm", True), ("3D-right-handed", "", False)]
    + [("3D-left-handed-time", "", False), ("scanner-xyz", "", False)],
)
def test_spaces_of_a_patient(tmp_path, shorts, space, unit, patient):
    fields = (f"space: {space}", f"space directions: {THREE}")
    volume = reads(
        shorts, write(tmp_path / "x.nrrd", header((6, 5, 4), "raw", *fields), shorts.tobytes())
    )
    assert (volume.unit, volume.patient) == (unit, patient)


def test_channels_of_frames(tmp_path, shorts):
    data = np.stack([np.stack([shorts + 10 * t + c for c in range(3)], -1) for t in range(2)])
    start = header((3, 6, 5, 4, 2), "gzip", "kinds: vector domain domain domain time")
    path = write(tmp_path / "x.nrrd", start, gzip.compress(data.tobytes()))
    reads(shorts + 12, path, frame=1, channel=2)


PICTURES = [
    ((3, 8, 5), "kinds: RGB-color domain domain"),
    ((8, 5, 3), "kinds: domain domain RGBA-color"),
    ((3, 8, 5), "space dimension: 2\nspace directions: none (1,0) (0,1)"),
    ((3, 8, 5), "kinds: vector space space"),
    ((8, 5, 3), "kinds: domain domain time"),
    ((24, 5), "kinds: domain domain"),
]


@pytest.mark.parametrize("sizes, fields", PICTURES)
def test_a_picture_is_no_volume(tmp_path, shorts, sizes, fields):
    path = write(tmp_path / "x.nrrd", header(sizes, "raw", *fields.split("\n")), shorts.tobytes())
    refused("x.nrrd: .* 2 of the axes", read_volume, path)


def test_a_picture_of_pynrrd(tmp_path):
    nrrd = pytest.importorskip("nrrd")
    picture, kinds = np.arange(1800, dtype=np.uint8), ["RGB-color", "domain", "domain"]
    nrrd.write(str(tmp_path / "x.nrrd"), picture.reshape(3, 20, 30), {"kinds": kinds})
    refused("x.nrrd: .* 2 of the axes", read_volume, tmp_path / "x.nrrd")


def test_what_may_be_a_picture(tmp_path):
    values = np.arange(3 * 20 * 30, dtype="<i2").reshape(30, 20, 3)
    path = write(tmp_path / "x.nrrd", header((3, 20, 30)), values.tobytes())
    assert "colors" in read_volume(path).notes[0]


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2", "ascii"])
def test_files_of_pynrrd(tmp_path, shorts, encoding):
    nrrd = pytest.importorskip("nrrd")
    about = {"encoding": encoding, "axis mins": [0, 0, 0], "axis maxs": [3, 10, 12]}
    nrrd.write(str(tmp_path / "x.nrrd"), shorts.T, about)
    volume = reads(shorts, tmp_path / "x.nrrd")
    np.testing.assert_allclose(np.diag(volume.index_to_world)[:3], (0.5, 2, 3))
    four = np.stack([shorts.T, shorts.T + 1])
    nrrd.write(str(tmp_path / "y.nrrd"), four, {"kinds": ["list", *["domain"] * 3]})
    reads(shorts + 1, tmp_path / "y.nrrd", channel=1)


def by_pynrrd(path, values):
    """Checks that pynrrd reads the same values."""
    try:
        import nrrd
    except ImportError:
        return
    np.testing.assert_array_equal(nrrd.read(str(path))[0].T, values)
