# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests MRtrix: any order and direction of axes, bits, scaled values, values in other files."""

import gzip
import itertools
import shutil
import subprocess

import nibabel
import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

TURN = np.array([[0.0, -1, 0, 90], [1, 0, 0, -126], [0, 0, 1, -72]])
MATRIX = np.array([[0, -2, 0, 90], [1.5, 0, 0, -126], [0, 0, 3, -72], [0, 0, 0, 1]])


def header(dims=(6, 5, 4), layout="+0,+1,+2", kind="Int16LE", file=". 500", *more):
    rows = [f"transform: {', '.join(map(str, row))}" for row in TURN]
    lines = ["mrtrix image", f"dim: {','.join(map(str, dims))}", "vox: 1.5,2,3,nan"]
    lines += [f"layout: {layout}", f"datatype: {kind}", *rows, "comments: a: b", *more]
    return "\n".join([*lines, f"file: {file}", "END\n"]).encode()


def laid_out(values, layout):
    """Returns the bytes of an array [x, y, z, ...] in a layout, by MRtrix's definition."""
    words = layout.split(",")
    for axis, word in enumerate(words):
        values = np.flip(values, axis) if word[0] == "-" else values
    ranks = [int(word[1:]) for word in words]
    slowest_first = sorted(range(len(ranks)), key=lambda axis: -ranks[axis])
    return np.ascontiguousarray(values.transpose(slowest_first)).tobytes()


LAYOUTS = [
    ",".join(f"{'+-'[sign >> i & 1]}{rank}" for i, rank in enumerate(ranks))
    for sign, ranks in zip(range(6), itertools.permutations(range(3)))
]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", ["x.mif", "x.mif.gz"])
@pytest.mark.parametrize("kind, dtype", [("Int16LE", "<i2"), ("Float32BE", ">f4"), ("UInt8", "u1")])
def test_layouts(tmp_path, values, layout, name, kind, dtype):
    data = header((6, 5, 4), layout, kind).ljust(500) + laid_out(values.T.astype(dtype), layout)
    path = written(tmp_path / name, gzip.compress(data) if name.endswith("gz") else data)
    volume = reads(values, path)
    np.testing.assert_allclose(volume.index_to_world, MATRIX)
    assert volume.unit == "mm" and volume.patient and volume.name == "x"


def test_a_sixth_axis_has_one_place(tmp_path, values):
    for count in (1, 2):
        sizes, layout = (6, 5, 4, 1, 1, count), "+0,+1,+2,+3,+4,+5"
        data = np.stack([values.T] * count, -1).reshape(sizes).astype("<i2")
        start = header(sizes, layout).ljust(500)
        path = written(tmp_path / "x.mif", start + laid_out(data, layout))
        if count == 1:
            reads(values, path)
    refused("shape 6 x 5 x 4 x 1 x 1 x 2", read_volume, path)


@pytest.mark.parametrize("layout", ["+0,+1,+2,+3", "+1,-2,+3,+0", "-3,+2,-1,-0"])
@pytest.mark.parametrize("pack", [bytes, gzip.compress])
def test_frames(tmp_path, values, layout, pack):
    frames = np.stack([values.T + i for i in range(3)], -1).astype("<i2")
    data = header((6, 5, 4, 3), layout).ljust(500) + laid_out(frames, layout)
    (tmp_path / "x.mif").write_bytes(pack(data))
    assert probe(tmp_path / "x.mif").frames == 3
    reads(values + 2, tmp_path / "x.mif", frame=2)


def test_bits(tmp_path, values):
    """Checks bits: each byte has eight of them, the first in the highest place."""
    bits = np.stack([values > 50, values > 70])
    data = header((6, 5, 4, 2), "+0,+1,+2,+3", "Bit").ljust(500) + np.packbits(bits).tobytes()
    reads(bits[1], written(tmp_path / "x.mif", data), frame=1)
    refused("claims", read_volume, written(tmp_path / "x.mif", data[:-1]))


def test_scaled_values_of_another_file(tmp_path, values):
    path = tmp_path / "x.mih"
    path.write_bytes(header((6, 5, 4, 1), "+0,+1,+2,+3", "Int16LE", "x.dat", "scaling: 3,0.5"))
    (tmp_path / "x.dat").write_bytes(values.astype("<i2").tobytes())
    volume = reads(3 + 0.5 * values, path)
    assert volume.values.dtype == np.float32 == probe(path).dtype


def test_damaged(tmp_path, values):
    data = values.astype("<i2").tobytes()
    path = tmp_path / "x.mif"
    for start, sentence in (
        (header(kind="CFloat32LE"), "real number"),
        (header(kind="Float8"), "real number"),
        (header(layout="+0,+1,+1"), "layout"),
        (header(layout="+0,+1"), "layout"),
        (header(file="../x.dat 0"), "outside .* folder"),
        (header(file="x.dat 0"), "'x.dat'"),
        (header(file=""), "file of the values"),
        (header(dims=(60, 50, 40)), "60 x 50 x 40"),
        (header(dims=(6, 5)), "needs three dimensions"),
        (header().replace(b"vox: 1.5,2,3", b"vox: 0,2,3"), "not invertible"),
        (b"mrtrix tracks\n", "readable MRtrix image"),
    ):
        refused(f"x.mif: .*{sentence}", read_volume, written(path, start.ljust(500) + data))


@pytest.mark.skipif(shutil.which("mrconvert") is None, reason="MRtrix is not installed")
@pytest.mark.parametrize("strides", ["1,2,3", "-2,3,-1", "3,-1,2"])
@pytest.mark.parametrize("kind", ["int16", "float32be", "bit"])
def test_files_of_mrtrix(tmp_path, values, strides, kind):
    values = values > 60 if kind == "bit" else values
    affine = np.array([[-2.0, 0.1, 0, 90], [0, 2.5, 0, -126], [0, 0.5, 3.0, -72], [0, 0, 0, 1]])
    nibabel.save(nibabel.Nifti1Image(values.T.astype(np.float32), affine), tmp_path / "x.nii")
    options = ["-quiet", "-strides", strides, "-datatype", kind]
    files = [str(tmp_path / name) for name in ("x.nii", "x.mif")]
    subprocess.run(["mrconvert", *options, *files], check=True)
    volume = read_volume(tmp_path / "x.mif")
    # MRtrix reorders axes to right, front, up.
    np.testing.assert_array_equal(volume.values, values[:, :, ::-1])
    corner = volume.index_to_world @ [5, 0, 0, 1]
    np.testing.assert_allclose(corner, affine[:, 3], atol=1e-4)
