# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests DICOM series: slices are sorted by their position in the patient."""

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused

pydicom = pytest.importorskip("pydicom")
from dicom_files import write_series, write_slice  # noqa: E402
from pydicom.uid import generate_uid  # noqa: E402


@pytest.fixture
def folder(tmp_path, values):
    """Writes four slices, 2 mm apart, whose names and numbers do not show their order."""
    folder = tmp_path / "scan"
    folder.mkdir()
    for k, name in enumerate("cadb"):
        write_slice(folder / name, values[k], 100 + 2 * k, InstanceNumber=7 - k)
    (folder / "README").write_text("no slice")
    return folder


def test_values_and_place(folder, values):
    stored = probe(folder)
    assert (stored.dims, stored.voxel_size, stored.unit) == ((6, 5, 4), (0.25, 0.5, 2.0), "mm")
    assert stored.patient
    volume = reads(2 * values - 1000, folder)
    # DICOM's axes are left, posterior, superior; ours are right, anterior, superior.
    expected = np.diag([-0.25, -0.5, 2, 1])
    expected[:3, 3] = -10, -20, 100
    np.testing.assert_allclose(volume.index_to_world, expected)
    assert volume.name == "scan"


def test_one_of_its_files_stands_for_the_series(folder, values):
    reads(2 * values - 1000, folder / "a")


def test_hounsfield_units_stay_integers(tmp_path, values):
    write_series(tmp_path, values, 1.0, RescaleIntercept=-1024, BitsStored=12)
    volume = reads(values - 1024, tmp_path / "IM0000")
    assert volume.values.dtype == np.int16 and probe(tmp_path).dtype == np.int16


def test_slices_across_the_patient(tmp_path, values):
    """Checks coronal slices: columns run down, and slices from front to back."""
    tags = {"ImageOrientationPatient": [1, 0, 0, 0, 0, -1]}
    write_series(tmp_path, values, ImagePositionPatient=lambda k: [0, 2 * k, 50], **tags)
    volume = reads(values, tmp_path)
    # Our axes: x to the right, y to the front, z up.
    np.testing.assert_allclose(volume.index_to_world @ [1, 0, 0, 1], [-0.25, 0, 50, 1])
    np.testing.assert_allclose(volume.index_to_world @ [0, 1, 0, 1], [0, 0, 49.5, 1])
    np.testing.assert_allclose(volume.index_to_world @ [0, 0, 1, 1], [0, -2, 50, 1])


def test_times_are_frames(folder, values):
    for k in range(4):
        write_slice(folder / f"later{k}", values[k] + 1, 100 + 2 * k, InstanceNumber=20 + k)
    assert probe(folder).frames == 2
    reads(2 * values - 998, folder, frame=1)


def test_several_series_are_chosen_by_name(folder, values):
    other = generate_uid(entropy_srcs=["other"])
    tags = {"series": other, "SeriesNumber": 4, "SeriesDescription": "Neck"}
    write_series(folder, values + 5, **tags)
    assert set(probe(folder).datasets) == {"3 Head CT", "4 Neck CT"}
    reads(values + 5, folder, dataset="4 Neck CT")
    reads(2 * values - 1000, folder / "a")
    refused("2 volumes; choose one of .*4 Neck CT", read_volume, folder)


def test_values_beyond_sixteen_bits(tmp_path, values):
    pixels = values.copy()
    pixels[2] += 60000
    volume = reads(pixels - 1024, write_series(tmp_path, pixels, RescaleIntercept=-1024))
    assert volume.values.dtype == np.float32


def test_damaged(folder, values):
    (folder / "d").unlink()
    refused("2 to 4 mm apart.* missing", read_volume, folder)
    write_slice(folder / "d", values[2, :-1], 104)
    refused("missing; .*1 slice of another size .* is left out", read_volume, folder)
    write_slice(folder / "d", values[2], 104)
    whole = (folder / "d").read_bytes()
    (folder / "d").write_bytes(whole[:-20])
    refused("damaged|truncated|claims", read_volume, folder)
    write_slice(folder / "d", values[2], 104, SamplesPerPixel=3)
    refused("colors", read_volume, folder / "d")


@pytest.mark.parametrize("apart", [1e-6, 0.001, 0.0065, 0.02, 25.0])
def test_slices_of_any_distance(tmp_path, values, apart):
    folder = write_series(tmp_path / "scan", values, apart, PixelSpacing=[apart, apart])
    volume = reads(values, folder)
    np.testing.assert_allclose(np.diag(volume.index_to_world), [-apart, -apart, apart, 1])
    (folder / "IM0001").unlink()
    refused("mm apart.* missing", read_volume, folder)


def test_places_that_are_rounded(tmp_path, values):
    """Checks positions of 0.0625 mm that are rounded, and times that differ in the last digit."""
    for k, place in enumerate([0, 0.06, 0.13, 0.19]):
        write_slice(tmp_path / f"{k}", values[k], place, InstanceNumber=k)
        write_slice(tmp_path / f"{k} later", values[k], place + 1e-5, InstanceNumber=10 + k)
    stored = probe(tmp_path)
    assert stored.frames == 2
    np.testing.assert_allclose(stored.voxel_size, (0.25, 0.5, 0.19 / 3))


def test_axes_that_differ_in_their_last_digits(tmp_path, values):
    def axes(k):
        return [0.9995 + 2e-7 * k, 0.0316176, 0, -0.0316176, 0.9995 - 2e-7 * k, 0]

    reads(values, write_series(tmp_path, values, ImageOrientationPatient=axes))


def test_a_tilted_gantry(tmp_path, values):
    axes = [1, 0, 0, 0, 0.9397, -0.342]
    write_series(tmp_path, values, ImageOrientationPatient=axes)
    matrix = read_volume(tmp_path).index_to_world
    np.testing.assert_allclose(matrix[:3, 2], [0, 0, 2], atol=1e-9)
    np.testing.assert_allclose(matrix[:3, 1], [0, -0.46985, -0.171], atol=1e-9)


def test_slices_beside_each_other(tmp_path, values):
    write_series(tmp_path, values, 1.0, ImagePositionPatient=lambda k: [50 * (k == 2), 0, k])
    refused("50 mm off", read_volume, tmp_path)
    write_series(tmp_path, values, 1.0)
    for k in range(4):
        place = {"ImagePositionPatient": [60, 20, k], "InstanceNumber": 10 + k}
        write_slice(tmp_path / f"{k} aside", values[k], k, RescaleIntercept=0, **place)
    refused("50 mm off", read_volume, tmp_path)


def test_a_slice_that_is_there_twice(folder, values):
    (folder / "copy of a").write_bytes((folder / "a").read_bytes())
    # Add a copy with other identifiers, like a second anonymization.
    write_slice(folder / "e", values[0], 100, InstanceNumber=50)
    volume = reads(2 * values - 1000, folder)
    assert volume.notes[0].startswith("2 slices are stored twice") and len(volume.notes) == 1
    write_slice(folder / "e", values[0] + 1, 100, InstanceNumber=50)
    refused("1 to 2 different slices", read_volume, folder)


def test_a_series_that_is_there_twice(folder, values):
    for k, name in enumerate("cadb"):
        (folder / f"copy of {name}").write_bytes((folder / name).read_bytes())
    stored = probe(folder)
    assert stored.frames == 1 and "4 slices are stored twice" in stored.notes[0]


def test_times_with_blank_slices_are_no_copies(tmp_path, values):
    for k in range(4):
        for time in range(3):
            pixels = values[k] * 0 if k in (0, 3) else values[k] + time
            write_slice(tmp_path / f"{k} {time}", pixels, k, InstanceNumber=4 * time + k)
    assert probe(tmp_path).frames == 3 and probe(tmp_path).notes == ()
    np.testing.assert_array_equal(read_volume(tmp_path, frame=2).values[1:3], 2 * values[1:3] - 996)


def test_each_slice_has_its_own_slope(tmp_path, values):
    """Checks slopes as in a PET scan against pydicom's pixel_array."""
    write_series(tmp_path, values, RescaleSlope=lambda k: 0.5 + k)
    reads(values * (0.5 + np.arange(4)[:, None, None]), tmp_path)
    own = pydicom.dcmread(tmp_path / "IM0002")
    np.testing.assert_array_equal(own.pixel_array * own.RescaleSlope, values[2] * 2.5)


def test_a_localizer_in_the_series(folder, values):
    write_slice(folder / "scout", values[0], 0, ImageOrientationPatient=[0, 1, 0, 0, 0, -1])
    write_slice(folder / "small", values[0, :-1], 104)
    volume = reads(2 * values - 1000, folder)
    assert len(volume.notes) == 1 and "2 slices of other sizes or directions" in volume.notes[0]


def test_directions_of_a_series_are_volumes(folder, values):
    axes = [0, 1, 0, 0, 0, -1]
    for k in range(3):
        place = [3 * k, 0, 0]
        tags = {"ImagePositionPatient": place, "ImageOrientationPatient": axes}
        write_slice(folder / f"side {k}", values[k] + 1, 0, InstanceNumber=20 + k, **tags)
    assert probe(folder).datasets == ("axial", "sagittal")
    reads(2 * values - 1000, folder, dataset="axial")
    side = read_volume(folder, dataset="sagittal")
    # The normal of sagittal planes points against their order.
    np.testing.assert_array_equal(side.values, (2 * values - 998)[:3][::-1])


def test_slices_without_a_place(tmp_path, values):
    folder = write_series(tmp_path / "scan", values, ImagePositionPatient=None)
    volume = read_volume(folder)
    assert not volume.patient and volume.notes == (
        "The headers have no positions of the slices; they are sorted by number, 3 mm apart.",
    )
    places = {"ImagePositionPatient": None, "SliceLocation": lambda k: 9 - 4.5 * k}
    volume = reads(values[::-1], write_series(folder, values, **places))
    assert volume.spacing[2] == 4.5


def test_low_values_that_are_bright(tmp_path, values):
    folder = write_series(tmp_path / "scan", values, PhotometricInterpretation="MONOCHROME1")
    volume = reads(values, folder)
    assert "MONOCHROME1" in volume.notes[0]
