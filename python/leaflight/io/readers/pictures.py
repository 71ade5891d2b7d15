# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders of slices as PNG, JPEG or BMP, through Pillow."""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ..._core import LeaflightError
from ...arrays import Array
from .checks import text
from .file_names import visible_files
from .slices import open_slices
from .stored import StoredVolume

SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp")
_KINDS = ("PNG", "JPEG", "BMP")


def open_volume(
    path: Path, dataset: str | None = None, spacing: float | Sequence[float] | None = None
) -> StoredVolume:
    """Opens a folder of slices. Without spacing the voxel size is 1."""
    if not path.is_dir():
        height, width = _pixels(path).shape[:2]
        raise LeaflightError(
            f"{path}: the file holds one picture of {text((width, height))} pixels, but a volume "
            "needs three dimensions; if this is one slice of many, open their folder."
        )
    files = visible_files(path, SUFFIXES)
    with _opened(files[0]) as image:
        palette, notes = _palette(image), _notes(image)
    return open_slices(path, files, partial(_pixels, palette=palette), dataset, spacing, notes)


def _pixels(path: Path, palette: bytes | None = None) -> Array:
    """Reads the pixels [y, x] or RGB [y, x, s] of a picture. Raises LeaflightError.

    palette: Palette of the first slice. Palette indices are values only if all slices share it.
    """
    with _opened(path) as image:
        if image.mode == "P" and not _is_gray(image):
            if palette is not None and _palette(image) != palette:
                raise LeaflightError(
                    f"{path}: the color palette differs from that of the first slice; convert all "
                    "slices to gray first."
                )
            return np.array(image)
        if image.mode.startswith("I"):
            # Pillow stores 16 bits in 32.
            return np.array(image).astype(np.uint16)
        if image.mode not in ("L", "RGB"):
            image = image.convert("L" if image.mode in ("1", "LA", "P") else "RGB")
        return np.array(image)


def _palette(image: Any) -> bytes | None:
    """Returns red, green and blue of each color, None without a palette."""
    return bytes(image.getpalette("RGB")) if image.mode == "P" else None


def _is_gray(image: Any) -> bool:
    palette = np.frombuffer(_palette(image) or b"", np.uint8).reshape(-1, 3)
    return bool((palette[:, :1] == palette).all())


def _notes(image: Any) -> tuple[str, ...]:
    """Returns notes about parts of such pictures that the volume leaves out."""
    if image.mode == "P" and not _is_gray(image):
        return ("The values are color indices of the palette of the pictures.",)
    if image.mode in ("RGB", "RGBA", "LA") and ";16" in image.info["stored"]:
        return ("Only the upper 8 of the 16 bits of each color are read.",)
    return ()


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Reads the whole picture in a file. Raises LeaflightError."""
    try:
        # Ignore Pillow's warning of a large picture; it raises an error for one that is far too
        # large.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(path, formats=_KINDS) as image:
                # Read the storage of the pixels first, because loading discards it.
                image.info["stored"] = str(image.tile)
                image.load()
                yield image
    except (LeaflightError, MemoryError):
        raise
    except Image.DecompressionBombError:
        raise LeaflightError(f"{path}: the picture is too large; use a smaller one.") from None
    except Exception:
        # On damaged files Pillow raises many types, from OSError to struct.error.
        raise LeaflightError(
            f"{path}: this is not a readable picture, or it is truncated or damaged; fetch it "
            "again."
        ) from None
