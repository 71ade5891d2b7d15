# SPDX-License-Identifier: GPL-3.0-or-later
"""The registry of formats: the reader of each, and its options."""

from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from ..._core import LeaflightError
from ...paths import AnyPath
from ...volume.setting_error import SettingError
from .checks import listed
from .file_names import visible
from .sniffing import DIRECTORY, holds_dicom, is_dicom, module_of


@dataclass(frozen=True)
class Format:
    """One format of files.

    name: Name for display.
    module: Module of this package whose open_volume(path, **options) reads it.
    suffixes: Suffixes in lower case.
    options: Options of read_volume() that open_volume() takes.
    names: Patterns of names without a suffix.
    """

    name: str
    module: str
    suffixes: tuple[str, ...]
    options: frozenset[str] = frozenset()
    names: tuple[str, ...] = ()


def _format(name: str, module: str, suffixes: str, *options: str, names: str = "") -> Format:
    parts = tuple(suffixes.split()), frozenset(options), tuple(names.split())
    return Format(name, module, *parts)


# Match parts of names, because programs add prefixes and suffixes.
_OF_VASP = "*CHGCAR* CHG CHG.gz *AECCAR* *PARCHG* *LOCPOT* *ELFCAR*"
_OF_MRC = ".mrc .ccp4 .map .mrcs .rec .st .ali .mrc.gz .ccp4.gz .map.gz .mrcs.gz .rec.gz"
_OF_RAW = ("dims", "type", "endian", "spacing", "skip")
FORMATS = (
    _format("NIfTI file", "nifti", ".nii .nii.gz"),
    _format("NIfTI or Analyze pair", "nifti", ".hdr .img .hdr.gz .img.gz"),
    _format("FreeSurfer volume", "freesurfer", ".mgz .mgh .mgh.gz"),
    _format("MINC file", "minc", ".mnc .mnc.gz"),
    _format("AFNI dataset", "afni", ".head .brik .brik.gz"),
    _format("MRtrix image", "mrtrix", ".mif .mif.gz .mih"),
    _format("AmiraMesh lattice", "amira", ".am", "dataset"),
    _format("NRRD file", "nrrd", ".nrrd .nhdr"),
    _format("MetaImage", "metaimage", ".mhd .mha"),
    _format("DICOM series", "dicom", ".dcm .dicom .ima", "dataset", names="DICOMDIR"),
    _format("MRC or CCP4 map", "mrc", _OF_MRC),
    _format("VTK image", "vti", ".vti .pvti", "dataset"),
    _format("legacy VTK file", "vtk_legacy", ".vtk", "dataset"),
    _format("OpenDX map", "opendx", ".dx .dx.gz"),
    _format("VASP file", "vasp", ".vasp .vasp.gz", names=_OF_VASP),
    _format("XSF file", "xsf", ".xsf .xsf.gz", "dataset"),
    _format("DSN6 or BRIX map", "dsn6", ".dsn6 .brix .omap .dsn6.gz .brix.gz .omap.gz"),
    _format("MTZ file", "mtz", ".mtz .mtz.gz", "dataset"),
    _format("TIFF file", "tiff", ".tif .tiff .ome .lsm .btf .tf8", "dataset", "spacing"),
    _format("picture", "pictures", ".png .jpg .jpeg .bmp", "dataset", "spacing"),
    _format("CZI file", "czi", ".czi", "dataset", "spacing"),
    _format("LIF file", "lif", ".lif", "dataset", "spacing"),
    _format("ND2 file", "nd2_file", ".nd2", "dataset", "spacing"),
    _format("OME-Zarr folder", "ome_zarr", ".zarr", "dataset", "level"),
    _format("HDF5 file", "hdf5", ".h5 .hdf5 .hdf .ims .nxs", "dataset", "level", "spacing"),
    _format("netCDF file", "netcdf", ".nc .nc4", "dataset", "spacing"),
    _format("NumPy file", "numpy_file", ".npy .npz", "dataset", "spacing"),
    _format("Gaussian cube", "cube", ".cube .cube.gz .cub .cub.gz"),
    _format("OpenVDB file", "vdb", ".vdb", "grid"),
    _format("file without a header", "raw", ".raw .vol .bin .dat", *_OF_RAW),
    _format("table of points", "csv_points", ".csv", "dims"),
    _format("point cloud", "ply_points", ".ply", "dims", "dataset"),
)
SUFFIXES = tuple(suffix for kind in FORMATS for suffix in kind.suffixes)
# Number of files of a folder that are opened to detect a series.
_LOOKED_AT = 100
# Factor by which slices must outnumber the pictures beside them.
_MANY_TIMES = 3
# Upper bound on pictures that are ignored above folders of DICOM files.
_FEW = 2
_OF_SLICES = {"dicom": "DICOM", "tiff": "TIFF", "pictures": "PNG, JPEG or BMP"}
# Upper bounds on the suffixes in an error, and on the letters of a pattern of name_patterns().
_NAMED, _IN_BRACKETS = 16, 9
_BY_MODULE = {kind.module: kind for kind in FORMATS}
# Reads any file whose dimensions and type are given.
RAW = _BY_MODULE["raw"]


def name_patterns() -> str:
    """Returns patterns of the names of FORMATS for Blender's file browser, separated by ";".

    The browser takes 255 characters, and 15 for a pattern. So suffixes with the same first letter
    share a pattern such as *.n[hir]*, which also matches a few others.
    """
    letters: dict[str, list[str]] = {}
    for suffix in sorted(SUFFIXES):
        if suffix[2] not in letters.setdefault(suffix[1], []):
            letters[suffix[1]].append(suffix[2])
    patterns = [
        f"*.{first}[{''.join(second[at : at + _IN_BRACKETS])}]*"
        for first, second in letters.items()
        for at in range(0, len(second), _IN_BRACKETS)
    ]
    names = [pattern.strip("*") for kind in FORMATS for pattern in kind.names]
    return ";".join([*patterns, *(f"*{name}*" for name in names if "." not in name)])


def format_of(path: AnyPath) -> Format:
    """Returns the Format of a file by its name, of a folder by its files. Raises LeaflightError."""
    path = Path(path)
    name = path.name.lower()
    found = [
        (suffix, kind) for kind in FORMATS for suffix in kind.suffixes if name.endswith(suffix)
    ]
    if path.is_dir():
        return _of_folder(path)
    # Prefer the longest suffix: .nii.gz before .gz.
    kind = max(found, key=lambda pair: len(pair[0]))[1] if found else RAW
    if kind is not RAW:
        return kind
    for other in FORMATS:
        if any(fnmatchcase(path.name, pattern) for pattern in other.names):
            return other
    # Check the content, because files without a header may have the suffix of another format.
    module = "dicom" if is_dicom(path) else module_of(path)
    if module in _BY_MODULE:
        return _BY_MODULE[module]
    if found:
        return kind
    known = listed([suffix for suffix in SUFFIXES if not suffix.endswith(".gz")], _NAMED)
    raise SettingError(
        f"{path}: the suffix {path.suffix or '(none)'} and the content are unknown; open {known} "
        "or folders of slices (docs/formats.md), or give the dimensions and the type of raw "
        "values.",
        "dims",
        "type",
    )


def _of_folder(path: Path) -> Format:
    """Returns the Format of most files of a folder, without hidden ones and a few others."""
    if any((path / entry).exists() for entry in (".zgroup", ".zarray", "zarr.json")):
        return _BY_MODULE["ome_zarr"]
    entries = visible(path)
    if any(entry.name.lower() == DIRECTORY for entry in entries):
        return _BY_MODULE["dicom"]
    counts = {
        module: sum(entry.suffix.lower() in _BY_MODULE[module].suffixes for entry in entries)
        for module in _OF_SLICES
    }
    without = [entry for entry in entries if not entry.name.lower().endswith(SUFFIXES)]
    looked_at = without[:_LOOKED_AT]
    if looked_at:
        share = sum(map(is_dicom, looked_at)) / len(looked_at)
        counts["dicom"] += round(share * len(without))
    (most, first), (second, others) = sorted(counts.items(), key=lambda kind: -kind[1])[:2]
    # The slices may be only in folders within it, with pictures above them.
    if first <= _FEW and (first == 0 or most != "dicom") and holds_dicom(path):
        return _BY_MODULE["dicom"]
    if first == 0:
        raise LeaflightError(
            f"{path}: this folder holds no slices as DICOM, TIFF, PNG, JPEG or BMP, and no "
            "OME-Zarr; choose another folder."
        )
    # Pictures beside DICOM files are previews.
    if first < (1 if most == "dicom" else _MANY_TIMES) * others:
        raise LeaflightError(
            f"{path}: this folder holds {first} {_OF_SLICES[most]} files and {others} "
            f"{_OF_SLICES[second]} files; keep only the slices of one volume."
        )
    return _BY_MODULE[most]


def left_out(path: Path, kind: Format) -> tuple[str, ...]:
    """Returns a note about slices of other formats in a folder of slices."""
    suffixes = {
        suffix
        for module in _OF_SLICES
        for suffix in _BY_MODULE[module].suffixes
        if kind.module in _OF_SLICES and module != kind.module
    }
    names = [entry.name for entry in visible(path) if entry.suffix.lower() in suffixes]
    if not names:
        return ()
    return (f"Files of other kinds in the folder are left out: {listed(sorted(names))}.",)
