# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders with one picture per slice."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from ..._core import LeaflightError
from ...arrays import Array
from .checks import check_scalar, text
from .file_names import Slices, sequences
from .stack import Blocks, Stack, has_depth, stack_of, stored
from .stored import StoredVolume


def open_slices(
    folder: Path,
    files: Sequence[Path],
    read: Callable[[Path], Array],
    dataset: str | None = None,
    spacing: float | Sequence[float] | None = None,
    notes: Sequence[str] = (),
) -> StoredVolume:
    """Opens the volume of the slices in a folder. Raises LeaflightError.

    files: Slices, and other pictures.
    read: Function that returns the pixels of a file, [y, x] or RGB [y, x, s].
    dataset: Common part of the names of one of several volumes.
    """
    found = sequences(folder, files)
    volumes = [(one.name, partial(_stack, one, read, tuple(notes))) for one in found]
    return stored(folder, volumes, dataset, spacing)


def _stack(slices: Slices, read: Callable[[Path], Array], notes: tuple[str, ...]) -> Stack:
    first = read(slices.files[0])
    check_scalar(slices.files[0], first.dtype)

    @contextmanager
    def reading(_numbers: Sequence[int]) -> Iterator[Callable[[int], Array]]:
        def read_slice(k: int) -> Array:
            pixels = read(slices.files[k])
            if pixels.shape != first.shape:
                raise LeaflightError(
                    f"{slices.files[k]}: the slice is {_dims(pixels)}, but the first slice of the "
                    f"folder is {_dims(first)}; keep slices of one size."
                )
            return pixels

        yield read_slice

    inner = tuple(zip("YXS", first.shape))
    if not has_depth((*slices.axes, *inner)):
        raise LeaflightError(
            f"{slices.files[0]}: the folder has only this slice, but a volume needs several; "
            "choose another folder."
        )
    blocks = Blocks(slices.axes, inner, first.dtype, reading, 3, first.ndim == 3)
    return stack_of(slices.files[0].parent, blocks, None, (*notes, *slices.notes))


def _dims(pixels: Array) -> str:
    size = text(pixels.shape[1::-1])
    return f"{size} in color" if pixels.ndim == 3 else size
