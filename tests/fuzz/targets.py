# SPDX-License-Identifier: GPL-3.0-or-later
"""The targets of the fuzzer: all code that reads a file from elsewhere.

Each target has generated seeds and the command that reads such a file. A command may succeed, or
refuse the file with one sentence and exit with 2. Failures are any other exception, a crash, more
than a minute, or memory out of proportion.
"""

import contextlib
import io
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "python")]

import numpy as np  # noqa: E402
from leaflight_command import main  # noqa: E402

# Maximum length of a command's message about a bad file, in characters.
LONGEST_SENTENCE = 600


@dataclass(frozen=True)
class Target:
    """A command that reads a kind of file, and seeds for it.

    name: the name on the command line
    suffix: the suffix of its files
    seeds: seeds(folder) returns the bytes of the files
    arguments: arguments of the command; FILE is the file, and OUT is a file that it may write
    within: the name of the file within a folder that is the volume, "" if the file is the volume
    slow: True if each try starts a process or bakes
    """

    name: str
    suffix: str
    seeds: Callable[[Path], list]
    arguments: tuple
    within: str = ""
    slow: bool = False


def check(target, folder, data, good=False):
    """Runs the target's command on a file of these bytes; returns whether it was accepted.

    good: True if it must be accepted. Raises AssertionError, or the command's exception, after a
    failure.
    """
    path = folder / f"input{target.suffix}"
    file = path / target.within if target.within else path
    file.write_bytes(data)
    out = folder / "output"
    places = {"FILE": str(path), "OUT": f"{out}.vdb", "MESH": f"{out}.ply", "TEXTURE": f"{out}.exr"}
    arguments = [places.get(argument, argument) for argument in target.arguments]
    said, complained = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        status = main(arguments)
    said, complained = said.getvalue(), complained.getvalue()
    if status == 0:
        assert "NaN" not in said and "Infinity" not in said, said
        return True
    assert not good, f"a good file is refused: {complained}"
    lines = complained.splitlines()
    assert status == 2 and said == "" and len(lines) == 1, (status, said, complained)
    assert len(lines[0]) < LONGEST_SENTENCE and lines[0].startswith("leaflight: "), lines
    return False


def _of_tests(name):
    """Returns the seeds of the tests of damaged files."""

    def seeds(folder):
        from test_damaged_files import FORMATS

        path = folder / name
        data = [FORMATS[name](path)]
        path.unlink(missing_ok=True)
        return data

    return seeds


def _nrrd(folder):
    import bz2
    import gzip

    from test_damaged_files import NRRD, VALUES

    data = VALUES.tobytes()
    packed = {
        b"raw": data,
        b"gzip": gzip.compress(data, mtime=0),
        b"bzip2": bz2.compress(data),
        b"hex": data.hex().encode(),
        b"ascii": " ".join(map(str, data)).encode(),
    }
    seeds = [NRRD.replace(b"raw", name) + text for name, text in packed.items()]
    plain = NRRD.split(b"space:")[0]
    seeds.append(plain + b"spacings: 1 2 nan\nline skip: 0\nbyte skip: -1\n\n" + data)
    ends = (
        b'axis mins: 0 1 2\naxis maxs: 4 8 nan\ncenterings: cell node cell\nunits: "mm" "um" "m"\n'
    )
    seeds.append(plain.replace(b"raw", b"gzip") + ends + b"\n" + packed[b"gzip"])
    four = plain.replace(b"dimension: 3", b"dimension: 4").replace(b"8 7 6", b"1 8 7 6")
    layers = four.replace(b"1 8 7 6", b"2 4 7 6") + b"kinds: list domain domain domain\n"
    layers += b"Segment0_Name:=a\nSegment0_Color:=1 0 0.5\nSegment0_LabelValue:=3\n"
    layers += b"Segment0_Layer:=0\nSegment1_LabelValue:=4\nSegment1_Layer:=1\n\n" + data
    return [*seeds, four + b"kinds: vector domain domain domain\n\n" + data, layers]


def _detached_nrrd(folder):
    from test_damaged_files import NRRD, VALUES

    (folder / "values.raw").write_bytes(VALUES.tobytes())
    header = NRRD.rstrip() + b"\ndata file: "
    return [
        header + b"values.raw\n# note\nkey:=value\n",
        header + b"LIST 2\n" + _spread(folder),
        header.replace(b"raw", b"gzip") + b"plane%d.gz 1 6 1\nbyte skip: -1\n",
    ]


def _metaimage(folder):
    from test_damaged_files import VALUES, metaimage

    packed = metaimage(folder)
    text = packed[: packed.index(b"LOCAL\n") + 6].replace(b"CompressedData", b"BinaryData = 0\nX")
    local = text + " ".join(map(str, VALUES.ravel())).encode()
    header = text.split(b"BinaryData")[0] + b"HeaderSize = -1\nElementType = MET_UCHAR\n"
    header += b"ElementDataFile = "
    return [packed, local, header + b"LIST\n" + _spread(folder), header + b"plane%d.raw 1 6 1\n"]


def _spread(folder):
    """Writes each plane to a separate file; returns the lines that name the files."""
    import gzip

    from test_damaged_files import VALUES

    for k, plane in enumerate(VALUES.reshape(6, -1), 1):
        (folder / f"plane{k}.raw").write_bytes(plane.tobytes())
        (folder / f"plane{k}.gz").write_bytes(gzip.compress(plane.tobytes()))
    return b"".join(b"plane%d.raw\n" % k for k in range(1, 7))


def _legacy_vtk(_folder):
    from test_damaged_files import VALUES
    from test_reader_vtk_legacy import HEADER, by_hand

    field = HEADER.format("ASCII", "3 2 2") + "FIELD f 2\na 1 1 int\n7\ns 1 1 string\nb\n"
    field += "METADATA\nINFORMATION 0\n\nCELL_DATA 2\nVECTORS v float\n1 2 3 4 5 6\n"
    field += "POINT_DATA 12\nFIELD g 1\nu 1 12 double\n" + "nan 1e3 -2 0.5 " * 3
    kinds = (("ASCII", "int"), ("BINARY", "unsigned_char"))
    return [*(by_hand(VALUES, *kind) for kind in kinds), field.encode()]


def _opendx(_folder):
    from test_damaged_files import VALUES
    from test_reader_chemistry import opendx

    binary = opendx(VALUES, "lsb ieee data follows", "byte").partition("follows")[0] + "follows\n"
    return [opendx(VALUES).encode(), binary.encode() + VALUES.tobytes()]


def _vasp(_folder):
    from test_reader_chemistry import vasp

    small = np.arange(60.0).reshape(3, 4, 5)
    return [vasp(small).encode(), vasp(small, selective=True, scale="-50").encode()]


def _xsf(_folder):
    from test_reader_chemistry import xsf

    return [xsf(("rho", np.arange(60.0).reshape(3, 4, 5))).encode()]


def _maps_of_bytes(_folder):
    from test_damaged_files import VALUES
    from test_reader_crystals import brix, dsn6

    return [dsn6(VALUES), dsn6(VALUES, "<"), brix(VALUES)]


def _mtz(folder):
    from test_reader_crystals import mtz

    mtz(folder / "seed.mtz", [("FWT", "F", [30, 20, 10]), ("PHWT", "P", [10, 100, 50])])
    return [(folder / "seed.mtz").read_bytes()]


def _cubes(folder):
    glued = "a\nb\n-1 0 0 0\n2 1 0 0\n4 0 1 0\n2 0 0 1\n1 1 0 0 0\n1 7\n"
    glued += "\n".join(["-1.20000E-100-1.30000E-101 1.0D+00 0.5-100"] * 4)
    return [*_of_tests("x.cube")(folder), glued.encode()]


def _pieces(folder):
    from test_damaged_files import VALUES
    from test_reader_vti import vti

    (folder / "piece.vti").write_bytes(vti(VALUES, "UInt8", "ascii", compressed=False))
    piece = '<Piece Extent="0 7 0 6 0 5" Source="piece.vti"/>'
    image = f'<PImageData WholeExtent="0 7 0 6 0 5" Spacing="1 2 3">{piece}</PImageData>'
    return [f'<VTKFile type="PImageData">{image}</VTKFile>'.encode()]


def _unnamed(folder):
    """Returns files whose contents, not their names, show the format."""
    names = ("x.nrrd", "x.vti", "x.cube", "x.vtk", "x.dx", "LOCPOT", "x.xsf", "x.brix", "x.npy")
    return [_of_tests(name)(folder)[0] for name in names]


def _mgh(folder):
    import gzip
    import struct

    import nibabel
    from test_damaged_files import VALUES

    data = nibabel.MGHImage(VALUES.T.astype(np.int16), np.eye(4)).to_bytes()
    # A command line, and a color table with one label.
    tags = struct.pack(">iq4s", 3, 4, b"mri") + struct.pack(">4i2si", 1, -2, 9, 2, b"x", 1)
    tags += struct.pack(">2i2s4i", 3, 2, b"a", 255, 0, 0, 0)
    return [data, gzip.compress(data, mtime=0), data + tags]


def _analyze(folder):
    import nibabel
    from test_damaged_files import VALUES

    seeds = []
    for kind in (nibabel.AnalyzeImage, nibabel.Nifti1Pair, nibabel.Nifti2Pair):
        nibabel.save(kind(VALUES.T, None), folder / "input.img")
        seeds.append((folder / "input.hdr").read_bytes())
    return seeds


def _afni(folder):
    from test_damaged_files import VALUES
    from test_reader_scans import afni_head

    (folder / "input.BRIK").write_bytes(VALUES.tobytes())
    texts = [afni_head(types=(0,), factors=(factor,)) for factor in (0, 0.5)]
    return [text.replace("6 5 4", "8 7 6").encode() for text in texts]


def _minc(_folder):
    import nibabel
    import pytest

    files = [Path(nibabel.__file__).parent / "tests" / "data" / "tiny.mnc"]
    files.append(files[0].with_name("minc2_1_scale.mnc"))
    if not all(file.exists() for file in files):
        pytest.skip("nibabel's data are not here")
    return [file.read_bytes() for file in files]


def _mrtrix(_folder):
    import gzip

    from test_damaged_files import VALUES
    from test_reader_mrtrix import header

    data = VALUES.tobytes()
    plain = header((8, 7, 6), "-0,+2,-1", "UInt8").ljust(500) + data
    bits = header((8, 7, 6), "+0,+1,+2", "Bit", ". 500", "scaling: 1,2").ljust(500) + data
    return [plain, bits, gzip.compress(plain, mtime=0)]


def _amira(_folder):
    import zlib

    from test_damaged_files import VALUES
    from test_reader_amira import header, runs

    packed = {"": VALUES.tobytes(), "HxZip": zlib.compress(VALUES.tobytes())}
    packed["HxByteRLE"] = runs(VALUES.tobytes())
    seeds = []
    for name, data in packed.items():
        packing = f"({name},{len(data)})" if name else ""
        start = header(f"Lattice {{ byte Data }} @1{packing}").replace(b"6 5 4", b"8 7 6")
        seeds.append(start + b"@1\n" + data)
    text = header("Lattice { byte Data } @1", "AmiraMesh 3D ASCII 2.0").replace(b"6 5 4", b"8 7 6")
    return [*seeds, text + b"@1\n" + " ".join(map(str, VALUES.ravel())).encode()]


def _dicom(folder):
    """Returns a scan, a dose, a camera and segments; a scan without a preamble, deflated and
    packed.
    """
    import dicom_files as files
    from pydicom import uid
    from pydicom.encaps import encapsulate
    from test_damaged_files import VALUES, dicom

    path = folder / "seed.dcm"
    whole = dicom(path)
    seeds = [whole, files.bare(whole)]
    organs = [(n + 1, k, VALUES[k] > 99) for k in (0, 2, 3) for n in range(2)]
    vector = {"SpacingBetweenSlices": -2, "SliceVector": [1, 2, 3, 4, 5, 6]}
    pages = encapsulate([files.jpeg_2000(plane) for plane in VALUES])
    for write in (
        lambda: files.dose(path, VALUES, [0, 2, 4, 6, 8, 10]),
        lambda: files.camera(path, VALUES, **vector),
        lambda: files.segments(path, organs[::2], ["Liver"], SegmentationType="FRACTIONAL"),
        lambda: path.write_bytes(whole),
        lambda: files.edit(path, syntax=uid.DeflatedExplicitVRLittleEndian),
        lambda: path.write_bytes(whole),
        lambda: files.edit(path, PixelData=pages, syntax=uid.JPEG2000Lossless),
    ):
        write()
        seeds.append(path.read_bytes())
    path.unlink()
    return seeds


def _dicomdir(folder):
    from dicom_files import write_disc
    from test_damaged_files import VALUES

    disc = write_disc(folder, VALUES)
    (disc / "PT000000").rename(folder / "PT000000")
    return [(disc / "DICOMDIR").read_bytes()]


def _csv(_folder):
    points = np.random.default_rng(1).random((40, 4)).round(3)
    lines = [",".join(map(str, row)) for row in points]
    return ["\n".join(["x,y,z,density", *lines]).encode(), "\n".join(lines).encode()]


def _ply(folder):
    from test_reader_points import ply

    points = np.random.default_rng(1).random((40, 3))
    seeds = []
    for form in ("ascii", "binary_little_endian", "binary_big_endian"):
        ply(folder / "seed.ply", points, form, density=points[:, 0].astype(np.float32))
        seeds.append((folder / "seed.ply").read_bytes())
    return seeds


def _zarr(folder):
    from test_reader_zarr import ome_zarr

    values = np.random.default_rng(7).permutation(96).reshape(4, 4, 6).astype(np.float32)
    path = ome_zarr(folder / "input.zarr", values)
    return [(path / ".zattrs").read_bytes()]


def _zarr_array(folder):
    from test_reader_zarr import ome_zarr

    values = np.random.default_rng(7).permutation(96).reshape(4, 4, 6).astype(np.float32)
    path = ome_zarr(folder / "input.zarr", values)
    return [(path / "0" / ".zarray").read_bytes()]


def _by_hdf5(*names):
    """Returns files as other programs write HDF5, by functions of its tests."""

    def seeds(folder):
        import test_reader_hdf5

        values = np.random.default_rng(7).permutation(96).reshape(4, 4, 6).astype(np.uint16)
        data = []
        for name in names:
            getattr(test_reader_hdf5, name)(folder / "seed.h5", values)
            data.append((folder / "seed.h5").read_bytes())
        return data

    return seeds


def _ome_set(make, at):
    """Returns one file of a set of OME-TIFF, by its number in the set."""

    def seeds(folder):
        import test_reader_tiff

        path = folder / getattr(test_reader_tiff, make)(folder)[at]
        return [path.read_bytes()]

    return seeds


def _netcdf(folder):
    from test_reader_netcdf import classic, even

    values = np.random.default_rng(7).permutation(96).reshape(4, 4, 6).astype(np.float32)
    dimensions = {name: (even(2, n), {"units": "nm"}) for name, n in zip("zyx", values.shape)}
    path = classic(folder / "seed.nc", values, dimensions, _FillValue=np.float32(7))
    return [path.read_bytes()]


def _slices(suffix):
    def seeds(folder):
        from test_reader_slices import GRAY, save_all

        path = save_all(folder / f"input.slices{suffix}", f"{{}}{suffix}", GRAY)
        return [(path / f"8{suffix}").read_bytes()]

    return seeds


def _microscope(name):
    def seeds(folder):
        import microscope_files
        from test_reader_microscopes import PIXELS, needs

        needs({"czi": "pylibCZIrw", "lif": "liffile"}.get(name, name))
        path = folder / "seed"
        pixels = PIXELS[0, 0, 0]
        if name == "czi":
            microscope_files.czi(path, pixels[None, None])
        elif name == "lif":
            microscope_files.lif(path, {"a": ("ZYX", pixels)})
        else:
            microscope_files.nd2(path, "ZYXC", pixels[..., None])
        return [path.read_bytes()]

    return seeds


def _bake(folder):
    """Returns bakes without the seal, which would detect every change."""
    import leaflight
    from same_bytes import saved_alike

    settings = {"error": 50.0, "resolution": 9, "isovalues": (30.0, 70.0)}
    bake = leaflight.bake(leaflight.bump_box(9), both_sides=True, **settings)
    return [saved_alike(bake, folder / "seed.vdb")]


def _sealed_bake(folder):
    return [data + _seal(data) for data in _bake(folder)]


def _seal(data):
    import zlib

    mark = b"Leaflight\x1ae1"
    return mark + len(data).to_bytes(8, "little") + zlib.crc32(data).to_bytes(4, "little")


def _scenes(_folder):
    names = ("bump_box", "caustic", "lights", "mirror", "texture", "light_tent")
    return [(ROOT / "scenes" / f"{name}.json").read_bytes() for name in names]


def _flat_scenes(_folder):
    return [(ROOT / "scenes" / "flatland_bump_box.json").read_bytes()]


def _exr(folder):
    from leaflight import _core

    pixels = np.random.default_rng(4).random((9, 12, 3), np.float32)
    _core.write_exr(folder / "seed.exr", pixels, "a comment")
    return [(folder / "seed.exr").read_bytes()]


def _pictures(kind):
    def seeds(folder):
        from PIL import Image

        pixels = np.random.default_rng(4).integers(0, 255, (9, 12, 3)).astype(np.uint8)
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, kind)
        return [file.getvalue()]

    return seeds


_INFO = ("info", "FILE", "--json")
_BDV = (*_INFO, "--dataset", "s00", "--frame", "0")
_IMARIS = (*_INFO, "--frame", "0", "--channel", "0")
_POINTS = (*_INFO, "--dims", "8")
_FLAT = ("--error", "50", "--resolution", "4", "--out", "TEXTURE")
_TINY = ("bump_box", "--dims", "4", "--error", "50", "--resolution", "4")

TARGETS = (
    Target("nifti", ".nii", _of_tests("x.nii"), _INFO),
    Target("nifti-gz", ".nii.gz", _of_tests("x.nii.gz"), _INFO),
    Target("analyze", ".hdr", _analyze, _INFO),
    Target("freesurfer", ".mgz", _mgh, _INFO),
    Target("afni", ".HEAD", _afni, _INFO),
    Target("minc", ".mnc", _minc, _INFO, slow=True),
    Target("mrtrix", ".mif", _mrtrix, _INFO),
    Target("amira", ".am", _amira, _INFO),
    Target("nrrd", ".nrrd", _nrrd, _INFO),
    Target("nhdr", ".nhdr", _detached_nrrd, _INFO),
    Target("metaimage", ".mha", _metaimage, _INFO),
    Target("dicom", ".dcm", _dicom, _INFO),
    Target("dicomdir", ".dcm", _dicomdir, _INFO),
    Target("mrc", ".mrc", _of_tests("x.mrc"), _INFO),
    Target("vti", ".vti", _of_tests("x.vti"), _INFO),
    Target("tiff", ".tif", _of_tests("deflated.tif"), _INFO),
    Target("imagej", ".tif", _of_tests("imagej.tif"), _INFO),
    Target("ome-tiff", ".ome.tif", _of_tests("x.ome.tif"), _INFO),
    Target("ome-set", ".ome.tif", _ome_set("of_channels", 0), (*_INFO, "--channel", "1")),
    Target("ome-xml", ".companion.ome", _ome_set("of_companion", -1), (*_INFO, "--channel", "1")),
    Target("png-slices", ".slices.png", _slices(".png"), _INFO, within="8.png"),
    Target("jpeg-slices", ".slices.jpg", _slices(".jpg"), _INFO, within="8.jpg"),
    Target("bmp-slices", ".slices.bmp", _slices(".bmp"), _INFO, within="8.bmp"),
    Target("czi", ".czi", _microscope("czi"), _INFO, slow=True),
    Target("lif", ".lif", _microscope("lif"), _INFO, slow=True),
    Target("nd2", ".nd2", _microscope("nd2"), _INFO, slow=True),
    Target("ome-zarr", ".zarr", _zarr, (*_INFO, "--channel", "0"), within=".zattrs", slow=True),
    Target(
        "zarr-array",
        ".zarr",
        _zarr_array,
        (*_INFO, "--channel", "0"),
        within="0/.zarray",
        slow=True,
    ),
    Target("hdf5", ".h5", _of_tests("x.h5"), _INFO, slow=True),
    Target("scales", ".h5", _by_hdf5("scaled", "nexus"), _INFO, slow=True),
    Target("bdv", ".h5", _by_hdf5("big_data_viewer"), _BDV, slow=True),
    Target("imaris", ".ims", _by_hdf5("imaris"), _IMARIS, slow=True),
    Target("netcdf", ".nc", _netcdf, _INFO),
    Target("npy", ".npy", _of_tests("x.npy"), _INFO),
    Target("npz", ".npz", _of_tests("x.npz"), _INFO),
    Target("cube", ".cube", _cubes, _INFO),
    Target("pvti", ".pvti", _pieces, _INFO),
    Target("legacy-vtk", ".vtk", _legacy_vtk, _INFO),
    Target("opendx", ".dx", _opendx, _INFO),
    Target("vasp", ".vasp", _vasp, _INFO),
    Target("xsf", ".xsf", _xsf, _INFO),
    Target("dsn6", ".dsn6", _maps_of_bytes, _INFO),
    Target("mtz", ".mtz", _mtz, _INFO, slow=True),
    Target("unnamed", ".unnamed", _unnamed, _INFO),
    Target("csv", ".csv", _csv, _POINTS),
    Target("ply", ".ply", _ply, _POINTS),
    Target("vdb", ".vdb", _bake, _INFO, slow=True),
    Target(
        "bake", ".vdb", _bake, ("surface", "FILE", "--isovalue", "47", "--out", "MESH"), slow=True
    ),
    Target(
        "sealed-bake",
        ".vdb",
        _sealed_bake,
        ("surface", "FILE", "--isovalue", "47", "--out", "MESH"),
    ),
    Target(
        "scene", ".json", _scenes, ("bake", *_TINY, "--scene", "FILE", "--out", "OUT"), slow=True
    ),
    Target(
        "flat-scene",
        ".json",
        _flat_scenes,
        ("flatland", "bump_box", "--dims", "5", "--scene", "FILE", *_FLAT),
        slow=True,
    ),
    Target("exr", ".exr", _exr, ("flatland", "FILE", *_FLAT), slow=True),
    Target("png", ".png", _pictures("PNG"), ("flatland", "FILE", *_FLAT), slow=True),
    Target("jpeg", ".jpg", _pictures("JPEG"), ("flatland", "FILE", *_FLAT), slow=True),
)
BY_NAME = {target.name: target for target in TARGETS}


def missing_library(target):
    """Returns the missing library that a target needs here, or None."""
    import tempfile

    import pytest

    try:
        with tempfile.TemporaryDirectory() as folder:
            target.seeds(Path(folder))
    except (ImportError, pytest.skip.Exception) as problem:
        return str(problem)
    return None


def seeds_of(target, folder):
    """Returns good files. The folder also gets the files to which they refer."""
    os.makedirs(folder, exist_ok=True)
    return target.seeds(Path(folder))
