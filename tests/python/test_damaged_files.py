# SPDX-License-Identifier: GPL-3.0-or-later
"""Small files of each format, which test_fuzz.py damages, and files that fuzzing has found."""

import base64
import gzip
import io
import zlib

import nibabel
import numpy as np
import pytest
import tifffile
from leaflight import read_volume
from outcomes import refused, written
from test_reader_chemistry import opendx, vasp, xsf
from test_reader_crystals import brix
from test_reader_cube import cube
from test_reader_vti import vti
from test_reader_vtk_legacy import by_hand

VALUES = np.random.default_rng(8).integers(0, 255, (6, 7, 8)).astype(np.uint8)

NRRD = b"""NRRD0004
type: uint8
dimension: 3
sizes: 8 7 6
encoding: raw
space: left-posterior-superior
space directions: (1,0,0) (0,1,0) (0,0,1)
space origin: (0,0,0)

"""


def nifti():
    return nibabel.Nifti1Image(VALUES.T, np.eye(4)).to_bytes()


def tiff(**options):
    def make(path):
        tifffile.imwrite(path, VALUES, photometric="minisblack", datetime=False, **options)
        return path.read_bytes()

    return make


def metaimage(path):
    header = b"NDims = 3\nDimSize = 8 7 6\nElementSpacing = 1 1 2\nCompressedData = True\n"
    header += b"ElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    return header + zlib.compress(VALUES.tobytes())


def dicom(path):
    pytest.importorskip("pydicom")
    from dicom_files import write_slice

    write_slice(path, VALUES, 0, NumberOfFrames=6, RescaleSlope=1, RescaleIntercept=0)
    return path.read_bytes()


def mrc(path):
    pytest.importorskip("mrcfile")
    from test_reader_mrc import ccp4

    return ccp4(VALUES.astype(np.float32))


def npy(path):
    np.save(path, VALUES)
    return path.read_bytes()


def npz(path):
    np.savez_compressed(path, h=VALUES)
    return path.read_bytes()


def hdf5(path):
    h5py = pytest.importorskip("h5py")
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        file.create_dataset("h", data=VALUES, chunks=(3, 7, 8), compression="gzip")
    return memory.getvalue()


FORMATS = {
    "x.mha": metaimage,
    "x.dcm": dicom,
    "x.mrc": mrc,
    "x.vti": lambda _: vti(VALUES, "UInt8", "appended"),
    "x.cube": lambda _: cube(VALUES.astype(np.float32)).encode(),
    "x.vtk": lambda _: by_hand(VALUES, "BINARY", "unsigned_char"),
    "x.dx": lambda _: opendx(VALUES).encode(),
    "LOCPOT": lambda _: vasp(VALUES, augmented=False).encode(),
    "x.xsf": lambda _: xsf(("rho", VALUES)).encode(),
    "x.brix": lambda _: brix(VALUES, plus="0", factor=1),
    "x.npy": npy,
    "x.npz": npz,
    "x.h5": hdf5,
    "x.nii": lambda _: nifti(),
    "x.nii.gz": lambda _: gzip.compress(nifti(), mtime=0),
    "x.nrrd": lambda _: NRRD + VALUES.tobytes(),
    "plain.tif": tiff(),
    "deflated.tif": tiff(compression="zlib"),
    "imagej.tif": tiff(imagej=True, metadata={"axes": "ZYX"}),
    # Without a given identifier, tifffile would draw a random one.
    "x.ome.tif": tiff(
        ome=True, metadata={"axes": "ZYX", "PhysicalSizeX": 2.0, "UUID": "urn:uuid:0"}
    ),
}


@pytest.mark.parametrize("name", FORMATS)
def test_the_files_that_are_damaged_are_whole(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(FORMATS[name](path))
    np.testing.assert_array_equal(read_volume(path).values, VALUES)


@pytest.mark.parametrize("back_to", [0, 2])
def test_tiff_pages_that_lead_back_to_themselves(tmp_path, back_to):
    """Checks a file found by fuzzing, whose pages form a loop."""
    path = tmp_path / "x.tif"
    with tifffile.TiffWriter(path) as file:
        for k, plane in enumerate(VALUES):
            # Use different pages, which are not read as one volume.
            file.write(plane[: k + 1], photometric="minisblack", metadata=None)
    with tifffile.TiffFile(path) as file:
        first, last = file.pages[back_to].offset, file.pages[-1]
        # The offset of the next page follows the page's number of tags and the tags.
        end = last.offset + 2 + 12 * len(last.tags)
    data = bytearray(path.read_bytes())
    assert data[end : end + 4] == bytes(4)
    data[end : end + 4] = first.to_bytes(4, "little")
    refused("x.tif: .*TIFF", read_volume, written(path, data))


def test_hdf5_that_ends_the_process_which_opens_it(tmp_path):
    """Checks a file found by fuzzing: libhdf5 1.10 follows an address outside the file."""
    pytest.importorskip("h5py")
    path = tmp_path / "x.h5"
    path.write_bytes(zlib.decompress(base64.b85decode("".join(HOSTILE_HDF5.split()))))
    refused("x.h5: this .*HDF5", read_volume, path)


HOSTILE_HDF5 = r"""
c-
rgqaB<`1lHy_j0S*oZ76t(ZWbhvf<b+ZAF!=;1%?PDCp!5nRm^dR?P68?}2sNKt=Af$!337D>ss4`!VD=cWKxhsIDg
cDBqhN>t4_C(k5FG*K!&3VRCRBA9Xz9^|LVFn**l-CmBH6>pU;&|-
Ap$T>><p;M7MD0P&_j$+Z!sdtumWiipNSbF%*~(xW-!9-<p5`}l+?7G#FA777Pz?z5ObMWDp+AwK&<6J3LPMDpi1-
v`}w;tf?Wdv3e2NPmK<Q1YHVP^$iReA4sIsWfE|JmdNTte*71RCAyhsyjs(g$8aJb06pVsVFbYP&C>RB!U=$2GP!Y$
tf+76>_F(JZI)RH%F22i?JSjgpo=du`>Wl3SM-
}~4!zbs@X0tmMPAi&~u!QYJhuZnL`yP*3^7Qgkey1Fqn^Y`3E7d|%=}GWC3BlNJrJJ_Txf{%@_E~Cs(VtIp%<)+bI{
P~OWs9D<`4;VKnlqt%^L^Vb3rxkf&u%D9R!VSuDex=KC#|$*qu{M=W`Q@{gC8f%+_=2AeX;pnwL5xkVKv%ul_$Pk-
1AybPrt(diy!ZCvFt#1sIzT<oSrk$@l4SRjR|?;k2#I?3zQcMe_X%ddBMeH)!t!}>Q{D@6~5V`f0X%J^S-
T)fAkiaiZl1EOj@R2b%Al)nse^6eKt;8f860*-
}ZZkaaCFqSPMn6@|UnWt^K~E;oZx<vvcko>pl2NAdc;j;o^^(iA5LmVk(zzjc>TPs@eQQ?0Ki3lS7)^-
Y@Cgd^u;k+9LZ^|8)E~Lt2~9$*xs<a4Nah%lztdLl>`gt{1{|0qbu6;{
"""
