# SPDX-License-Identifier: GPL-3.0-or-later
"""write_packed_files.py FOLDER: writes a file of each kind that compiled libraries read, and its
values.

Uses build/tools-venv, whose libraries are not in the packages: Debian's h5py, zarr and Pillow, and
tensorstore and pyjpegls from PyPI.
"""

import io
import json
import sys
from pathlib import Path

import h5py
import jpeg_ls
import numpy as np
import tensorstore
import zarr
from PIL import Image, ImageSequence
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.uid import CTImageStorage, JPEG2000Lossless, JPEGLSLossless, generate_uid


def values_of(shape, most, kind):
    """Returns smooth values with a little noise, so that every compression has work."""
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in shape), indexing="ij")
    noise = np.random.default_rng(5).random(shape)
    return ((np.exp(-2 * (x**2 + y**2 + z**2)) + 0.01 * noise) / 1.02 * most).astype(kind)


WORDS = values_of((6, 20, 24), 4000, np.uint16)
BYTES = values_of((6, 32, 40), 255, np.uint8)


def hdf5(path):
    with h5py.File(path, "w") as file:
        file.create_dataset("volume", data=WORDS, chunks=(2, 10, 12), compression="gzip")
    return WORDS


def zarr_2(path):
    array = zarr.open(str(path), mode="w", shape=WORDS.shape, dtype="<u2", chunks=(4, 8, 10))
    array[:] = WORDS
    return WORDS


def zarr_3(path):
    """Writes a Zarr 3 array with shards."""
    codecs = [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "zstd"}]
    shards = {"chunk_shape": [2, 10, 12], "codecs": codecs}
    metadata = {
        "shape": WORDS.shape,
        "data_type": "uint16",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [4, 20, 24]}},
        "codecs": [{"name": "sharding_indexed", "configuration": shards}],
    }
    store = {"driver": "file", "path": str(path)}
    spec = {"driver": "zarr3", "kvstore": store, "metadata": metadata}
    tensorstore.open(spec, create=True).result().write(WORDS).result()
    return WORDS


def tiff(compression, values):
    def write(path):
        pages = [Image.fromarray(plane) for plane in values]
        options = {"save_all": True, "append_images": pages[1:], "compression": compression}
        pages[0].save(path, "TIFF", **options)
        # JPEG is lossy, so store the decoded values.
        with Image.open(path) as file:
            return np.stack([np.array(page) for page in ImageSequence.Iterator(file)])

    return write


def dicom(syntax, packed):
    def write(folder):
        folder.mkdir()
        series = generate_uid()
        for k, plane in enumerate(WORDS):
            meta = FileMetaDataset()
            meta.MediaStorageSOPClassUID, meta.TransferSyntaxUID = CTImageStorage, syntax
            meta.MediaStorageSOPInstanceUID = generate_uid()
            data = FileDataset(str(folder / f"{k}.dcm"), {}, file_meta=meta, preamble=bytes(128))
            data.is_little_endian, data.is_implicit_VR = True, False
            data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
            data.SeriesInstanceUID, data.SeriesNumber, data.Modality = series, 1, "CT"
            data.ImagePositionPatient = [0, 0, 2 * k]
            data.ImageOrientationPatient, data.PixelSpacing = [1, 0, 0, 0, 1, 0], [1, 1]
            data.Rows, data.Columns, data.SamplesPerPixel = *plane.shape, 1
            data.BitsAllocated, data.BitsStored, data.HighBit = 16, 16, 15
            data.PixelRepresentation, data.PhotometricInterpretation = 0, "MONOCHROME2"
            data.PixelData = encapsulate([packed(plane)])
            data["PixelData"].is_undefined_length = True
            data.save_as(folder / f"{k}.dcm", write_like_original=False)
        return WORDS

    return write


def jpeg_2000(plane):
    file = io.BytesIO()
    Image.fromarray(plane).save(file, "JPEG2000", no_jp2=True, irreversible=False)
    return file.getvalue()


KINDS = {
    "hdf5.h5": hdf5,
    "two.zarr": zarr_2,
    "three.zarr": zarr_3,
    "lzw.tif": tiff("tiff_lzw", WORDS),
    "zstd.tif": tiff("zstd", WORDS),
    "jpeg.tif": tiff("jpeg", BYTES),
    "jpeg_2000": dicom(JPEG2000Lossless, jpeg_2000),
    "jpeg_ls": dicom(JPEGLSLossless, lambda plane: bytes(jpeg_ls.encode_array(plane))),
}

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for name, write in KINDS.items():
        np.save(folder / f"{name}.npy", write(folder / name))
    print(json.dumps(list(KINDS)))
