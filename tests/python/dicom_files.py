# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM files that tests read, as pydicom writes them."""

import pytest

pydicom = pytest.importorskip("pydicom")
from pydicom.dataset import FileDataset, FileMetaDataset  # noqa: E402
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid  # noqa: E402

SERIES = generate_uid(entropy_srcs=["leaflight"])


def write_slice(path, pixels, place, series=SERIES, **tags):
    """A CT slice at the place z along the patient; its values are 2 pixels - 1000."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    # The same bytes in every run.
    meta.MediaStorageSOPInstanceUID = generate_uid(entropy_srcs=[f"{series} {path.name}"])
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
    """A folder of slices whose values are those given."""
    folder.mkdir(parents=True, exist_ok=True)
    tags = {"RescaleSlope": 1, "RescaleIntercept": 0, **tags}
    for k, plane in enumerate(values):
        place = round(apart * k, 6)
        write_slice(folder / f"IM{k:04}", plane, place, **{"InstanceNumber": k + 1, **tags})
    return folder


def edit(path, without=(), syntax=None, **tags):
    """Changes tags of a file; syntax: the transfer syntax that it then has."""
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
    """A sequence of one item with these tags."""
    data = pydicom.Dataset()
    for name, value in tags.items():
        setattr(data, name, value)
    return pydicom.Sequence([data])


def items(**sequences):
    """One item with these sequences."""
    data = pydicom.Dataset()
    for name, value in sequences.items():
        setattr(data, name, value)
    return data
