# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever bytes of a file change, its reader gives a volume or one sentence, nothing else."""

import gzip

import nibabel
import numpy as np
import pytest
import tifffile
from leaflight import LeaflightError, read_volume

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


def nifti(path):
    return nibabel.Nifti1Image(VALUES.T, np.eye(4)).to_bytes()


def gzipped_nifti(path):
    return gzip.compress(nifti(path), mtime=0)


def nrrd(path):
    return NRRD + VALUES.tobytes()


def tiff(**options):
    def make(path):
        tifffile.imwrite(path, VALUES, photometric="minisblack", datetime=False, **options)
        return path.read_bytes()

    return make


FORMATS = {
    "x.nii": nifti,
    "x.nii.gz": gzipped_nifti,
    "x.nrrd": nrrd,
    "plain.tif": tiff(),
    "deflated.tif": tiff(compression="zlib"),
    "imagej.tif": tiff(imagej=True, metadata={"axes": "ZYX"}),
    "x.ome.tif": tiff(ome=True, metadata={"axes": "ZYX", "PhysicalSizeX": 2.0}),
}


@pytest.mark.parametrize("name", FORMATS)
def test_changed_and_cut_bytes(tmp_path, capfd, name):
    path = tmp_path / name
    good = FORMATS[name](path)
    path.write_bytes(good)
    np.testing.assert_array_equal(read_volume(path).values, VALUES)
    rng = np.random.default_rng(9)
    refused = 0
    for attempt in range(150):
        bad = bytearray(good)
        for place in rng.integers(0, len(bad), rng.integers(1, 5)):
            bad[place] = rng.choice([0, 1, 127, 128, 255])
        # Most damage is done to headers, and these come first.
        for place in rng.integers(0, min(len(bad), 400), 2):
            bad[place] = rng.choice([0, 1, 127, 128, 255])
        if attempt % 10 == 0:
            bad = bad[: rng.integers(0, len(bad))]
        path.write_bytes(bad)
        try:
            read_volume(path)
        except LeaflightError as error:
            refused += 1
            assert path.name in str(error) and "\n" not in str(error) and len(str(error)) < 500
    assert refused > 10
    assert capfd.readouterr() == ("", "")
