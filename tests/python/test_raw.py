# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests raw files of every type, byte order and size."""

import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from leaflight import read_volume
from leaflight.io.readers import format_of
from leaflight.io.readers.raw import ENDIANS, TYPES
from outcomes import reads, refused, written


@st.composite
def layouts(draw):
    type, endian = draw(st.sampled_from(TYPES)), draw(st.sampled_from(sorted(ENDIANS)))
    dtype = np.dtype(type).newbyteorder(ENDIANS[endian])
    shape = draw(npst.array_shapes(min_dims=3, max_dims=3, min_side=2, max_side=7))
    largest = 2**24 if dtype.itemsize > 2 else np.iinfo(dtype).max
    elements = (
        st.integers(0, int(largest)) if dtype.kind in "iu" else st.floats(-1e6, 1e6, width=32)
    )
    return type, endian, draw(npst.arrays(dtype, shape, elements=elements))


@given(layouts())
def test_round_trip(layout):
    type, endian, values = layout
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "field.raw"
        values.tofile(path)
        arguments = {"dims": values.shape[::-1], "type": type, "endian": endian}
        if values.min() == values.max():
            refused("field.raw", read_volume, path, **arguments)
        else:
            volume = read_volume(path, spacing=0.5, **arguments)
            exact = values.astype(np.float64)
            offset = exact.flat[0] - volume.values.flat[0]
            if offset != 0:
                # Values close to each other and far from 0 are read with an offset.
                assert volume.notes and abs(offset) > 31 * np.ptp(exact)
                atol = 1e-6 * np.ptp(exact)
                np.testing.assert_allclose(volume.values, exact - offset, rtol=0, atol=atol)
            else:
                np.testing.assert_array_equal(volume.values, values.astype(np.float32))
            np.testing.assert_array_equal(volume.index_to_world, np.diag([0.5, 0.5, 0.5, 1]))


@given(
    dims=st.tuples(*[st.integers(-(2**40), 2**40)] * 3),
    type=st.sampled_from(TYPES),
    size=st.integers(0, 64),
)
def test_no_claim_allocates_or_crashes(dims, type, size):
    with tempfile.TemporaryDirectory() as folder:
        path = written(Path(folder) / "field.raw", bytes(size))
        refused("field.raw", read_volume, path, dims=dims, type=type)


@pytest.mark.parametrize("name", "x.vol x.bin x.dat x.raw x x.xyz x.nii x.img".split())
@pytest.mark.parametrize("skip", [0, 13, -1])
def test_headers_of_any_file(tmp_path, cli, values, name, skip):
    """Checks that the suffix does not count if the dimensions and the type are given."""
    values = values.astype(">i2")
    path = written(tmp_path / name, bytes(range(13 if skip else 0)) + values.tobytes())
    options = {"dims": (6, 5, 4), "type": "int16", "endian": "big", "skip": skip}
    volume = reads(values, path, **options)
    assert volume.name == "x"
    flags = ("--dims", 6, 5, 4, "--type", "int16", "--endian", "big", "--skip", skip)
    assert "6 x 5 x 4 voxels" in cli.runs("info", path, *flags)


@pytest.mark.parametrize(
    "skip, size, sentence",
    [
        (0, 133, r"133: 13 .*\(--dims, --type, --skip\)"),
        (13, 140, r"127 behind the 13 .*7 more"),
        (13, 132, r"120 bytes.* 119 .*13.*type \(--dims, --type, --sk"),
        (500, 133, r"0 behind the 500"),
        (-1, 119, r"120 bytes.* 119;.*type \(--dims, --type\)"),
        (-2, 120, r"-2; .*\(--skip\)"),
    ],
)
def test_headers_that_do_not_fit(tmp_path, cli, skip, size, sentence):
    path = written(tmp_path / "x.dat", bytes(size))
    outcome = cli("info", path, "--dims", 6, 5, 4, "--type", "uint8", "--skip", skip)
    assert outcome.status == 2 and re.search(sentence, outcome.err), outcome.err


def test_dicom_of_any_suffix_is_no_raw_file(tmp_path):
    for name in ("x.dat", "x.xyz"):
        (tmp_path / name).write_bytes(bytes(128) + b"DICM" + bytes(99))
        assert format_of(tmp_path / name).module == "dicom"
    refused(".vol .* no header", read_volume, written(tmp_path / "x.vol", bytes(9)))
