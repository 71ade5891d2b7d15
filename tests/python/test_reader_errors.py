# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests errors: one line that names file and remedy, exit status 2, nothing written."""

import gzip
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


NRRD = "NRRD0004\ntype: uint8\ndimension: {n}\nsizes: {sizes}\nencoding: raw\n{more}\n"


def nrrd(path, sizes=(16, 20, 24), more=""):
    header = NRRD.format(n=len(sizes), sizes=" ".join(map(str, sizes)), more=more)
    path.write_bytes(header.encode() + NOISE.tobytes())


def infinite(path):
    values = NOISE.astype(np.float32)
    values[3, 3, 3] = np.inf
    nifti(path, values)


def truncated(write, *arguments, **options):
    """Returns a function that writes the first part of a file."""

    def cut(path):
        write(path, *arguments, **options)
        data = path.read_bytes()
        path.write_bytes(data[: int(0.6 * len(data))])

    return cut


def sizes_as_bytes(path):
    """Writes a TIFF whose sizes, as bytes, old versions of tifffile multiply to six gigabytes."""
    tag = struct.Struct("<HHLL").pack
    tags = tag(256, 1, 4, 8) + tag(257, 4, 1, 0x5E01DA00) + tag(258, 3, 1, 8)
    path.write_bytes(b"II*\0\x08\0\0\0" + struct.pack("<H", 3) + tags + bytes(4))


def slices_of_two_sizes(path):
    path.mkdir()
    tifffile.imwrite(path / "1.tif", NOISE[0])
    tifffile.imwrite(path / "2.tif", NOISE[0, :-1])


def color_tiff(path):
    tifffile.imwrite(path, np.stack([NOISE, NOISE, NOISE + 1], axis=-1), photometric="rgb")


def frames_tiff(path):
    tifffile.imwrite(path, np.stack([NOISE, NOISE]))


def noise(path):
    raw(path, NOISE)


def text(path):
    path.write_text("This is no volume. " * 40)


def atoms(path):
    path.write_text("a\nb\n-3000000000 0 0 0\n3 1 0 0\n3 0 1 0\n3 0 0 1\n1 2 3\n")


FOUR = np.stack([NOISE] * 3, axis=-1)
HUGE = (30000, 30000, 30000)
COLORS = NOISE.astype([("R", "u1"), ("G", "u1"), ("B", "u1")])
DEFLATED = {"compression": "zlib", "photometric": "minisblack"}
DIMS = "--dims 16 20 24 --type "
write_tiff = tifffile.imwrite
# Cases by name: suffix, expected words, a function that writes the bad file, and options.
CASES = {
    "missing file": (".nii", "file", lambda path: None),
    "unknown kind": (".xyz", "suffix", text),
    "text as NIfTI": (".nii", "NIfTI", text),
    "empty NIfTI": (".nii", "NIfTI", lambda path: path.write_bytes(b"")),
    "truncated NIfTI": (".nii", "truncated|ends", truncated(nifti, NOISE)),
    "truncated gzip": (".nii.gz", "truncated|ends", truncated(nifti, NOISE)),
    "NIfTI claims more": (".nii", "truncated", lambda path: nifti(path, NOISE, claim=HUGE)),
    "gzip claims more": (".nii.gz", "truncated", lambda path: nifti(path, NOISE, claim=HUGE)),
    "four dimensions": (".nii", r"0..2 \(--frame\)", lambda path: nifti(path, FOUR)),
    "frame too high": (".nii", "frame 3", lambda path: nifti(path, FOUR), "--frame 3"),
    "frame of 3D": (".nii", r"\(--frame\)", lambda path: nifti(path, NOISE), "--frame 1"),
    "two dimensions": (".nii", "three dimensions", lambda path: nifti(path, NOISE[0])),
    "complex": (".nii", "complex", lambda path: nifti(path, NOISE.astype(np.complex64))),
    "colors": (".nii", "red, green, blue", lambda path: nifti(path, COLORS)),
    "constant": (".nii", "", lambda path: nifti(path, np.full_like(NOISE, 3))),
    "NaN": (".nii", "NaN", lambda path: nifti(path, np.full_like(NOISE, np.nan, np.float32))),
    "infinite": (".nii", "", infinite),
    "one slice": (".nii", "", lambda path: nifti(path, NOISE[:, :, :1])),
    "raw without layout": (".raw", r"\(--dims, --type\)", noise),
    "short raw": (".raw", "7680.*7670", lambda path: raw(path, NOISE.flat[:-10]), DIMS + "uint8"),
    "raw of another type": (".raw", "15360", noise, DIMS + "uint16"),
    "raw with one size": (".raw", "three", noise, "--dims 16 --type uint8"),
    "raw without extent": (".raw", "spacing", noise, DIMS + "uint8 --spacing 0"),
    "meaningless option": (".nii", r"\(--type\)", lambda path: nifti(path, NOISE), "--type uint8"),
    "text as TIFF": (".tif", "TIFF", text),
    "truncated TIFF": (".tif", "truncated|ends", truncated(write_tiff, NOISE)),
    "truncated ImageJ": (".tif", "truncated|ends", truncated(write_tiff, NOISE, imagej=True)),
    "truncated deflate": (".tif", "truncated|ends", truncated(write_tiff, NOISE, **DEFLATED)),
    "sizes as bytes": (".tif", "truncated|damaged", sizes_as_bytes),
    "color TIFF": (".tif", r"0..2 \(--channel\)", color_tiff),
    "single page": (".tif", "three dimensions", lambda path: write_tiff(path, NOISE[0])),
    "TIFF of 4 dimensions": (".tif", r"0..1 \(--frame\)", frames_tiff),
    "billions of atoms": (".cube", "Gaussian cube", atoms),
    "empty folder": ("", "slices", lambda path: path.mkdir()),
    "slices of two sizes": ("", "size", slices_of_two_sizes),
    "text as VDB": (".vdb", "", text),
    "text as NRRD": (".nrrd", "", text),
    "NRRD claims more": (".nrrd", "", lambda path: nrrd(path, sizes=(100000, 100000, 100000))),
    "truncated NRRD": (".nrrd", "", truncated(nrrd)),
    "NRRD of 4 dimensions": (".nrrd", "", lambda path: nrrd(path, sizes=(2, 8, 20, 24))),
    "NHDR without data": (".nhdr", "", lambda path: nrrd(path, more="data file: nowhere.bin\n")),
}


@pytest.mark.parametrize("name", CASES)
def test_bad_input(name, tmp_path, cli):
    suffix, named, write, *options = CASES[name]
    options = " ".join(options).split()
    path = tmp_path / f"bad{suffix}"
    write(path)
    before = sorted(tmp_path.rglob("*"))
    out = tmp_path / "out.vdb"
    for arguments in (["info", path], ["bake", path, "--out", out]):
        outcome = cli(*arguments, *options)
        assert outcome.status == 2 and outcome.out == "" and str(path) in outcome.err
        assert outcome.err.count("\n") == 1 and outcome.err.startswith("leaflight: ")
        assert len(outcome.err) < 400
        # Remove the path, because the folder has the name of the case.
        assert re.search(named, outcome.err.replace(str(path), "")), outcome.err
    assert sorted(tmp_path.rglob("*")) == before


def test_an_absent_package_is_named(tmp_path, cli, monkeypatch):
    # Test the process that reads files.
    monkeypatch.setattr(reader_process, "PACKAGES", [])
    (tmp_path / "h5py.py").write_text("raise ModuleNotFoundError(name='h5py')\n")
    monkeypatch.syspath_prepend(tmp_path)
    path = tmp_path / "x.h5"
    path.write_bytes(b"")
    said = cli.refuses("HDF5 file", "info", path)
    assert "h5py" in said and str(path) in said


def test_options_of_the_command_line_reach_the_reader(tmp_path, cli):
    path = tmp_path / "x.npz"
    np.savez(path, g=np.stack([NOISE, NOISE + 1]), h=NOISE)
    options = ("--dataset", "g", "--frame", "1", "--downsample", "2", "--spacing", "3")
    result = cli.json("info", path, *options)
    assert result["dims"] == [8, 10, 12] and result["spacing"] == [6, 6, 6]
    assert "(--dataset)." in cli("info", path).err
    assert "(--channel)." in cli("info", path, "--dataset", "h", "--channel", "1").err


def test_what_cannot_fit_is_refused_before_it_is_allocated(tmp_path, cli, monkeypatch):
    # Simulate the memory, whatever the machine has.
    monkeypatch.setattr(reading, "machine_memory", lambda: 2**34)
    path = tmp_path / "x.raw"
    with open(path, "wb") as file:
        file.truncate(2**42)
    dims = ("--dims", 2**14, 2**14, 2**14, "--type", "uint8")
    said = cli.refuses("4398.0 GB", "info", path, *dims)
    assert said.endswith("(--downsample).\n")


def test_a_name_that_no_kind_of_file_has_is_a_type_error(tmp_path):
    path = tmp_path / "x.raw"
    raw(path, NOISE)
    for read in (reading.read_volume, reading.probe):
        with pytest.raises(TypeError, match="'value_type'.* dims, type, "):
            read(path, dims=(16, 20, 24), value_type="uint8")
