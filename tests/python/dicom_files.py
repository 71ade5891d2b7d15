# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM files for tests, written by pydicom."""

import io

import numpy as np
import pytest

pydicom = pytest.importorskip("pydicom")
from pydicom.dataset import FileDataset, FileMetaDataset  # noqa: E402
from pydicom.fileset import FileSet  # noqa: E402
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid  # noqa: E402

SEGMENTATION = "1.2.840.10008.5.1.4.1.1.66.4"


def uid(name):
    """Returns a DICOM identifier of a name, the same in every run."""
    return generate_uid(entropy_srcs=[name])


SERIES = uid("leaflight")


def write_slice(path, pixels, place, series=SERIES, **tags):
    """Writes a CT slice at the position z in the patient; its values are 2 pixels - 1000."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    # Set all identifiers, so that the bytes are the same in every run.
    meta.MediaStorageSOPInstanceUID = uid(f"{series} {path.name}")
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
    data.PixelData = pixels.astype("<u2").tobytes()
    for name, value in tags.items():
        setattr(data, name, value)
    data.save_as(str(path), write_like_original=False)


def write_series(folder, values, apart=2.0, **tags):
    """Writes a folder of slices with the given values; a tag may be a function of its slice."""
    folder.mkdir(parents=True, exist_ok=True)
    numbers = {"InstanceNumber": lambda k: k + 1}
    tags = {"RescaleSlope": 1, "RescaleIntercept": 0, **numbers, **tags}
    for k, plane in enumerate(values):
        own = {name: tag(k) if callable(tag) else tag for name, tag in tags.items()}
        write_slice(folder / f"IM{k:04}", plane, round(apart * k, 6), **own)
    return folder


def edit(path, without=(), syntax=None, **tags):
    """Changes tags of a file; syntax: its new transfer syntax."""
    data = pydicom.dcmread(path)
    for name in without:
        delattr(data, name)
    for name, value in tags.items():
        setattr(data, name, value)
    if syntax is not None:
        data.file_meta.TransferSyntaxUID = syntax
        data.is_implicit_VR = syntax == pydicom.uid.ImplicitVRLittleEndian
        if syntax.is_compressed and syntax != pydicom.uid.DeflatedExplicitVRLittleEndian:
            data["PixelData"].is_undefined_length = True
    data.save_as(str(path), write_like_original=False)


def item(**tags):
    """Returns a sequence of one item with these tags."""
    return pydicom.Sequence([items(**tags)])


def items(**tags):
    """Returns one item with these tags or sequences."""
    data = pydicom.Dataset()
    for name, value in tags.items():
        setattr(data, name, value)
    return data


def write_pages(path, values, pages=None, **tags):
    """Returns a file of several pages; pages: for each page, its items."""
    tags = {"RescaleSlope": 1, "RescaleIntercept": 0, "NumberOfFrames": len(values), **tags}
    if pages is not None:
        tags["PerFrameFunctionalGroupsSequence"] = pydicom.Sequence(pages)
    write_slice(path, values, tags.pop("place", 0), **tags)
    return path


def at(z, **sequences):
    return items(PlanePositionSequence=item(ImagePositionPatient=[10, 20, z]), **sequences)


def dose(path, values, offsets, place=50, **tags):
    tags = {"Modality": "RTDOSE", "DoseGridScaling": 0.05, "SliceThickness": None, **tags}
    return write_pages(path, values, place=place, GridFrameOffsetVector=offsets, **tags)


def camera(path, values, **tags):
    """Returns a reconstructed scan of a nuclear medicine camera."""
    detector = item(ImagePositionPatient=[-8, 5, -3], ImageOrientationPatient=[1, 0, 0, 0, 1, 0])
    tags = {"Modality": "NM", "DetectorInformationSequence": detector, **tags}
    write_pages(path, values, **tags)
    edit(path, without=["ImagePositionPatient", "ImageOrientationPatient"])
    return path


def segments(path, planes, labels, apart=2, **tags):
    """Returns a segmentation; planes: (segment from 1, k, pixels) of each page."""
    described = [items(SegmentNumber=n + 1, SegmentLabel=label) for n, label in enumerate(labels)]
    pages = [
        at(2 * k, SegmentIdentificationSequence=item(ReferencedSegmentNumber=number))
        for number, k, _ in planes
    ]
    measures = item(SpacingBetweenSlices=apart, PixelSpacing=[0.5, 0.25])
    pixels = np.array([plane for *_, plane in planes])
    tags = {
        "SOPClassUID": SEGMENTATION,
        "Modality": "SEG",
        "SegmentSequence": pydicom.Sequence(described),
        "SharedFunctionalGroupsSequence": pydicom.Sequence([items(PixelMeasuresSequence=measures)]),
        **tags,
    }
    write_pages(path, pixels, pages, **tags)
    return path


def jpeg_2000(plane):
    """Returns JPEG 2000 data, written by Pillow."""
    image = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    image.fromarray(plane.astype(np.uint16)).save(file, "JPEG2000", no_jp2=True, irreversible=False)
    return file.getvalue()


def bare(data):
    """Returns the bytes of a file without its preamble and its file meta information."""
    return data[144 + int.from_bytes(data[140:144], "little") :]


def write_disc(folder, values):
    """Returns a folder with a DICOMDIR, like a patient's CD, written by pydicom."""
    scan = write_series(folder / "scan", values)
    files = FileSet()
    files.UID = uid("disc")
    person = {"PatientID": "1", "PatientName": "A", "StudyID": "1", "StudyDate": "20240131"}
    for path in sorted(scan.iterdir()):
        edit(path, StudyInstanceUID=uid("study"), StudyTime="1200", **person)
        files.add(path)
    files.write(folder / "disc")
    return folder / "disc"
