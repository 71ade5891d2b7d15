# SPDX-License-Identifier: GPL-3.0-or-later
"""AFNI datasets through nibabel: a text .HEAD, and the values in .BRIK or .BRIK.gz."""

import io
from pathlib import Path

import numpy as np
from nibabel.brikhead import AFNIArrayProxy, AFNIHeader, AFNIImageError

from ..._core import LeaflightError, Progress
from ...arrays import Array
from .scans import Scan, stored_scan
from .stored import StoredVolume
from .watched import open_watched

# Upper bound on the bytes of a header, which may contain a long history.
_MOST = 1 << 24


def open_volume(path: Path) -> StoredVolume:
    """Opens a dataset. Sub-bricks are frames. Values that the header scales become float32."""
    head, brick = _files(path)
    with open(head, "rb") as file:
        text = file.read(_MOST).decode("latin-1").replace("\r\n", "\n")
    try:
        header = AFNIHeader.from_fileobj(io.StringIO(text.strip()))
        shape = tuple(int(size) for size in header.get_data_shape())
        dtype, affine = header.get_data_dtype(), header.get_affine()
        factors = header.get_data_scaling()
    except AFNIImageError as error:
        # nibabel raises this for values of several types, or of an unknown type.
        raise LeaflightError(
            f"{path}: nibabel cannot read it ({str(error)[:80]}); convert it to NIfTI first."
        ) from None

    def scaled(place: tuple[int, ...], progress: Progress) -> Array:
        with open_watched(brick, progress) as opened:
            stored = AFNIArrayProxy(opened, header, mmap=False)
            values: Array = stored[..., place[0] if place else 0]
        return values

    return stored_scan(
        path,
        Scan(
            file=brick,
            offset=0,
            shape=shape,
            dtype=dtype,
            affine=np.asarray(affine, np.float64),
            scaled=None if factors is None else scaled,
        ),
    )


def _files(path: Path) -> tuple[Path, Path]:
    """Returns the files of the header and of the values. Either may be given."""
    stem = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    heads = [stem.with_suffix(suffix) for suffix in (".HEAD", ".head")]
    bricks = [stem.with_suffix(suffix) for suffix in (".BRIK", ".BRIK.gz", ".brik", ".brik.gz")]
    found = []
    for files in (heads, bricks):
        files = [path] if path in files else files
        existing = [file for file in files if file.is_file()]
        if not existing:
            raise LeaflightError(
                f"{path}: the file {files[0].name} is missing; put it beside the other one."
            )
        found.append(existing[0])
    return found[0], found[1]
