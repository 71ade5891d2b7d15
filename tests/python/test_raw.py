# SPDX-License-Identifier: GPL-3.0-or-later
"""Raw files of every type, order and size."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from leaflight import LeaflightError, read_volume
from leaflight.io.readers.raw import ENDIANS, TYPES


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
            with pytest.raises(LeaflightError, match="field.raw"):
                read_volume(path, **arguments)
        else:
            volume = read_volume(path, spacing=0.5, **arguments)
            np.testing.assert_array_equal(volume.values, values.astype(np.float32))
            np.testing.assert_array_equal(volume.index_to_world, np.diag([0.5, 0.5, 0.5, 1]))


@given(
    dims=st.tuples(*[st.integers(-(2**40), 2**40)] * 3),
    type=st.sampled_from(TYPES),
    size=st.integers(0, 64),
)
def test_no_claim_allocates_or_crashes(dims, type, size):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "field.raw"
        path.write_bytes(bytes(size))
        with pytest.raises(LeaflightError, match="field.raw"):
            read_volume(path, dims=dims, type=type)
