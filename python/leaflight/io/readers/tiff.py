# SPDX-License-Identifier: GPL-3.0-or-later
"""TIFF stacks of ImageJ, OME and other programs, and folders with one TIFF per slice."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from . import imagej, ome
from .channels import Channel, channel_of
from .checks import check_scalar, listed, text, truncated
from .file_names import visible_files
from .slices import open_slices
from .stack import Blocks, Stack, has_depth, picture, stack_of, stored
from .stored import StoredVolume
from .tiff_pages import axes_of, check_pages, opened, read_page, series_of
from .voxel_size import VoxelSize, voxel_size

SUFFIXES = (".tif", ".tiff")
# Pages that do not belong to a stack: previews, labels, pictures of the whole slide.
_MOST_EXTRA_PAGES = 2


def open_volume(
    path: Path, dataset: str | None = None, spacing: float | Sequence[float] | None = None
) -> StoredVolume:
    """Opens a stack, a set of OME-TIFF files by any of them, or a folder of slices.

    The voxel size comes from spacing, else from the metadata of the file, else it is 1.
    """
    if path.is_dir():
        files = visible_files(path, SUFFIXES)
        if len(files) > 1 and not _is_set(files[0]):
            return open_slices(path, files, _slice, dataset, spacing)
        path = files[0]
    xml = ome_xml(path)
    volumes = _of_series(path) if xml is None else _of_ome(path, xml)
    return stored(path, volumes, dataset, spacing)


def _is_set(path: Path) -> bool:
    """Returns True if a file is one of several with an OME-TIFF image."""
    xml = ome_xml(path)
    return xml is not None and any(
        len({part.file for part in image.parts}) > 1 for image in ome.images(path, xml, ome_xml)[1]
    )


def ome_xml(path: Path) -> str | bytes | None:
    """Returns the OME-XML of a file, or None."""
    if path.suffix.lower() in (".ome", ".xml"):
        return path.read_bytes()
    with opened(path) as file:
        page = file.pages[0]
        xml: str | None = page.description if page.is_ome else None
        return xml


def _of_ome(path: Path, xml: str | bytes) -> list[tuple[str, Callable[[], Stack]]]:
    path, images = ome.images(path, xml, ome_xml)
    axes = [tuple(image.sizes.items()) for image in images]
    flat = [image for image, one in zip(images, axes) if not has_depth(one)]
    if len(flat) == len(images):
        raise _flat(path, [(image.sizes["X"], image.sizes["Y"]) for image in flat])
    notes = _left_out([f"{i.sizes['X']} x {i.sizes['Y']} pixels" for i in flat])
    return [
        (image.name, partial(_ome_stack, path, image, notes, len(images) == 1))
        for image in images
        if image not in flat
    ]


def _ome_stack(path: Path, image: ome.Image, notes: tuple[str, ...], alone: bool) -> Stack:
    """Opens an image of OME-TIFF. alone: True if the metadata have only this image."""

    def pages_of(file: Path) -> int:
        with opened(file) as tiff:
            return len(tiff.pages)

    places = ome.table(path, image, pages_of)
    if alone and {file for file, _ in places.values()} == {path}:
        left = pages_of(path) - len(set(places.values()))
        more = f"Pages without OME metadata are left out: {left}."
        notes = (*notes, more) if left > 0 else notes
    file, number = places[0]
    with opened(file) as tiff:
        page = tiff.pages[number]
        check_pages(file, [page])
        inner, samples, colors = axes_of(page)
        dtype = page.dtype
    sizes = dict(inner)
    if (sizes["X"], sizes["Y"]) != (image.sizes["X"], image.sizes["Y"]):
        raise LeaflightError(
            f"{path}: the OME metadata describe {image.sizes['X']} x {image.sizes['Y']} pixels, "
            f"but the pages have {sizes['X']} x {sizes['Y']}; fetch it again."
        )
    outer = tuple((axis, image.sizes[axis]) for axis in reversed(image.order))
    read = partial(_open_places, places)
    blocks = Blocks(outer, inner, dtype, read, samples, colors, image.channel_list)
    return stack_of(path, blocks, image.voxel, notes)


@contextmanager
def _open_places(
    places: dict[int, tuple[Path, int]], _numbers: Sequence[int]
) -> Iterator[Callable[[int], Array]]:
    """Yields a function for Blocks that reads a page. Only one file is open at a time."""
    with ExitStack() as last:
        path, tiff = None, None

        def read(place: int) -> Array:
            nonlocal path, tiff
            file, number = places[place]
            if file != path:
                last.close()
                path, tiff = file, last.enter_context(opened(file))
            assert tiff is not None
            return read_page(file, tiff.pages[number])

        yield read


def _of_series(path: Path) -> list[tuple[str, Callable[[], Stack]]]:
    """Returns the volumes of a file in which tifffile finds the order of pages."""
    with opened(path) as file:
        series = series_of(file)
        found = {k: _blocks(path, file, k) for k in range(len(series))}
        reduced = {k for k in found if series[k].keyframe.is_reduced}
        volumes = {k: one for k, one in found.items() if has_depth(one.axes)}
        if not volumes:
            sizes = [dict(one.axes) for one in found.values()]
            raise _flat(path, [(size["X"], size["Y"]) for size in sizes])
        # Previews and labels do not belong to the volume.
        most = max(_planes(one) for one in volumes.values())
        for extra in (
            reduced,
            {k for k, one in volumes.items() if _planes(one) <= _MOST_EXTRA_PAGES < most},
        ):
            kept = {k: one for k, one in volumes.items() if k not in extra}
            volumes = kept or volumes
        notes = _left_out([_dims(one) for k, one in found.items() if k not in volumes])
        for k in volumes:
            _check_series(path, file, series[k])
        voxel, calibration = _voxel_size(file), None
        if file.is_imagej:
            calibration = imagej.calibration(file.imagej_metadata, series[0].dtype)
        names = {k: series[k].name or _dims(one) for k, one in volumes.items()}

    def stack(blocks: Blocks) -> Stack:
        made = stack_of(path, blocks, voxel, notes)
        if calibration is None:
            return made
        dtype, function, note = calibration
        return replace(
            made,
            dtype=dtype,
            planes=lambda frame, channel: map(function, made.planes(frame, channel)),
            notes=(*notes, note),
        )

    return [(names[k], partial(stack, one)) for k, one in volumes.items()]


def _planes(blocks: Blocks) -> int:
    return prod(n for axis, n in blocks.axes if axis not in "YXS")


def _dims(blocks: Blocks) -> str:
    sizes = [n for axis, n in blocks.axes if axis != "S" and (n > 1 or axis in "YX")]
    return f"{text(sizes[::-1])} {'voxels' if len(sizes) > 2 else 'pixels'}"


def _blocks(path: Path, file: Any, index: int) -> Blocks:
    series = series_of(file)[index]
    page_axes, samples, colors = axes_of(series.keyframe)
    sample = "S" if "S" in dict(page_axes) else "C"
    names = [sample if axis == "S" else axis for axis in series.axes]
    axes = tuple(zip(names, (int(n) for n in series.shape)))
    if series.kind == "lsm":
        # Old versions of tifffile report channels within a page as the slowest axis.
        sizes = {axis: file.lsm_metadata.get(f"Dimension{axis}", 0) for axis in ("P", "Time", "Z")}
        axes = (*((axis[0], max(1, int(n))) for axis, n in sizes.items()), *page_axes)
    if series.dataoffset is not None:
        # ImageJ writes one contiguous block and a single page.
        split = names.index("Y")
    else:
        fits = (k for k in range(len(axes)) if prod(n for _, n in axes[:k]) == len(series))
        split = next(fits, len(axes))
    outer, inner = axes[:split], axes[split:]
    of_page = prod(series.keyframe.shape)
    if series.dataoffset is None and prod(n for _, n in inner) != of_page or len(inner) < 2:
        raise LeaflightError(
            f"{path}: the {len(series)} pages do not form an array of {text(series.shape[::-1])}; "
            "save the file as a plain stack."
        )
    open_blocks = partial(_open_series, path, index, tuple(n for _, n in inner))
    channels = _channel_list(file)
    return Blocks(outer, inner, series.dtype, open_blocks, samples, colors, channels)


@contextmanager
def _open_series(
    path: Path, index: int, shape: tuple[int, ...], _numbers: Sequence[int]
) -> Iterator[Callable[[int], Array]]:
    """Yields a function for Blocks that reads a page of a series, or a plane of a block."""
    with opened(path) as file:
        series = series_of(file)[index]
        dtype = series.dtype.newbyteorder(file.byteorder)
        size = prod(shape) * dtype.itemsize

        def read(k: int) -> Array:
            if series.dataoffset is None:
                return read_page(path, series[k]).reshape(shape)
            file.filehandle.seek(series.dataoffset + k * size)
            data = file.filehandle.read(size)
            if len(data) < size:
                raise truncated(path, series.shape)
            return np.frombuffer(data, dtype).reshape(shape)

        yield read


def _check_series(path: Path, file: Any, series: Any) -> None:
    """Raises LeaflightError unless the file holds all bytes of a series."""
    images = (file.imagej_metadata or {}).get("images", 1)
    plane = file.pages[0].shape
    if images * prod(plane) > max(len(file.pages) * prod(plane), series.size):
        raise truncated(path, (images, *plane))
    if series.dataoffset is None:
        check_pages(path, list(series))
        return
    check_scalar(path, series.dtype)
    if series.dataoffset + series.nbytes > file.filehandle.size:
        raise truncated(path, series.shape)


def _voxel_size(file: Any) -> VoxelSize | None:
    """Returns the voxel size in the metadata of ImageJ or of Zeiss LSM."""
    if file.is_imagej:
        return imagej.size_of_voxel(file.imagej_metadata, file.pages[0].tags)
    if file.is_lsm:
        sizes = [file.lsm_metadata.get(f"VoxelSize{axis}") for axis in "XYZ"]
        return voxel_size(sizes, ("m", "m", "m"), "µm")
    return None


def _channel_list(file: Any) -> tuple[Channel, ...]:
    """Returns the names and colors in the metadata of ImageJ or of Zeiss LSM."""
    if file.is_imagej:
        return imagej.channel_list(file.imagej_metadata)
    if file.is_lsm:
        table = file.lsm_metadata.get("ChannelColors") or {}
        found = zip(table.get("ColorNames") or (), table.get("Colors") or ())
        return tuple(channel_of(name, np.array(color[:3]) / 255) for name, color in found)
    return ()


def _left_out(pictures: Sequence[str]) -> tuple[str, ...]:
    """Returns a note about pictures in a file that do not belong to its volume."""
    if not pictures:
        return ()
    kinds = listed(sorted(set(pictures)))
    return (f"Other pictures in the file are left out: {len(pictures)}, of {kinds}.",)


def _flat(path: Path, sizes: Sequence[tuple[int, int]]) -> LeaflightError:
    pictures = "one picture" if len(sizes) == 1 else f"{len(sizes)} single pictures"
    return LeaflightError(
        f"{path}: the file holds {pictures} of {listed([text(size) for size in sizes])} pixels, "
        "but a volume needs three dimensions; if this is one slice of many, open their folder."
    )


def _slice(path: Path) -> Array:
    """Returns the pixels [y, x] or RGB [y, x, s] of a file that is one slice of a folder."""
    with opened(path) as file:
        blocks = _blocks(path, file, 0)
        if has_depth(blocks.axes):
            raise LeaflightError(
                f"{path}: the slice is {_dims(blocks)}, but a slice of a folder must be one "
                "plane; open this file alone, or remove it."
            )
        _check_series(path, file, series_of(file)[0])
    return picture(blocks)
