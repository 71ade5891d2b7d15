# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM series: slices in whatever order, sorted by where they lie in the patient."""

import numpy as np
import pytest
from leaflight import LeaflightError, read_volume
from leaflight.io.readers import probe

pydicom = pytest.importorskip("pydicom")
from pydicom.dataset import FileDataset, FileMetaDataset  # noqa: E402
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid  # noqa: E402

SERIES = generate_uid(entropy_srcs=["leaflight"])


def write_slice(path, pixels, place, series=SERIES, **tags):
    """A CT slice at the place z along the patient; its values are 2 pixels - 1000."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    # The same bytes in every run.
    meta.MediaStorageSOPInstanceUID = generate_uid(entropy_srcs=[path.name])
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    data = FileDataset(str(path), {}, file_meta=meta, preamble=b"\0" * 128)
    data.is_little_endian, data.is_implicit_VR = True, False
    data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    data.SeriesInstanceUID, data.SeriesNumber, data.Modality = series, 3, "CT"
    data.SeriesDescription, data.InstanceNumber = "Head", 1
    data.ImagePositionPatient, data.ImageOrientationPatient = [10, 20, place], [1, 0, 0, 0, 1, 0]
    data.PixelSpacing, data.SliceThickness = [0.5, 0.25], 3
    data.RescaleSlope, data.RescaleIntercept = 2, -1000
    data.Rows, data.Columns = pixels.shape[-2:]
    data.BitsAllocated = data.BitsStored = 16
    data.HighBit, data.PixelRepresentation, data.SamplesPerPixel = 15, 0, 1
    data.PhotometricInterpretation = "MONOCHROME2"
    for name, value in tags.items():
        setattr(data, name, value)
    data.PixelData = pixels.astype("<u2").tobytes()
    data.save_as(str(path), write_like_original=False)


@pytest.fixture
def folder(tmp_path, values):
    """Four slices, 2 mm apart, whose names and numbers are of no help."""
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
    volume = read_volume(folder)
    np.testing.assert_array_equal(volume.values, 2 * values - 1000)
    # DICOM's world is left-posterior-superior, ours right-anterior-superior.
    expected = np.diag([-0.25, -0.5, 2, 1])
    expected[:3, 3] = -10, -20, 100
    np.testing.assert_allclose(volume.index_to_world, expected)
    assert volume.name == "scan"


def test_one_of_its_files_stands_for_the_series(folder, values):
    np.testing.assert_array_equal(read_volume(folder / "a").values, 2 * values - 1000)


def test_hounsfield_units_stay_integers(tmp_path, values):
    for k in range(4):
        path = tmp_path / f"{k}.dcm"
        write_slice(path, values[k], k, RescaleSlope=1, RescaleIntercept=-1024, BitsStored=12)
    volume = read_volume(tmp_path / "0.dcm")
    assert volume.values.dtype == np.int16 and probe(tmp_path).dtype == np.int16
    np.testing.assert_array_equal(volume.values, values - 1024)


def test_slices_across_the_patient(tmp_path, values):
    """Coronal: columns run down, slices from front to back."""
    for k in range(4):
        axes = [1, 0, 0, 0, 0, -1]
        place = [0, 2 * k, 50]
        write_slice(
            tmp_path / str(k),
            values[k],
            0,
            ImageOrientationPatient=axes,
            ImagePositionPatient=place,
        )
    volume = read_volume(tmp_path)
    # In our world: x to the right, y to the front, z up.
    np.testing.assert_allclose(volume.index_to_world @ [1, 0, 0, 1], [-0.25, 0, 50, 1])
    np.testing.assert_allclose(volume.index_to_world @ [0, 1, 0, 1], [0, 0, 49.5, 1])
    np.testing.assert_allclose(volume.index_to_world @ [0, 0, 1, 1], [0, -2, 50, 1])
    np.testing.assert_array_equal(volume.values, 2 * values - 1000)


def test_times_are_frames(folder, values):
    for k in range(4):
        write_slice(folder / f"later{k}", values[k] + 1, 100 + 2 * k, InstanceNumber=20 + k)
    assert probe(folder).frames == 2
    np.testing.assert_array_equal(read_volume(folder, frame=1).values, 2 * values - 998)


def test_several_series_are_chosen_by_name(folder, values):
    other = generate_uid(entropy_srcs=["other"])
    for k in range(4):
        write_slice(
            folder / f"other{k}",
            values[k] + 5,
            2 * k,
            other,
            SeriesNumber=4,
            SeriesDescription="Neck",
        )
    assert set(probe(folder).datasets) == {"3 Head CT", "4 Neck CT"}
    np.testing.assert_array_equal(
        read_volume(folder, dataset="4 Neck CT").values, 2 * (values + 5) - 1000
    )
    np.testing.assert_array_equal(read_volume(folder / "a").values, 2 * values - 1000)
    with pytest.raises(LeaflightError, match="2 volumes; choose one of .*4 Neck CT"):
        read_volume(folder)


def test_an_enhanced_file_holds_all_slices(tmp_path, values):
    order = [2, 0, 3, 1]
    groups = []
    for k in order:
        place = pydicom.Dataset()
        place.ImagePositionPatient = [10, 20, 2 * k]
        group = pydicom.Dataset()
        group.PlanePositionSequence = pydicom.Sequence([place])
        groups.append(group)
    write_slice(
        tmp_path / "all.dcm",
        values[order],
        0,
        NumberOfFrames=4,
        PerFrameFunctionalGroupsSequence=pydicom.Sequence(groups),
    )
    volume = read_volume(tmp_path / "all.dcm")
    np.testing.assert_array_equal(volume.values, 2 * values - 1000)
    np.testing.assert_allclose(np.diag(volume.index_to_world), [-0.25, -0.5, 2, 1])


def test_values_beyond_sixteen_bits(tmp_path, values):
    for k in range(4):
        pixels = values[k] + 60000 * (k == 2)
        write_slice(tmp_path / str(k), pixels, k, RescaleSlope=1, RescaleIntercept=-1024)
    volume = read_volume(tmp_path)
    assert volume.values.dtype == np.float32
    expected = values - 1024
    expected[2] += 60000
    np.testing.assert_array_equal(volume.values, expected)


def test_a_dose_has_the_distances_of_its_pages(tmp_path, values):
    write_slice(
        tmp_path / "dose.dcm", values, 50, NumberOfFrames=4, GridFrameOffsetVector=[0, 3, 6, 9]
    )
    volume = read_volume(tmp_path / "dose.dcm")
    np.testing.assert_array_equal(volume.values, 2 * values - 1000)
    np.testing.assert_allclose(volume.index_to_world @ [0, 0, 1, 1], [-10, -20, 53, 1])


def test_damaged(folder, values):
    (folder / "d").unlink()
    with pytest.raises(LeaflightError, match="2 to 4 mm apart, so that one may be missing"):
        read_volume(folder)
    write_slice(folder / "d", values[2, :-1], 104)
    with pytest.raises(LeaflightError, match="missing; .*1 slice of another size .* is left out"):
        read_volume(folder)
    write_slice(folder / "d", values[2], 104)
    whole = (folder / "d").read_bytes()
    (folder / "d").write_bytes(whole[:-20])
    with pytest.raises(LeaflightError, match="damaged|truncated|claims"):
        read_volume(folder)
    write_slice(folder / "d", values[2], 104, SamplesPerPixel=3)
    with pytest.raises(LeaflightError, match="colors"):
        read_volume(folder / "d")
