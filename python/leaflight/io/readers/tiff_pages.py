# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of a TIFF file through tifffile, each checked before it is read."""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from itertools import groupby
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import tifffile

from ..._core import Cancelled, LeaflightError
from ...arrays import Array
from ..reader_process import decoded, requests
from .checks import check_scalar, check_size, truncated

# Upper bound on the ratio of TIFF's compressions: 12-bit LZW expands 12 bits to 4 KB.
LZW_MOST = 4096
_RGB, _YCBCR = 2, 6
_NOT_COMPRESSED = 1
_ALPHAS = (1, 2)
if int(tifffile.__version__.partition(".")[0]) < 2025:
    # Older versions multiply sizes of damaged files as bytes objects, which take gigabytes.
    tifffile.tifffile.product = lambda sizes: prod(int(size) for size in sizes)


@contextmanager
def opened(path: Path) -> Iterator[tifffile.TiffFile]:
    """Opens a TiffFile.

    Damage that tifffile raises or logs is a LeaflightError.
    """
    damage = LeaflightError(
        f"{path}: this is not a readable TIFF file, or it is truncated or damaged; fetch it again."
    )
    complaints = _Complaints()
    log = logging.getLogger("tifffile")
    log.addHandler(complaints)
    propagate, log.propagate = log.propagate, False
    try:
        # ome.py reads the metadata of OME-TIFF.
        with tifffile.TiffFile(path, is_ome=False) as file:
            # Count the pages, which detects a cyclic chain. Iterating over one would not end.
            if len(file.pages) == 0:
                raise damage
            yield file
            if complaints.damage:
                raise damage
    except LeaflightError:
        if complaints.damage:
            raise damage from None
        raise
    except (Cancelled, ImportError, MemoryError, OSError):
        raise
    except Exception as error:
        # On damaged files tifffile raises many types, from KeyError to AssertionError and the XML
        # parser's own.
        if "requires the 'imagecodecs'" in str(error):
            # Compressions of microscopes, such as LZW and JPEG, need imagecodecs.
            raise ModuleNotFoundError(name="imagecodecs") from None
        raise damage from None
    finally:
        log.propagate = propagate
        log.removeHandler(complaints)


class _Complaints(logging.Handler):
    """A log handler that collects the complaints of tifffile.

    tifffile logs a broken chain of pages and continues with those before the break.
    """

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.damage = False

    def emit(self, record: logging.LogRecord) -> None:
        message = record.getMessage()
        self.damage |= record.levelno >= logging.ERROR or "invalid page offset" in message


def series_of(file: tifffile.TiffFile) -> list[Any]:
    """Returns the series of a file.

    tifffile writes a single picture as a series of one page. Consecutive series of one size and
    type are returned as one.
    """
    series = list(file.series)
    if len(series) == 1 or any(one.kind != "shaped" for one in series):
        return series

    def kind(one: Any) -> tuple[Any, ...]:
        # Stacks are never equal.
        alone = 0 if len(one) == 1 and len(one.shape) == 2 else id(one)
        return one.shape, one.dtype, one.keyframe.is_reduced, alone

    runs = [list(run) for _, run in groupby(series, kind)]
    return [run[0] if len(run) == 1 else _joined(run) for run in runs]


def _joined(run: list[Any]) -> Any:
    shape = (len(run), *run[0].shape)
    pages = [one.keyframe for one in run]
    return tifffile.TiffPageSeries(pages, shape, run[0].dtype, f"I{run[0].axes}", kind="uniform")


def check_pages(path: Path, pages: list[Any]) -> None:
    """Raises LeaflightError unless the file holds all bytes of these pages."""
    stored = 0
    for page in pages:
        check_scalar(path, page.dtype)
        size = page.parent.filehandle.size
        parts = list(zip(page.dataoffsets, page.databytecounts))
        # If bytes are missing, tifffile returns uninitialized memory.
        if len(parts) < prod(page.chunked) or any(sum(part) > size for part in parts):
            raise truncated(path, page.shape)
        stored += sum(count for _, count in parts)
    values = sum(prod(page.shape) for page in pages)
    check_size(path, (values,), pages[0].dtype.itemsize, stored, LZW_MOST)


def read_page(path: Path, page: Any) -> Array:
    """Reads a page. Checks it first, because tifffile's frames copy the header of another page."""
    page = page.aspage()
    check_pages(path, [page])
    if page.compression == _NOT_COMPRESSED:
        values: Array = page.asarray()
        return values
    where = page.index, page.offset
    return decoded(path, "TIFF file", (__name__, "decoded_pages"), page.nbytes, *where)


def decoded_pages(_path: Path) -> tuple[None, Iterator[Array]]:
    """Yields the pages of requests(). Runs in a subprocess, which imports imagecodecs."""

    def pages() -> Iterator[Array]:
        last: Path | None = None
        with ExitStack() as files:
            for name, number, offset in requests():
                if Path(name) != last:
                    files.close()
                    last = Path(name)
                    tiff = files.enter_context(opened(last))
                page = tiff.pages[number].aspage()
                if page.offset != offset:
                    # The page is within another page.
                    tiff.filehandle.seek(offset)
                    page = tifffile.TiffPage(tiff, number)
                yield np.ascontiguousarray(page.asarray())

    return None, pages()


def axes_of(page: Any) -> tuple[tuple[tuple[str, int], ...], int, bool]:
    """Returns the axes of a page for Blocks, the number of samples that are values, and colors."""
    count = dict(zip(page.axes, page.shape)).get("S", 1)
    alpha = sum(int(kind) in _ALPHAS for kind in page.extrasamples or ())
    colors = page.photometric in (_RGB, _YCBCR) and count >= 3
    samples = 3 if colors else max(1, count - alpha)
    name = "S" if colors or samples == 1 else "C"
    axes = tuple((name if a == "S" else a, int(n)) for a, n in zip(page.axes, page.shape))
    return axes, samples if name == "S" else 1, colors
