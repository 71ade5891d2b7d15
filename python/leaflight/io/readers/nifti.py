# SPDX-License-Identifier: GPL-3.0-or-later
"""NIfTI-1 and -2, and Analyze, through nibabel, in coordinates of the scanner or the template."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
from nibabel.arrayproxy import ArrayProxy
from nibabel.fileholders import FileHolder

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.setting_error import SettingError
from ...volume.units import unit_of
from .packing import scaled_type
from .scans import Scan, stored_scan
from .stored import StoredVolume
from .watched import open_head, open_watched

# Number of first bytes that distinguish the formats.
_SNIFFED = 348
# Unit by the lowest three bits of the header's field. The default is millimeters.
_UNITS = {0: "mm", 1: "m", 2: "mm", 3: "µm"}
_ODD_UNIT = "The header's code {code} for the unit of length is unknown; millimeters are assumed."
_SIDES = (
    "Analyze files do not say which side is left; the x axis is read from right to left, as in SPM."
)
_NOT_ORIENTED = (
    "The header has no orientation (its qform_code and sform_code are 0); the x axis is read from "
    "right to left, as in SPM."
)
# Magic bytes: a pair of files, or one.
_PAIRS = {
    **dict.fromkeys((b"n+1\0", b"ni1\0"), (nibabel.Nifti1Pair, nibabel.Nifti1Image)),
    **dict.fromkeys((b"n+2\0", b"ni2\0"), (nibabel.Nifti2Pair, nibabel.Nifti2Image)),
}


def open_volume(path: Path) -> StoredVolume:
    """Opens the values with their affine (sform, else qform), which may mirror.

    Values that the header scales become float32, or float64 if float32 would hide differences. The
    fifth axis, of vectors, counts channels.
    """
    header, file = _files(path)
    image = _image(header, file)
    proxy, shape, dtype = image.dataobj, image.shape, image.get_data_dtype()
    layout = (shape, dtype, proxy.offset, proxy.slope, proxy.inter)
    kind = scaled_type(dtype, proxy.slope, proxy.inter)

    def scaled(place: tuple[int, ...], progress: Progress) -> Array:
        index: tuple[slice | int, ...] = (*(slice(None),) * 3, *place)
        index += (0,) * (len(shape) - len(index))
        with open_watched(file, progress) as opened:
            stored = ArrayProxy(opened, layout, mmap=False)
            # If it reads the whole array, nibabel scales in float32 instead of float64.
            return np.asarray(stored, kind) if len(shape) == 3 else stored[index]

    unit, notes = _unit(image)
    is_analyze, patient = isinstance(image, nibabel.Spm2AnalyzeImage), True
    if is_analyze and not _matrix_file(header).exists():
        notes += (_SIDES,)
    elif not is_analyze and image.header["qform_code"] == image.header["sform_code"] == 0:
        # Such coordinates have no orientation (nifti1.h, method 1).
        notes, patient = (*notes, _NOT_ORIENTED), False
    return stored_scan(
        path,
        Scan(
            file=file,
            offset=int(proxy.offset),
            shape=shape,
            dtype=dtype,
            affine=np.array(image.affine, dtype=np.float64),
            scaled=None if (proxy.slope, proxy.inter) == (1, 0) else scaled,
            scaled_dtype=kind,
            unit=unit,
            patient=patient,
            notes=notes,
        ),
    )


def _files(path: Path) -> tuple[Path, Path]:
    """Returns the files of the header and of the values: one file, or .hdr and .img."""
    stem, packed = (path.with_suffix(""), True) if path.suffix.lower() == ".gz" else (path, False)
    kind = stem.suffix.lower()
    if kind not in (".hdr", ".img"):
        return path, path
    other = ".img" if kind == ".hdr" else ".hdr"
    other = other.upper() if stem.suffix.isupper() else other
    names = [stem.with_suffix(other).name, f"{stem.with_suffix(other).name}.gz"]
    found = [path.with_name(name) for name in (names[::-1] if packed else names)]
    beside = next((file for file in found if file.is_file()), None)
    if beside is None and kind == ".img":
        raise SettingError(
            f"{path}: the header {names[0]} is missing; put it beside the file, or give the "
            "dimensions and the type of the values.",
            "dims",
            "type",
        )
    if beside is None:
        raise LeaflightError(
            f"{path}: the values {names[0]} are missing; put them beside the header."
        )
    return (path, beside) if kind == ".hdr" else (beside, path)


def _image(header: Path, file: Path) -> Any:
    """Returns nibabel's image, with the header alone."""
    with _quiet_nibabel(), open_head(header) as opened:
        block = opened.read(_SNIFFED)
        opened.seek(0)
        pair = _PAIRS.get(block[344:348]) or _PAIRS.get(block[4:8])
        if header == file and pair is not None:
            image = pair[1].from_file_map({"image": FileHolder(fileobj=opened)}, mmap=False)
        else:
            kind = pair[0] if pair is not None else nibabel.Spm2AnalyzeImage
            files = {"header": FileHolder(fileobj=opened), "image": FileHolder(str(file))}
            files["mat"] = FileHolder(str(_matrix_file(header)))
            image = kind.from_file_map(files, mmap=False)
    if header == file and image.dataobj.offset < _SNIFFED:
        raise ValueError("Its values are said to lie within its header.")
    return image


def _matrix_file(header: Path) -> Path:
    """Returns the file in which SPM writes the axes that an Analyze header cannot hold."""
    place = header.name.lower().rindex(".hdr")
    return header.with_name(f"{header.name[:place]}.mat{header.name[place + len('.hdr') :]}")


def _unit(image: Any) -> tuple[str, tuple[str, ...]]:
    """Returns (unit of length, notes about it)."""
    if isinstance(image, nibabel.Spm2AnalyzeImage):
        word = bytes(image.header["vox_units"].item()).decode("latin-1")
        return unit_of(word) or "mm", ()
    code = int(image.header["xyzt_units"]) & 7
    return _UNITS.get(code, "mm"), () if code in _UNITS else (_ODD_UNIT.format(code=code),)


@contextmanager
def _quiet_nibabel() -> Iterator[None]:
    """Suppresses nibabel's log of harmless oddities of a header."""
    logger = nibabel.imageglobals.logger
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
