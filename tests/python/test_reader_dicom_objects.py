# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests DICOM files with many planes: enhanced ones, doses, cameras, segmentations."""

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from leaflight.srgb import linear_from_srgb
from leaflight.volume.label_table import Label
from outcomes import reads, refused

pydicom = pytest.importorskip("pydicom")
from dicom_files import at, camera, dose, edit, item, items, segments, write_pages, write_slice  # noqa: E402

PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
LABEL_MAP = "1.2.840.10008.5.1.4.1.1.66.7"


def test_an_enhanced_file_holds_all_slices(tmp_path, values):
    order = [2, 0, 3, 1]
    path = write_pages(tmp_path / "all.dcm", values[order], [at(2 * k) for k in order])
    volume = reads(values, path)
    np.testing.assert_allclose(np.diag(volume.index_to_world), [-0.25, -0.5, 2, 1])


def test_times_of_an_enhanced_file(tmp_path, values):
    """Checks the slope of each page, and times by their numbers instead of the pages' order."""
    order = [(time, k) for k in range(4) for time in (1, 0)]
    pages = [
        at(
            2 * k,
            FrameContentSequence=item(TemporalPositionIndex=time + 1, StackID="1"),
            PixelValueTransformationSequence=item(RescaleSlope=0.5 + time, RescaleIntercept=-k),
        )
        for time, k in order
    ]
    path = write_pages(tmp_path / "all.dcm", np.array([values[k] + t for t, k in order]), pages)
    assert probe(path).frames == 2
    intercepts = np.arange(4)[:, None, None]
    for time in range(2):
        expected = (values + time) * (0.5 + time) - intercepts
        reads(expected, path, frame=time)


def test_stacks_of_an_enhanced_file(tmp_path, values):
    order = [(stack, k) for stack in range(2) for k in range(4)]
    pages = [
        at(2 * k + 100 * stack, FrameContentSequence=item(StackID=f"{stack + 1}"))
        for stack, k in order
    ]
    path = write_pages(tmp_path / "x.dcm", np.array([values[k] + s for s, k in order]), pages)
    assert probe(path).datasets == ("stack 1 axial", "stack 2 axial")
    volume = reads(values + 1, path, dataset="stack 2 axial")
    assert volume.index_to_world[2, 3] == 100


AXIAL = [1, 0, 0, 0, 1, 0]


@pytest.mark.parametrize(
    "offsets, axes, first, step",
    [
        ([0, 3, 6, 9], AXIAL, 50, 1),
        ([2, 5, 8, 11], AXIAL, 52, 1),
        ([0, -3, -6, -9], AXIAL, 41, -1),
        # Use heights in the patient, which the standard permits for axial planes.
        ([50, 53, 56, 59], AXIAL, 50, 1),
        ([50, 47, 44, 41], AXIAL, 41, -1),
        ([50, 53, 56, 59], [-1, 0, 0, 0, -1, 0], 50, 1),
    ],
)
def test_planes_of_a_dose(tmp_path, values, offsets, axes, first, step):
    volume = read_volume(dose(tmp_path / "x.dcm", values, offsets, ImageOrientationPatient=axes))
    np.testing.assert_allclose(volume.values, values[::step] * 0.05, rtol=1e-6)
    np.testing.assert_allclose(volume.index_to_world[2], [0, 0, 3, first], atol=1e-9)


def test_damaged_doses(tmp_path, values):
    refused("3 planes, .* 4", read_volume, dose(tmp_path / "dose.dcm", values, [0, 3, 6]))
    refused("3 to 6 mm apart", read_volume, dose(tmp_path / "dose.dcm", values, [0, 3, 9, 12]))


def test_doses_of_two_beams(tmp_path, values):
    """Checks that the doses of one series are separate volumes."""
    for beam in range(2):
        path = dose(tmp_path / f"{beam}.dcm", values + beam, [0, 3, 6, 9])
    assert probe(tmp_path).datasets == ("3 Head RTDOSE", "3 Head RTDOSE (2)")
    np.testing.assert_allclose(read_volume(path).values, (values + 1) * 0.05, rtol=1e-6)


@pytest.mark.parametrize("apart", [2.5, -2.5])
def test_planes_of_a_camera(tmp_path, values, apart):
    tags = {"FrameIncrementPointer": 0x00540080, "SliceVector": [1, 2, 3, 4]}
    path = camera(tmp_path / "nm.dcm", values, SpacingBetweenSlices=apart, **tags)
    volume = reads(values, path)
    np.testing.assert_allclose(volume.index_to_world[:3, 2], [0, 0, apart])
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [8, -5, -3])
    assert volume.patient


def test_gates_of_a_camera(tmp_path, values):
    order = [(time, k) for time in range(2) for k in (3, 1, 2, 0)]
    path = camera(
        tmp_path / "nm.dcm",
        np.array([values[k] + time for time, k in order]),
        SpacingBetweenSlices=-4,
        FrameIncrementPointer=[0x00540070, 0x00540080],
        TimeSlotVector=[time + 1 for time, _ in order],
        SliceVector=[k + 1 for _, k in order],
    )
    assert probe(path).frames == 2
    reads(values + 1, path, frame=1)


def test_pages_that_are_times(tmp_path, values):
    path = write_pages(tmp_path / "x.dcm", values, FrameIncrementPointer=0x00181063, FrameTime=40)
    refused("4 slices .*same position", read_volume, path)


def test_views_of_a_camera(tmp_path, values):
    kind = ["ORIGINAL", "PRIMARY", "TOMO", "EMISSION"]
    volume = reads(values, camera(tmp_path / "nm.dcm", values, ImageType=kind))
    assert volume.notes == ("The pages are views or times of a camera, not slices.",)


def test_pages_that_are_tiles(tmp_path, values):
    path = write_pages(tmp_path / "x.dcm", values, TotalPixelMatrixColumns=12)
    refused("tiles of", read_volume, path)
    write_slice(tmp_path / "mosaic", values[0], 0, ImageType=["ORIGINAL", "PRIMARY", "M", "MOSAIC"])
    refused("mosaic.*dcm2niix", read_volume, tmp_path / "mosaic")


def test_pages_without_places(tmp_path, values):
    path = write_pages(tmp_path / "x.dcm", values)
    edit(path, without=["ImagePositionPatient", "ImageOrientationPatient", "SliceThickness"])
    volume = reads(values, path)
    assert not volume.patient and volume.notes == (
        "The header has no position of the slices in the patient.",
        "The header has no distance between slices; 1 mm is assumed.",
    )


def test_a_map_of_integers(tmp_path, values):
    mapping = item(RealWorldValueSlope=0.25, RealWorldValueIntercept=3)
    shared = pydicom.Sequence([items(RealWorldValueMappingSequence=mapping)])
    tags = {"SOPClassUID": PARAMETRIC_MAP, "SharedFunctionalGroupsSequence": shared}
    path = write_pages(tmp_path / "x.dcm", values, [at(2 * k) for k in range(4)], **tags)
    reads(values * 0.25 + 3, path)


@pytest.fixture
def masks():
    """Writes two organs, in planes 0, 1, 4 and 1, 4 of five."""
    masks = np.random.default_rng(4).random((2, 5, 5, 7)) < 0.5
    masks[0, 2:4] = masks[1, [0, 2, 3]] = 0
    return masks


def test_segments_are_volumes_by_their_labels(tmp_path, masks):
    planes = [(n + 1, k, masks[n, k]) for n in (1, 0) for k in (4, 1, 0) if masks[n, k].any()]
    path = segments(tmp_path / "seg.dcm", planes, ["Liver", "Spleen"], SegmentationType="BINARY")
    # A page of 35 bits begins inside a byte.
    bits = np.packbits(np.array([plane for *_, plane in planes]).ravel(), bitorder="little")
    packed = bits.tobytes() + b"\0" * (bits.size % 2)
    edit(path, PixelData=packed, BitsAllocated=1, BitsStored=1, HighBit=0)
    assert probe(path).datasets == ("all segments", "Spleen", "Liver")
    for n, label in enumerate(["Liver", "Spleen"]):
        volume = reads(masks[n], path, dataset=label)
        assert volume.values.dtype == np.uint8
        np.testing.assert_allclose(np.diag(volume.index_to_world), [-0.25, -0.5, 2, 1])
    refused("all segments, Spleen, Liver", read_volume, path, dataset="Heart")
    # Without a choice the file is a label map, in which higher numbers are on top.
    volume = reads(np.where(masks[1], 2, masks[0]), path)
    assert [(label.number, label.name) for label in volume.labels] == [(1, "Liver"), (2, "Spleen")]
    np.testing.assert_allclose(np.diag(volume.index_to_world), [-0.25, -0.5, 2, 1])
    assert volume.patient and probe(path).dims == (7, 5, 5)


def test_segments_by_their_share(tmp_path, masks):
    planes = [(1, k, masks[0, k] * 100) for k in (0, 1, 4)]
    tags = {"SegmentationType": "FRACTIONAL", "MaximumFractionalValue": 200}
    # The header's distance is wrong.
    path = segments(tmp_path / "seg.dcm", planes, ["Liver"], apart=1.7, **tags)
    np.testing.assert_allclose(read_volume(path).values, masks[0] * 0.5)


def test_the_thickness_of_segments_is_no_distance(tmp_path, masks):
    planes = [(1, k, masks[0, k]) for k in (0, 1, 4)]
    measures = item(SliceThickness=1, PixelSpacing=[0.5, 0.25])
    shared = pydicom.Sequence([items(PixelMeasuresSequence=measures)])
    tags = {"SharedFunctionalGroupsSequence": shared}
    volume = reads(masks[0], segments(tmp_path / "seg.dcm", planes, ["Liver"], **tags))
    assert volume.spacing == (0.25, 0.5, 2)


def test_two_slices_of_a_segment_at_one_place(tmp_path, masks):
    planes = [(1, k, masks[0, 0]) for k in (0, 1, 1)]
    path = segments(tmp_path / "seg.dcm", planes, ["Liver"])
    reads(masks[0, [0, 0]], path)
    planes[2] = (1, 1, masks[0, 1])
    path = segments(tmp_path / "seg.dcm", planes, ["Liver"])
    refused("'Liver' .*2 different slices", read_volume, path)


def test_segments_of_highdicom(tmp_path, masks):
    highdicom = pytest.importorskip("highdicom")
    from pydicom.sr.codedict import codes

    person = {"StudyInstanceUID": "1.2.3", "FrameOfReferenceUID": "1.2.4", "StudyID": "1"}
    person |= {name: "" for name in ("PatientID", "PatientName", "PatientBirthDate", "PatientSex")}
    person |= {name: "" for name in ("StudyDate", "StudyTime", "AccessionNumber")}
    scan = []
    for k in range(5):
        write_slice(tmp_path / f"{k}", masks[0, k], 2 * k, ReferringPhysicianName="", **person)
        scan.append(pydicom.dcmread(tmp_path / f"{k}"))
    described = [
        highdicom.seg.SegmentDescription(
            segment_number=n + 1,
            segment_label=label,
            segmented_property_category=codes.SCT.Organ,
            segmented_property_type=codes.SCT.Liver,
            algorithm_type="MANUAL",
            display_color=highdicom.color.CIELabColor.from_rgb(221, 130, 101),
        )
        for n, label in enumerate(["Liver", "Spleen"])
    ]
    path = tmp_path / "seg.dcm"
    highdicom.seg.Segmentation(
        source_images=scan,
        pixel_array=np.moveaxis(masks, 0, 3).astype(np.uint8),
        segmentation_type="BINARY",
        segment_descriptions=described,
        series_instance_uid=highdicom.UID(),
        series_number=300,
        sop_instance_uid=highdicom.UID(),
        instance_number=1,
        **dict.fromkeys(("manufacturer", "manufacturer_model_name"), ""),
        **dict.fromkeys(("software_versions", "device_serial_number"), ""),
    ).save_as(path)
    for n, label in enumerate(["Liver", "Spleen"]):
        reads(masks[n], path, dataset=label)
    colors = [label.color for label in read_volume(path).labels]
    assert np.abs(np.array(colors) * 255 - (221, 130, 101)).max() < 0.6
    # The folder also contains its scan.
    segments = ("300 SEG: all segments", "300 SEG: Liver", "300 SEG: Spleen")
    assert probe(tmp_path).datasets == ("3 Head CT", *segments)
    reads(masks[1], tmp_path, dataset="Spleen")
    refused("choose one of 3 Head CT, 300 SEG: all", read_volume, tmp_path)
    reads(np.where(masks[1], 2, masks[0]), tmp_path, dataset="300")


@pytest.mark.parametrize("rgb", [(255, 0, 0), (0, 128, 128), (221, 130, 101), (0, 0, 0)])
def test_colors_of_segments(tmp_path, masks, rgb):
    """Compares with colors as DCMTK writes them."""
    planes = [(n + 1, k, masks[n, k]) for n in (0, 1) for k in (0, 1, 4)]
    path = segments(tmp_path / "seg.dcm", planes, ["Liver", "Spleen"])
    data = pydicom.dcmread(path)
    data.SegmentSequence[1].RecommendedDisplayCIELabValue = cielab(rgb)
    data.save_as(str(path), write_like_original=False)
    without, colored = read_volume(path).labels
    assert np.abs(np.array(colored.color) * 255 - rgb).max() < 0.6
    assert without == Label.of(1, "Liver")
    (alone,) = read_volume(path, dataset="Spleen").labels
    assert (alone.number, alone.name, alone.color) == (1, "Spleen", colored.color)


def cielab(rgb):
    """Returns the three stored numbers of an sRGB color in 0..255."""
    linear = linear_from_srgb(np.array(rgb) / 255)
    matrix = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    share = matrix @ linear / (0.950456, 1.0, 1.088754)
    x, y, z = np.where(share > (6 / 29) ** 3, np.cbrt(share), share * 841 / 108 + 4 / 29)
    stored = (116 * y - 16) / 100, (500 * (x - y) + 128) / 255, (200 * (y - z) + 128) / 255
    return [round(65535 * part) for part in stored]


def test_a_label_map_of_dicom(tmp_path, masks):
    """Checks the kind of segmentation whose pixels are the numbers of segments."""
    numbers = np.where(masks[1], 2, masks[0]).astype(np.uint16)
    planes = [(1, k, numbers[k]) for k in range(5)]
    path = segments(tmp_path / "seg.dcm", planes, ["Liver", "Spleen"], SOPClassUID=LABEL_MAP)
    data = pydicom.dcmread(path)
    for page in data.PerFrameFunctionalGroupsSequence:
        del page.SegmentIdentificationSequence
    data.save_as(str(path), write_like_original=False)
    volume = reads(numbers, path)
    assert [label.name for label in volume.labels] == ["Liver", "Spleen"]


def test_a_real_dose():
    """Compares a dose file of pydicom's with pydicom's own pixel_array."""
    from pydicom.data import get_testdata_file

    path = get_testdata_file("rtdose.dcm", download=False)
    if not path:
        pytest.skip("pydicom's rtdose.dcm is not here")
    own = pydicom.dcmread(path)
    volume = read_volume(path)
    np.testing.assert_allclose(volume.values, own.pixel_array * own.DoseGridScaling, rtol=1e-6)
    np.testing.assert_allclose(volume.index_to_world[2], [0, 0, 5, -761.87])
