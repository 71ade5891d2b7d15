# SPDX-License-Identifier: GPL-3.0-or-later
"""OME-XML: finds the file and the page of each plane of an image.

https://docs.openmicroscopy.org/ome-model/latest/ome-tiff/specification.html
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from xml.etree import ElementTree

from ..._core import LeaflightError
from .channels import Channel, channel_of
from .checks import text
from .voxel_size import VoxelSize, voxel_size

# Upper bound on the planes of one element, above any microscope's data.
_MOST_PLANES = 10**7


@dataclass(frozen=True)
class Part:
    """Consecutive planes of an image in a file.

    first: Index of the first plane in the image.
    count: Number of planes, None for all pages of the file.
    file: Name of the file, "" for the file with the metadata.
    page: First page in the file.
    """

    first: int
    count: int | None
    file: str
    page: int


@dataclass(frozen=True)
class Image:
    """An image of OME-XML.

    order: Axes of its planes, "ZCT" in some order, fastest first.
    sizes: Sizes of these axes and of "X" and "Y". "C" counts channels that share a plane, such as
        colors, once.
    parts: Positions of its planes in files.
    channel_list: Names and colors along "C"; empty if unknown.
    """

    name: str
    order: str
    sizes: dict[str, int]
    voxel: VoxelSize | None
    parts: tuple[Part, ...]
    channel_list: tuple[Channel, ...] = ()

    def place(self, **indices: int) -> int:
        """Returns the index of the plane with these indices by axis."""
        place, step = 0, 1
        for axis in self.order:
            place += step * indices[axis]
            step *= self.sizes[axis]
        return place


def images(
    path: Path, xml: str | bytes, read: Callable[[Path], str | bytes | None]
) -> tuple[Path, list[Image]]:
    """Returns (file with the metadata, the images in it). Raises LeaflightError.

    xml: OME-XML of a TIFF file or of a separate file. It may refer to that of another file of the
        set.
    read: Function that returns the OME-XML of a file, or None.
    """
    root = _root(path, xml)
    binary_only = next(_children(root, "BinaryOnly"), None)
    if binary_only is not None:
        path = member(path, binary_only.get("MetadataFile", ""))
        root = _root(path, read(path))
    try:
        return path, [_image(path, root, element) for element in _children(root, "Image")]
    except (KeyError, ValueError, OverflowError, StopIteration):
        raise _damaged(path) from None


def member(path: Path, name: str) -> Path:
    """Returns the file of this name in the set that `path` belongs to. Raises LeaflightError.

    For security, it opens no file outside the folder of the set.
    """
    folder = path.parent.resolve()
    file = (path.parent / name).resolve()
    if re.match(r"[A-Za-z]:", name) or "\0" in name or folder not in file.parents:
        raise LeaflightError(
            f"{path}: the image is in several files, and {name[:100]!r} is outside this folder; "
            "put all files of the set into one folder."
        )
    if not file.is_file():
        raise LeaflightError(
            f"{path}: the image is in several files, and {name[:100]!r} is missing; put all files "
            "of the set into one folder."
        )
    return file


def table(path: Path, image: Image, pages_of: Callable[[Path], int]) -> dict[int, tuple[Path, int]]:
    """Returns {index of a plane: (file, page)} of all planes of an image.

    pages_of: Function that returns the number of pages of a file.
    Raises LeaflightError if a file or a plane is missing.
    """
    total = prod(image.sizes[axis] for axis in image.order)
    found: dict[int, tuple[Path, int]] = {}
    files = {name: member(path, name) if name else path for name in {p.file for p in image.parts}}
    # Trust a number of planes only if the file has as many pages.
    pages = {file: 0 for file in files.values()}
    for part in image.parts:
        file, count = files[part.file], part.count
        if count != 1:
            pages[file] = pages[file] or pages_of(file)
            count = min(count or total, pages[file] - part.page, total - part.first)
        for k in range(count):
            found[part.first + k] = file, part.page + k
    if len(found) < total:
        raise _incomplete(path, image, next(k for k in range(total) if k not in found))
    return found


def _incomplete(path: Path, image: Image, place: int) -> LeaflightError:
    total = prod(image.sizes[axis] for axis in image.order)
    where = []
    for axis in image.order:
        place, k = divmod(place, image.sizes[axis])
        where.append(f"{axis} {k}")
    return LeaflightError(
        f"{path}: the OME metadata describe {text([total])} planes, but the one at "
        f"{', '.join(where)} is missing; fetch all files again."
    )


def _root(path: Path, xml: str | bytes | None) -> ElementTree.Element:
    try:
        root = ElementTree.fromstring(xml or "")
    except (ElementTree.ParseError, ValueError):
        raise _damaged(path) from None
    if _local(root) != "OME":
        raise _damaged(path)
    return root


def _damaged(path: Path) -> LeaflightError:
    return LeaflightError(
        f"{path}: the OME metadata describe no image, or are damaged; fetch it again."
    )


def _local(element: ElementTree.Element) -> str:
    """Returns the name of an element without its namespace, which contains the version."""
    return element.tag.rpartition("}")[2]


def _children(element: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    return (child for child in element if _local(child) == name)


def _image(path: Path, root: ElementTree.Element, element: ElementTree.Element) -> Image:
    """Returns an image. Raises KeyError, ValueError or StopIteration if the XML is invalid."""
    pixels = next(_children(element, "Pixels"))
    if next(_children(pixels, "BinData"), None) is not None:
        raise LeaflightError(
            f"{path}: pixels within the XML are not supported; save the image as OME-TIFF."
        )
    order = pixels.attrib["DimensionOrder"][2:]
    sizes = {axis: int(pixels.attrib[f"Size{axis}"]) for axis in "XYZCT"}
    samples = {int(one.get("SamplesPerPixel", 1)) for one in _children(pixels, "Channel")} or {1}
    samples_of_all = samples.pop()
    if samples or samples_of_all < 1 or sizes["C"] % samples_of_all or sorted(order) != list("CTZ"):
        raise ValueError
    sizes["C"] //= samples_of_all
    if min(sizes.values()) < 1 or prod(sizes[axis] for axis in order) > _MOST_PLANES:
        raise ValueError
    voxel = voxel_size(
        [pixels.get(f"PhysicalSize{axis}") for axis in "XYZ"],
        [pixels.get(f"PhysicalSize{axis}Unit", "µm") for axis in "XYZ"],
        "µm",
    )
    channels = tuple(_channel(one) for one in _children(pixels, "Channel"))
    channels = channels if len(channels) == sizes["C"] else ()
    image = Image(element.get("Name", ""), order, sizes, voxel, (), channels)
    return replace(image, parts=tuple(_parts(path, root, image, pixels)))


def _channel(element: ElementTree.Element) -> Channel:
    """Returns the name and the color of a channel. The color is an integer with bytes RGBA."""
    try:
        color = int(element.attrib["Color"])
    except (KeyError, ValueError):
        return channel_of(element.get("Name"))
    return channel_of(element.get("Name"), [(color >> shift & 255) / 255 for shift in (24, 16, 8)])


def _parts(
    path: Path, root: ElementTree.Element, image: Image, pixels: ElementTree.Element
) -> Iterator[Part]:
    own_names = _own_names(path, root)
    elements = list(_children(pixels, "TiffData"))
    for data in elements:
        named = next(_children(data, "UUID"), None)
        name = "" if named is None else named.get("FileName", "")
        first = {axis: int(data.get(f"First{axis}", 0)) for axis in image.order}
        # ImageJ keeps the entries of planes that it cropped.
        if any(not 0 <= first[axis] < image.sizes[axis] for axis in image.order):
            continue
        count = data.get("PlaneCount", data.get("NumPlanes", "1" if "IFD" in data.attrib else None))
        page = int(data.get("IFD", 0))
        if page < 0 or (count is not None and int(count) < 0):
            raise ValueError
        if count != "0":
            yield Part(
                image.place(**first),
                None if count is None else int(count),
                "" if name in own_names else name,
                page,
            )
    if not elements:
        yield Part(0, None, "", 0)


def _own_names(path: Path, root: ElementTree.Element) -> set[str]:
    """Returns the names of a file in its own metadata. The file may have been renamed."""
    names: dict[str, set[str]] = {}
    for named in root.iter():
        if _local(named) == "UUID" and named.get("FileName"):
            names.setdefault((named.text or "").strip(), set()).add(named.attrib["FileName"])
    every = set().union(*names.values())
    found = {path.name}
    if path.name not in every:
        with_own_id = names.get(root.get("UUID", ""), set())
        absent = {name for name in every if not (path.parent / name).exists()}
        if len(with_own_id) == 1:
            found |= with_own_id
        elif len(every) == 1:
            found |= absent
    return found
