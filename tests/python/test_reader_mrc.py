# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests maps of electron microscopy: MRC and CCP4."""

import gzip
import tracemalloc

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

pytest.importorskip("mrcfile")


def ccp4(values, order=(2, 1, 3), starts=(0, 0, 0), angles=(90, 90, 90), **fields):
    """Writes columns, rows and sections along the axes of `order`, after a text of 80 bytes."""
    nz, ny, nx = values.shape
    # The array's axes are sections, rows, columns; the original ones are z, y, x.
    stored = np.ascontiguousarray(values.transpose([3 - axis for axis in order[::-1]]))
    numbers = np.zeros(256, "<i4")
    numbers[:3], numbers[3] = stored.shape[::-1], 2
    numbers[4:7] = starts
    numbers[7:10] = nx, ny, nz
    numbers[10:16] = np.array([1.5 * nx, 2 * ny, 4 * nz, *angles], "<f4").view("<i4")
    numbers[16:19], numbers[22], numbers[23] = order, 1, 80
    for place, value in fields.get("at", {}).items():
        numbers[place] = value
    header = bytearray(numbers.tobytes())
    header[208:212], header[212:216] = b"MAP ", b"\x44\x44\x00\x00"
    return bytes(header) + b" " * 80 + stored.astype("<f4").tobytes()


@pytest.mark.parametrize("order", [(1, 2, 3), (2, 1, 3), (3, 2, 1), (2, 3, 1)])
@pytest.mark.parametrize("name", ["x.ccp4", "x.mrc", "x.map", "x.map.gz"])
def test_the_order_of_axes(tmp_path, values, order, name):
    data = ccp4(values, order)
    path = written(tmp_path / name, gzip.compress(data) if name.endswith("gz") else data)
    assert (probe(path).dims, probe(path).unit) == ((6, 5, 4), "Å")
    volume = reads(values, path)
    np.testing.assert_allclose(volume.index_to_world, np.diag([1.5, 2, 4, 1]))
    assert volume.name == "x"


def test_the_first_index_is_the_place(tmp_path, values):
    """Checks the first index, which is in the order of columns, rows and sections, here y, x, z."""
    volume = read_volume(written(tmp_path / "x.ccp4", ccp4(values, starts=(10, -3, 2))))
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [-4.5, 20, 8])


def test_a_cell_of_other_angles(tmp_path, values):
    path = written(tmp_path / "x.ccp4", ccp4(values, angles=(80, 95, 120)))
    axes = read_volume(path).index_to_world[:3, :3]
    np.testing.assert_allclose(np.linalg.norm(axes, axis=0), [1.5, 2, 4], rtol=1e-6)
    a, b, c = (axes / np.linalg.norm(axes, axis=0)).T
    np.testing.assert_allclose(np.degrees(np.arccos([b @ c, a @ c, a @ b])), [80, 95, 120])
    np.testing.assert_allclose(a, [1, 0, 0], atol=1e-12)


def test_a_stack_of_volumes_has_frames(tmp_path, values):
    data = ccp4(np.concatenate([values, values + 1]), (1, 2, 3), at={9: 4, 22: 401})
    (tmp_path / "x.mrc").write_bytes(data)
    assert probe(tmp_path / "x.mrc").frames == 2
    reads(values + 1, tmp_path / "x.mrc", frame=1)


def of_bytes(values, order="<", stats=(0, -1), **words):
    """Writes a map of bytes with the given numbers in its header; stats: lowest, highest."""
    numbers = np.frombuffer(ccp4(values)[:1024], "<i4").copy()
    numbers[3], numbers[23] = 0, 0
    numbers[19:21] = np.array(stats, "<f4").view("<i4")
    for place, value in words.get("at", {}).items():
        numbers[place] = value
    header = bytearray(numbers.astype(f"{order}i4").tobytes())
    header[208:212], header[212:216] = b"MAP ", b"\x44\x44\0\0" if order == "<" else b"\x11\x11\0\0"
    return bytes(header) + values.transpose(0, 2, 1).tobytes()


IMOD, FLAGS, VERSION = 38, 39, 27
STAMP = 1146047817
# Values around 0, or around the middle, clipped at the ends.
SIGNED = np.clip(np.random.default_rng(1).normal(0, 60, (4, 5, 6)), -128, 127).astype(np.int8)
UNSIGNED = (SIGNED.astype(int) + 128).astype(np.uint8)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("gz", [False, True])
def test_bytes_by_the_stamp_of_imod(tmp_path, order, signed, gz):
    """Checks that IMOD's stamp decides, whatever the header and the values are."""
    values = (UNSIGNED if signed else SIGNED).view(np.int8 if signed else np.uint8)
    words = {IMOD: STAMP, FLAGS: 4 + signed, VERSION: 20140}
    data = of_bytes(values, order, (0, 200) if signed else (-100, 100), at=words)
    path = written(tmp_path / ("x.rec.gz" if gz else "x.rec"), gzip.compress(data) if gz else data)
    volume = reads(values, path)
    assert volume.notes == () and probe(path).dtype == values.dtype


@pytest.mark.parametrize(
    "values, stats, version, note",
    [
        (SIGNED, (-128, 127), 0, ""),
        (UNSIGNED, (0, 255), 0, ""),
        (UNSIGNED, (0, 255), 20141, ""),
        (SIGNED, (0, -1), 20141, ""),
        (SIGNED, (0, 0), 0, "read as -128 to 127"),
        (UNSIGNED, (0, 0), 0, "read as 0 to 255"),
        (np.where(UNSIGNED > 99, 255, 0).astype(np.uint8), (np.nan, np.inf), 0, "0 to 255"),
    ],
)
def test_bytes_without_the_stamp(tmp_path, values, stats, version, note):
    """Checks the sign by limits of the values, version of the standard, or histogram."""
    path = written(tmp_path / "x.mrc", of_bytes(values, "<", stats, at={VERSION: version}))
    volume = reads(values, path)
    assert note in " ".join(volume.notes) and bool(note) == bool(volume.notes)


def test_bytes_of_mrcfile(tmp_path):
    import mrcfile

    with mrcfile.new(tmp_path / "x.mrc") as file:
        file.set_data(SIGNED)
    reads(SIGNED, tmp_path / "x.mrc")


def test_bytes_of_simpleitk(tmp_path):
    itk = pytest.importorskip("SimpleITK")
    itk.WriteImage(itk.GetImageFromArray(UNSIGNED), str(tmp_path / "x.mrc"))
    reads(UNSIGNED, tmp_path / "x.mrc")


def test_halves_of_bytes_are_refused(tmp_path):
    path = written(tmp_path / "x.mrc", of_bytes(UNSIGNED, at={3: 101}))
    refused("four bits", read_volume, path)


@pytest.mark.parametrize("name", ["x.mrcs", "x.st"])
def test_stacks_of_images(tmp_path, name):
    import mrcfile

    with mrcfile.new(tmp_path / "x.mrc") as file:
        file.set_data(SIGNED)
        file.set_image_stack()
    (tmp_path / "x.mrc").rename(tmp_path / name)
    volume = reads(SIGNED, tmp_path / name)
    assert "z counts the images" in volume.notes[0]


def test_a_packed_map_of_a_plain_name(tmp_path, values):
    reads(values, written(tmp_path / "x.map", gzip.compress(ccp4(values))))
    reads(values, written(tmp_path / "x.map.gz", ccp4(values)))


def test_the_stamp_of_the_other_byte_order(tmp_path, values):
    """Checks the wrong byte order in the stamp, for which mrcfile uses the mode instead."""
    data = ccp4(values)
    head = np.frombuffer(data[:224], "<i4").byteswap().tobytes()
    stored = np.frombuffer(data[1104:], "<f4").byteswap().tobytes()
    path = tmp_path / "x.ccp4"
    reads(values, written(path, head[:208] + data[208:216] + head[216:] + data[224:1104] + stored))


@pytest.mark.parametrize("length", [2**30, -80])
def test_the_length_of_the_text_is_not_believed(tmp_path, values, length):
    path = tmp_path / "x.ccp4"
    peaks = []
    for order in ("<i4", ">i4"):
        data = bytearray(ccp4(values, at={23: length}))
        if order == ">i4":
            data[:208] = np.frombuffer(bytes(data[:208]), "<i4").byteswap().tobytes()
        path.write_bytes(data)
        tracemalloc.start()
        refused("x.ccp4: .*damaged", read_volume, path)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert max(peaks) < 2**24


def test_damaged_maps(tmp_path, values):
    path = tmp_path / "x.ccp4"
    for broken, sentence in (
        (ccp4(values)[:-1], "claims"),
        (ccp4(values, at={0: 2**30, 1: 2**30}), "claims"),
        (ccp4(values, at={3: 4}), "complex"),
        (b"no map" * 400, "MRC or CCP4"),
        (b"no map", "damaged|readable"),
        (b"", "damaged|readable"),
    ):
        refused(f"x.ccp4: .*({sentence})", read_volume, written(path, broken))


@pytest.mark.parametrize(
    "words, sign", [({}, -1), ({FLAGS: 4}, 1), ({VERSION: 20140}, 1), ({IMOD: 0}, 1)]
)
def test_the_sign_of_the_origin_by_imod(tmp_path, values, words, sign):
    places = np.array([3.0, -2.0, 1.0], "<f4")
    origin = dict(zip((49, 50, 51), places.view("<i4")))
    path = written(tmp_path / "x.mrc", ccp4(values, at={IMOD: STAMP, **words, **origin}))
    np.testing.assert_array_equal(read_volume(path).index_to_world[:3, 3], sign * places)
