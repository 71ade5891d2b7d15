# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests real files of every format, if there are some in LEAFLIGHT_DATA or ../data."""

import os
from pathlib import Path

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(os.environ.get("LEAFLIGHT_DATA", ROOT.parent / "shared" / "data"))

# Options, dims, range, voxel size and unit by file name, as published.
FILES = {
    "ch2.nii.gz": ({}, (181, 217, 181), (0, 254), (1, 1, 1), "mm"),
    "heptane.nii.gz": ({}, (302, 302, 302), (0, 255), (1, 1, 1), "mm"),
    "engine.vti": ({}, (256, 256, 128), (0, 255), (1, 1, 1), ""),
    "hydrogen.vti": ({}, (64, 64, 64), (0, 1), (1, 1, 1), ""),
    "isabel_02.vti": ({}, (125, 125, 25), (0, 68.25), (4.01, 4.01, 4.04), ""),
    "aneurism.nrrd": ({}, (256, 256, 256), (0, 255), (1, 1, 1), ""),
    "bunny_ct_half.nrrd": ({}, (256, 256, 180), (0, 2776), (0.676, 0.676, 1), ""),
    "amos_0336.mhd": ({}, (256, 256, 157), (-1024, 3071), (1.586, 1.586, 4), "mm"),
    "1jzv.ccp4": ({}, (76, 96, 70), (-0.99, 9.05), (0.545, 0.545, 0.560), "Å"),
    "N2O_homo+lumo.cube.gz": ({"channel": 0}, (19, 19, 31), (-0.575, 0.575), (0.378,) * 3, "bohr"),
    "nucleon.raw": ({"dims": (41,) * 3, "type": "uint8"}, (41,) * 3, (0, 249), (1, 1, 1), ""),
}


@pytest.mark.parametrize("name", FILES)
def test_real_files(name):
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"{name} is not there")
    options, dims, limits, sizes, unit = FILES[name]
    stored = probe(path, **{key: options[key] for key in options.keys() & {"dims", "type"}})
    volume = read_volume(path, **options)
    assert stored.dims == dims == volume.values.shape[::-1] and stored.unit == unit
    assert stored.bytes() == volume.values.nbytes
    np.testing.assert_allclose(stored.voxel_size, sizes, rtol=1e-3)
    np.testing.assert_allclose(volume.field().range, limits, atol=0.006)


@pytest.fixture
def of_pydicom():
    try:
        from pydicom.data import get_testdata_file
    except ImportError:
        pytest.skip("pydicom is not installed")

    def path(name):
        found = get_testdata_file(name, download=False)
        if not found:
            pytest.skip(f"pydicom's {name} is not here")
        return Path(found)

    return path


def test_a_real_enhanced_dicom(of_pydicom):
    """Checks ten planes of an MR scan in one file of pydicom."""
    volume = read_volume(of_pydicom("emri_small.dcm"))
    assert volume.values.shape == (10, 64, 64)
    np.testing.assert_allclose(np.linalg.norm(volume.index_to_world[:3, 0]), 0.3125)


def test_a_real_hdf5(tmp_path):
    """Compares a scan in MINC 2, which is HDF5, with nibabel, which scales each of its planes."""
    import nibabel

    file = Path(nibabel.__file__).parent / "tests" / "data" / "small.mnc"
    if not file.exists():
        pytest.skip("nibabel's small.mnc is not here")
    pytest.importorskip("h5py")
    path = tmp_path / "small.h5"
    path.write_bytes(file.read_bytes())
    ours, theirs = read_volume(path).values, nibabel.load(file).get_fdata()
    assert ours.shape == theirs.shape == (18, 28, 29)
    for plane, other in zip(ours, theirs):
        assert np.corrcoef(plane.ravel(), other.ravel())[0, 1] > 0.99999
