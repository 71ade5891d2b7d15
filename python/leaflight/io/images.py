# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as arrays: PNG and JPEG through Pillow, TIFF through tifffile, EXR through OpenEXR."""

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import LeaflightError, read_exr
from .._core import read_exr_comments as read_exr_comments
from .._core import write_exr as write_exr
from ..arrays import Array
from ..paths import AnyPath
from ..srgb import linear_from_srgb, srgb_from_linear
from .output import replaced

# Photometric interpretations (TIFF 6.0, page 37).
_WHITE_IS_ZERO, _PALETTE = 0, 3

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr")


def read_pixels(path: AnyPath) -> Array:
    """Returns the numbers as stored: [row, column] or [row, column, RGB], top row first.

    The type is uint8, uint16 or floating point. Larger numbers are brighter, and a palette gives
    RGB. Alpha is left out. Raises LeaflightError.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise LeaflightError(
            f"{path}: the suffix is not that of an image: choose one of {', '.join(SUFFIXES)}."
        )
    try:
        if not path.is_file():
            raise LeaflightError(f"{path}: there is no such image; check the path.")
        if suffix == ".exr":
            pixels = read_exr(path)
        elif suffix in (".tif", ".tiff"):
            pixels = _read_tiff(path)
        else:
            pixels = _read_with_pillow(path)
    except OSError as error:
        raise LeaflightError(f"{path}: cannot read it: {error.strerror or 'damaged'}.") from None
    except MemoryError:
        raise LeaflightError(f"{path}: the image is too large; use a smaller one.") from None
    if pixels.ndim == 3:
        pixels = pixels[..., 0] if pixels.shape[2] < 3 else pixels[..., :3]
    return pixels


def read_texture(path: AnyPath) -> Array:
    """Returns linear RGB, float32 [row, column, 3], bottom row first. Integers are sRGB in the
    file.

    Raises LeaflightError.
    """
    pixels = read_pixels(path)
    if np.issubdtype(pixels.dtype, np.integer):
        encoded = pixels.astype(np.float32) / np.iinfo(pixels.dtype).max
        pixels = linear_from_srgb(encoded)
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    return np.ascontiguousarray(pixels[::-1], dtype=np.float32)


def luminance(pixels: Array) -> Array:
    """Returns the luminance of RGB by the weights of Rec. 709, float32 [row, column]; gray as it
    is.
    """
    # Values beyond single precision become infinite, which volumes refuse.
    with np.errstate(over="ignore", invalid="ignore"):
        gray = pixels if pixels.ndim == 2 else pixels @ np.array([0.2126, 0.7152, 0.0722])
        return gray.astype(np.float32)


def display_colors(radiance: ArrayLike, exposure: float) -> Array:
    """Returns uint8 sRGB of radiance (..., 3): times the exposure, clamped to 0..1, encoded."""
    linear = np.clip(np.asarray(radiance, dtype=np.float32) * np.float32(exposure), 0.0, 1.0)
    colors: Array = np.rint(255.0 * srgb_from_linear(linear)).astype(np.uint8)
    return colors


def png_bytes(path: AnyPath, pixels: Array) -> bytes:
    """Returns uint8 [row, column, RGB or RGBA], top row first, as PNG. path: Name in errors."""
    buffer = io.BytesIO()
    _pillow(path).fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def write_png(path: AnyPath, pixels: Array) -> None:
    """Writes a complete PNG or none."""
    content = png_bytes(path, pixels)
    with replaced(path) as temporary:
        temporary.write_bytes(content)


def _read_tiff(path: Path) -> Array:
    from .readers.tiff_pages import opened, read_page

    try:
        with opened(path) as file:
            page = file.pages[0]
            pixels = read_page(path, page)
            if page.axes.startswith("S"):
                # The planar configuration 2 stores each color on its own.
                pixels = np.moveaxis(pixels, 0, -1)
            if page.photometric == _WHITE_IS_ZERO and pixels.dtype.kind == "u":
                pixels = (1 << page.bitspersample) - 1 - pixels
            if page.photometric == _PALETTE:
                pixels = page.colormap.T[pixels]
    except ImportError as error:
        raise LeaflightError(
            f"{path}: this compression needs the Python package {error.name}, which is not "
            "installed; save the image uncompressed."
        ) from None
    if pixels.ndim not in (2, 3) or pixels.dtype.kind not in "uf":
        raise LeaflightError(
            f"{path}: the image is neither gray nor RGB, or not of unsigned integers or floating "
            "point: convert it first."
        )
    return pixels


def _pillow(path: AnyPath) -> Any:
    try:
        from PIL import Image
    except ImportError:
        raise LeaflightError(
            f"{path}: images need the Python package Pillow, which is not installed; install "
            "python3-pil."
        ) from None
    return Image


def _read_with_pillow(path: Path) -> Array:
    Image = _pillow(path)
    try:
        # Ignore Pillow's warning of a large image; it raises an error for one that is far too
        # large.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(path, formats=("PNG", "JPEG")) as image:
                if image.mode.startswith("I"):
                    return np.asarray(image).astype(np.uint16)
                if image.mode not in ("L", "RGB"):
                    image = image.convert("L" if image.mode in ("1", "LA") else "RGB")
                return np.asarray(image)
    except Image.DecompressionBombError:
        raise MemoryError from None
    except MemoryError:
        raise
    except Exception:
        # On damaged files Pillow raises many types, from OSError to struct.error.
        raise LeaflightError(
            f"{path}: this is not a readable image, or it is truncated or damaged; fetch it again."
        ) from None
