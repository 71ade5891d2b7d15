# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input: one line that names the file and the remedy, exit status 2, nothing written."""

import gzip
import json
import re
import struct

import nibabel
import numpy as np
import pytest
import tifffile
from leaflight.io import reader_process
from leaflight.io.readers import reading

RNG = np.random.default_rng(1)
NOISE = RNG.integers(0, 255, (24, 20, 16)).astype(np.uint8)


def nifti(path, array, claim=None):
    image = nibabel.Nifti1Image(array, np.eye(4))
    data = bytearray(image.to_bytes())
    if claim is not None:
        data[42:48] = np.array(claim, "<i2").tobytes()
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)


def raw(path, array):
    path.write_bytes(array.tobytes())


def cut(path, share):
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])


CASES = {}


def case(suffix, sentence, *options):
    """Registers a function that writes a bad file at path."""

    def register(write):
        CASES[write.__name__] = (write, suffix, sentence, options)
        return write

    return register


@case(".nii", "no such file")
def missing_file(path):
    pass


@case(".xyz", "suffix")
def unknown_kind(path):
    path.write_text("?")


@case(".nii", "not a readable NIfTI")
def text_as_nifti(path):
    path.write_text("This is no volume. " * 40)


@case(".nii", "not a readable NIfTI")
def empty_nifti(path):
    path.write_bytes(b"")


@case(".nii", "truncated|ends before")
def truncated_nifti(path):
    nifti(path, NOISE)
    cut(path, 0.6)


@case(".nii.gz", "truncated|ends before")
def truncated_gzip(path):
    nifti(path, NOISE)
    cut(path, 0.6)


@case(".nii", "truncated")
def nifti_claims_more(path):
    nifti(path, NOISE, claim=(30000, 30000, 30000))


@case(".nii.gz", "truncated")
def gzip_claims_more(path):
    nifti(path, NOISE, claim=(30000, 30000, 30000))


@case(".nii", r"one of 0..2 \(--frame\)\.")
def four_dimensions(path):
    nifti(path, np.stack([NOISE] * 3, axis=-1))


@case(".nii", "no frame 3", "--frame", "3")
def frame_too_high(path):
    nifti(path, np.stack([NOISE] * 3, axis=-1))


@case(".nii", r"leave the option out \(--frame\)\.", "--frame", "1")
def frame_of_3d(path):
    nifti(path, NOISE)


@case(".nii", "three dimensions")
def two_dimensions(path):
    nifti(path, NOISE[0])


@case(".nii", "complex")
def complex_values(path):
    nifti(path, NOISE.astype(np.complex64))


@case(".nii", "colour")
def colour_values(path):
    nifti(path, NOISE.astype([("R", "u1"), ("G", "u1"), ("B", "u1")]))


@case(".nii", "")
def constant_values(path):
    nifti(path, np.full_like(NOISE, 3))


@case(".nii", "NaN")
def nothing_but_nan(path):
    nifti(path, np.full(NOISE.shape, np.nan, np.float32))


@case(".nii", "")
def infinite_values(path):
    values = NOISE.astype(np.float32)
    values[3, 3, 3] = np.inf
    nifti(path, values)


@case(".nii", "")
def one_slice(path):
    nifti(path, NOISE[:, :, :1])


@case(".raw", r"has no header.*\(--dims, --type\)\.")
def raw_without_layout(path):
    raw(path, NOISE)


@case(".raw", "7680 bytes.*holds.*7670", "--dims", "16", "20", "24", "--type", "uint8")
def truncated_raw(path):
    path.write_bytes(NOISE.tobytes()[:-10])


@case(".raw", "15360 bytes", "--dims", "16", "20", "24", "--type", "uint16")
def raw_of_another_type(path):
    raw(path, NOISE)


@case(".raw", "three positive", "--dims", "16", "--type", "uint8")
def raw_with_one_dim(path):
    raw(path, NOISE)


@case(".raw", "spacing", "--dims", "16", "20", "24", "--type", "uint8", "--spacing", "0")
def raw_without_extent(path):
    raw(path, NOISE)


@case(".nii", r"option type does not apply.*\(--type\)", "--type", "uint8")
def meaningless_option(path):
    nifti(path, NOISE)


@case(".tif", "not a readable TIFF")
def text_as_tiff(path):
    path.write_text("This is no volume.")


@case(".tif", "truncated|ends before")
def truncated_tiff(path):
    tifffile.imwrite(path, NOISE)
    cut(path, 0.6)


@case(".tif", "truncated|ends before")
def truncated_imagej(path):
    tifffile.imwrite(path, NOISE, imagej=True)
    cut(path, 0.6)


@case(".tif", "truncated|ends before")
def truncated_deflate(path):
    tifffile.imwrite(path, NOISE, compression="zlib", photometric="minisblack")
    cut(path, 0.6)


@case(".cube", "not a readable Gaussian cube")
def billions_of_atoms(path):
    path.write_text("a\nb\n-3000000000 0 0 0\n3 1 0 0\n3 0 1 0\n3 0 0 1\n1 2 3\n")


@case(".tif", "truncated|damaged")
def sizes_as_bytes(path):
    """Old versions of tifffile multiply these, to six gigabytes."""
    tag = struct.Struct("<HHLL").pack
    tags = tag(256, 1, 4, 8) + tag(257, 4, 1, 0x5E01DA00) + tag(258, 3, 1, 8)
    path.write_bytes(b"II*\0\x08\0\0\0" + struct.pack("<H", 3) + tags + bytes(4))


@case(".tif", r"one of 0..2 \(--channel\)\.")
def colour_tiff(path):
    tifffile.imwrite(path, np.stack([NOISE, NOISE, NOISE + 1], axis=-1), photometric="rgb")


@case(".tif", "three dimensions")
def single_page(path):
    tifffile.imwrite(path, NOISE[0])


@case(".tif", r"one of 0..1 \(--frame\)\.")
def tiff_of_4_dimensions(path):
    tifffile.imwrite(path, np.stack([NOISE, NOISE]))


@case("", "holds no slices as DICOM, TIFF")
def empty_folder(path):
    path.mkdir()


@case("", "of one size")
def slices_of_two_sizes(path):
    path.mkdir()
    tifffile.imwrite(path / "1.tif", NOISE[0])
    tifffile.imwrite(path / "2.tif", NOISE[0, :-1])


@case(".vdb", "")
def text_as_vdb(path):
    path.write_text("This is no volume.")


NRRD = "NRRD0004\ntype: uint8\ndimension: {n}\nsizes: {sizes}\nencoding: raw\n{more}\n"


def nrrd(path, sizes=(16, 20, 24), more=""):
    header = NRRD.format(n=len(sizes), sizes=" ".join(map(str, sizes)), more=more)
    path.write_bytes(header.encode() + NOISE.tobytes())


@case(".nrrd", "")
def text_as_nrrd(path):
    path.write_text("This is no volume.")


@case(".nrrd", "")
def nrrd_claims_more(path):
    nrrd(path, sizes=(100000, 100000, 100000))


@case(".nrrd", "")
def truncated_nrrd(path):
    nrrd(path)
    cut(path, 0.6)


@case(".nrrd", "")
def nrrd_of_4_dimensions(path):
    nrrd(path, sizes=(2, 8, 20, 24))


@case(".nhdr", "")
def nhdr_without_its_data(path):
    nrrd(path, more="data file: nowhere.bin\n")


@pytest.mark.parametrize("name", sorted(CASES))
def test_bad_input(name, tmp_path, cli):
    write, suffix, sentence, options = CASES[name]
    path = tmp_path / f"bad{suffix}"
    write(path)
    before = sorted(tmp_path.rglob("*"))
    out = tmp_path / "out.vdb"
    for arguments in (["info", path], ["bake", path, "--out", out]):
        outcome = cli(*arguments, *options)
        assert outcome.status == 2
        assert outcome.out == ""
        assert outcome.err.count("\n") == 1 and outcome.err.startswith("leaflight: ")
        assert len(outcome.err) < 400
        assert str(path) in outcome.err
        assert re.search(sentence, outcome.err), outcome.err
    assert sorted(tmp_path.rglob("*")) == before


def test_an_absent_package_is_named(tmp_path, cli, monkeypatch):
    # In the process that reads.
    monkeypatch.setattr(reader_process, "PACKAGES", [])
    (tmp_path / "h5py.py").write_text("raise ModuleNotFoundError(name='h5py')\n")
    monkeypatch.syspath_prepend(tmp_path)
    path = tmp_path / "x.h5"
    path.write_bytes(b"")
    outcome = cli("info", path)
    assert outcome.status == 2 and outcome.err.count("\n") == 1
    assert "needs the Python package h5py, which is not installed; run '" in outcome.err
    assert "HDF5 file" in outcome.err and str(path) in outcome.err


def test_options_of_the_command_line_reach_the_reader(tmp_path, cli):
    path = tmp_path / "x.npz"
    np.savez(path, g=np.stack([NOISE, NOISE + 1]), h=NOISE)
    options = ("--dataset", "g", "--frame", "1", "--downsample", "2", "--spacing", "3", "--json")
    outcome = cli("info", path, *options)
    result = json.loads(outcome.out.splitlines()[-1])
    assert result["dims"] == [8, 10, 12] and result["spacing"] == [6, 6, 6]
    assert "(--dataset)." in cli("info", path).err
    assert "(--channel)." in cli("info", path, "--dataset", "h", "--channel", "1").err


def test_what_cannot_fit_is_refused_before_it_is_allocated(tmp_path, cli, monkeypatch):
    # However much there is.
    monkeypatch.setattr(reading, "machine_memory", lambda: 2**34)
    path = tmp_path / "x.raw"
    with open(path, "wb") as file:
        # A file of holes.
        file.truncate(2**42)
    dims = ("--dims", 2**14, 2**14, 2**14, "--type", "uint8")
    outcome = cli("info", path, *dims)
    assert outcome.status == 2 and "need 4398.0 GB of memory" in outcome.err
    assert outcome.err.endswith(
        "downsample the volume, or limit the memory, so that it is stored on disk (--downsample).\n"
    )


def test_a_name_that_no_kind_of_file_has_is_a_type_error(tmp_path):
    path = tmp_path / "x.raw"
    raw(path, NOISE)
    for read in (reading.read_volume, reading.probe):
        with pytest.raises(TypeError, match="'value_type'; there are dims, type, "):
            read(path, dims=(16, 20, 24), value_type="uint8")
