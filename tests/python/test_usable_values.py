# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests fill values, values far from 0, and that real data stay."""

import itertools

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight import read_volume
from leaflight.volume.fill_values import common_offset, occurring

N = 16
Z, Y, X = np.mgrid[:N, :N, :N] - 0.5 * (N - 1)
BODY = np.exp(-(X**2 + Y**2 + Z**2) / 40)
LAND = Z > 4


def read(tmp_path, values, **options):
    np.save(tmp_path / "x.npy", values)
    return read_volume(tmp_path / "x.npy", **options)


@pytest.mark.parametrize(
    "fill, low, high, kind",
    [
        (1e20, 0, 1, np.float32),
        (9.969209968386869e36, 250, 310, np.float32),
        (-9.99e8, 0, 1, np.float32),
        (np.finfo(np.float32).max, -5, 5, np.float32),
        (-3.4e38, -5, 5, np.float32),
        (np.finfo(np.float64).max, 0, 1, np.float64),
        (1e30, -3, 900, np.float64),
        (-9999, 0, 4800, np.float32),
        (9999, -40, 40, np.float32),
        (-999.25, 0, 150, np.float64),
        (-999, 0, 300, np.int16),
        (-32768, -1024, 3071, np.int16),
        (-32767, 0, 500, np.int16),
        (-32768, 0, 900, np.float32),
        (65535, 0, 4095, np.uint16),
        (-(2**31), 0, 70000, np.int32),
        (2**64 - 1, 0, 70000, np.uint64),
    ],
)
def test_fill_values_are_missing_data(tmp_path, fill, low, high, kind):
    values = (low + (high - low) * BODY).astype(kind)
    values[LAND] = fill
    volume = read(tmp_path, values)
    assert volume.values.dtype == np.float32
    np.testing.assert_array_equal(np.isnan(volume.values), LAND)
    np.testing.assert_allclose(volume.values[~LAND], values[~LAND].astype(np.float32), rtol=1e-6)
    (note,) = volume.notes
    assert note.startswith("25 % of the voxels are ") and "read as missing data" in note
    lo, hi = volume.field().range
    assert low - 1 <= lo < hi <= high + 1
    # Means must ignore fill values.
    for options in ({"downsample": 2}, {"smooth": 1.0}):
        part = read(tmp_path, values, **options)
        lo, hi = part.field().range
        assert low - 1 <= lo < hi <= high + 1 and part.notes == volume.notes


def test_both_ends_may_be_fill_values():
    values = BODY.astype(np.float32)
    values[LAND], values[:2] = 1e20, -9999
    found = occurring(values)
    assert found.fills == {float(np.float32(1e20)): LAND.sum(), -9999.0: 2 * N * N}
    assert (found.low, found.high) == (BODY[2:12].astype(np.float32).min(), np.float32(BODY.max()))


REAL = {
    "a mask": np.where(LAND, -9999.0, 1.0),
    "a mask of 16 bits": np.where(LAND, 65535, 0).astype(np.uint16),
    "the ends of a type": np.where(LAND, 32767, -32768).astype(np.int16),
    "a saturated object": (80000 * BODY).clip(0, 65535).astype(np.uint16),
    "metal in a scan": np.where(BODY > 0.9, 32767, 3000 * BODY - 1000).astype(np.int16),
    "hot pixels": np.where((X == 0.5) & (Y == Z), 65535, 900 * BODY).astype(np.uint16),
    "labels": np.where(LAND, 999, (BODY > 0.2) * 1 + (BODY > 0.5)).astype(np.int32),
    "counts": np.where(LAND, -9999, 70000 * BODY).astype(np.int32),
    "depths of the sea": np.where(BODY > 0.3, -9999, 8000 * BODY - 10900).astype(np.float32),
    "heights about -999": np.where(LAND, -999, -1200 * BODY - 10).astype(np.float32),
    "a power of ten": np.where(LAND, 1000, BODY).astype(np.float32),
    "a background of 0": np.where(LAND, 0, 300 + BODY),
    "Hounsfield units": np.where(LAND, -1000, 60 * BODY),
    "few large values": np.where(BODY > 0.9, 1e20 * BODY, BODY),
}


@pytest.mark.parametrize("name", REAL)
def test_real_values_stay(tmp_path, name):
    values = REAL[name]
    if name in ("metal in a scan", "hot pixels"):
        # Make the outliers rare: 0.1 % of the voxels or less.
        values = np.repeat(values[:, :, :1], 5 * N, axis=2).astype(values.dtype)
        values[..., -1] = REAL[name][..., N // 2]
    read_again = read(tmp_path, values).values
    np.testing.assert_array_equal(read_again, values.astype(np.float32))


TAILS = {
    "normal": lambda rng, n: rng.normal(0, 1, n),
    "Cauchy": lambda rng, n: rng.standard_cauchy(n),
    "log-normal": lambda rng, n: rng.lognormal(0, 4, n),
    "Pareto": lambda rng, n: rng.pareto(0.3, n),
    "t": lambda rng, n: rng.standard_t(0.5, n),
}


@pytest.mark.parametrize("name", TAILS)
@pytest.mark.parametrize("kind", [np.float32, np.int16, np.uint16, np.int32])
def test_heavy_tails_stay(name, kind):
    """Checks that outliers, saturated at the limits of a type, are not mistaken for fill values."""
    for seed, scale in itertools.product(range(12), (1, 100, 10000)):
        with np.errstate(over="ignore"):
            values = scale * TAILS[name](np.random.default_rng(seed), N**3)
        if kind is not np.float32:
            limits = np.iinfo(kind)
            values = np.rint(values).clip(limits.min, limits.max)
        assert not occurring(values.astype(kind).reshape(N, -1)).fills


def test_a_header_may_name_any_fill_value():
    values = np.where(LAND, -1, 100 + BODY).astype(np.float32)
    assert not occurring(values).fills
    assert occurring(values, (-1.0,)).fills == {-1.0: LAND.sum()}
    # A value among others is not a fill value.
    assert not occurring(np.where(LAND, 0, BODY), (0.0,)).fills
    assert not occurring(np.where(LAND, 1, (BODY > 0.5) * 2), (0.0,)).fills
    assert occurring(np.where(LAND, -127, 9 * BODY).astype(np.int8), (-127,)).fills


def test_fill_values_of_other_readers(tmp_path):
    values = (1000 * BODY).astype(np.int16)
    values[LAND] = -32768
    nibabel.save(nibabel.Nifti1Image(values.T, np.eye(4)), tmp_path / "x.nii.gz")
    np.savez(tmp_path / "x.npz", h=values.astype(np.float32))
    values.tofile(tmp_path / "x.raw")
    layout = {"dims": (N, N, N), "type": "int16"}
    for name, options in (("x.nii.gz", {}), ("x.npz", {}), ("x.raw", layout)):
        volume = read_volume(tmp_path / name, **options)
        np.testing.assert_array_equal(np.isnan(volume.values), LAND)
        assert len(volume.notes) == 1


@pytest.mark.parametrize(
    "low, high, kind, offset",
    [
        (101325.0, 101325.01, np.float64, 101325.0),
        (293.1504, 293.1508, np.float64, 293.15),
        (-5000.002, -5000.001, np.float64, -5000.002),
        (1e9, 1e9 + 300, np.float64, 1e9),
        (5_000_001, 5_000_003, np.int32, 5_000_000),
        (-70_000_003, -70_000_001, np.int32, -70_000_010),
        (4_294_967_290, 4_294_967_293, np.uint32, 4_294_967_290),
        (2**53, 2**53 + 3, np.int64, 9_007_199_254_740_990),
        (2**63, 2**63 + 40, np.uint64, 9_223_372_036_854_775_800),
        (16_000_000, 16_000_003, np.float32, 16_000_000.0),
        # These values need no offset.
        (1_000_000, 1_000_003, np.int32, 0),
        (101325.0, 101425.0, np.float32, 0),
        (0.0, 1.0, np.float64, 0),
        (250.0, 310.0, np.float64, 0),
        (-1.0, 1e-9, np.float64, 0),
        (0, 2**60, np.uint64, 0),
    ],
)
def test_values_far_from_0_keep_their_differences(tmp_path, low, high, kind, offset):
    if np.dtype(kind).kind == "f":
        values = (low + (high - low) * (BODY - BODY.min()) / np.ptp(BODY)).astype(kind)
    else:
        values = (np.rint((high - low) * BODY).astype(kind) + np.asarray(low).astype(kind)).astype(
            kind
        )
    assert common_offset(values.min().item(), values.max().item(), values.dtype) == offset
    volume = read(tmp_path, values)
    less = (values - np.asarray(offset).astype(kind)).astype(np.float64)
    rounding = np.spacing(np.abs(np.float32(less)).max()) + np.spacing(float(abs(high)))
    np.testing.assert_allclose(volume.values, less, rtol=0, atol=rounding)
    lo, hi = leaflight.default_isovalue_range(volume)
    assert lo < leaflight.default_isovalue(volume) < hi
    text = f" less {offset:.15g}"
    # Name and source must mention the offset, also after other operations.
    assert (volume.name == f"x{text}") == (offset != 0) == (f", {text[1:]}" in volume.source)
    assert offset == 0 or f": {text[6:]} is subtracted from them" in volume.notes[0]
    for options in ({"downsample": 2}, {"smooth": 1.0}):
        part = read(tmp_path, values, **options)
        assert part.name == volume.name
        assert np.abs(part.values).max() <= np.abs(volume.values).max() + rounding


@pytest.mark.parametrize("name", ["x.nii", "x.nc", "x.mif", "x"])
def test_scaled_numbers_far_from_0_keep_their_differences(tmp_path, name):
    counts = np.rint(1000 * BODY).astype("<i2")
    path = tmp_path / name
    if name == "x.nii":
        image = nibabel.Nifti1Image(counts.T, np.eye(4))
        image.header.set_slope_inter(1e-5, 101325)
        nibabel.save(image, path)
    elif name == "x.nc":
        with pytest.importorskip("scipy.io").netcdf_file(path, "w") as file:
            for axis in "zyx":
                file.createDimension(axis, N)
            data = file.createVariable("p", "i2", ("z", "y", "x"))
            data[:], data.scale_factor, data.add_offset = counts, 1e-5, 101325.0
    elif name == "x.mif":
        text = f"mrtrix image\ndim: {N},{N},{N}\nvox: 1,1,1\nlayout: +0,+1,+2\ndatatype: Int16LE\n"
        text = f"{text}scaling: 101325,0.00001\nfile: . 200\nEND\n"
        path.write_bytes(text.encode().ljust(200) + counts.tobytes())
    else:
        from dicom_files import write_series

        scale = {"RescaleSlope": 1e-5, "RescaleIntercept": 101325}
        write_series(path, counts, **scale)
    np.testing.assert_allclose(read_volume(path).values, 1e-5 * counts, atol=1e-7)


def test_an_offset_is_kept_by_a_bake_and_told_by_info(cli, tmp_path):
    np.save(tmp_path / "p.npy", 101325.0 + 0.01 * BODY)
    info = cli("info", tmp_path / "p.npy")
    assert "p.npy, less 101325: 16 x 16 x 16 voxels" in info.out
    assert "The values 101325.00015..101325.00981 differ too little for single prec" in info.out
    bake = ("bake", tmp_path / "p.npy", "--error", 50, "--resolution", 8)
    done = cli(*bake, "--out", tmp_path / "p.vdb")
    assert done.status == 0 and "101325 is subtracted from them and from isovalues." in done.err
    loaded = leaflight.load_bake(tmp_path / "p.vdb")
    assert loaded.volume.name == "p less 101325"


def test_fill_values_do_not_hide_small_differences(tmp_path):
    values = 101325.0 + 0.01 * BODY
    values[LAND] = 1e20
    volume = read(tmp_path, values)
    np.testing.assert_array_equal(np.isnan(volume.values), LAND)
    assert np.nanmax(volume.values) == pytest.approx(0.01 * BODY.max(), rel=1e-6)
    assert len(volume.notes) == 2


def test_labels_are_proposed_to_be_smoothed(tmp_path):
    labels = ((BODY > 0.2) * 1 + (BODY > 0.5)).astype(np.uint8)
    for values, kind in ((labels, "3 different values, like labels"), (labels > 0, "like a mask")):
        (note,) = read(tmp_path, values).notes
        assert kind in note and "Smooth (--smooth 1)" in note
        assert read(tmp_path, values, smooth=1).notes == ()
    assert read(tmp_path, BODY).notes == ()
    assert read(tmp_path, (255 * BODY).astype(np.uint8)).notes == ()
    far = np.where(labels > 0, 10**12 + labels.astype(np.int64), 0)
    assert "neighboring numbers may have become equal" in read(tmp_path, far).notes[1]


def test_figures_tell_values_apart(cli, tmp_path):
    np.save(tmp_path / "x.npy", (1_000_000 + (BODY > 0.2) * 1 + (BODY > 0.5)).astype(np.int32))
    out = cli("info", tmp_path / "x.npy").out
    assert "values 1000000..1000002; by default isovalues 1000000..1000002 are baked and " in out
    assert "1000000.5 is shown" in out
