# SPDX-License-Identifier: GPL-3.0-or-later
"""NRRD: a text header, with values behind it (.nrrd) or in other files (.nhdr).

https://teem.sourceforge.net/nrrd/format.html
3D Slicer describes segments in the header of a .seg.nrrd, in layers if they overlap:
https://apidocs.slicer.org/main/classvtkMRMLSegmentationStorageNode.html
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.label_table import MOST_LABELS, Label
from ...volume.volume import Volume
from .channels import RGB, Channel
from .checks import text
from .encodings import NUMBERS
from .nrrd_axes import axes_of
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles, data_files

# Other names of a field -> its name here.
_ENCODINGS = {
    "raw": "raw",
    **dict.fromkeys(("text", "txt", "ascii"), "text"),
    "hex": "hex",
    **dict.fromkeys(("gzip", "gz"), "gzip"),
    **dict.fromkeys(("bzip2", "bz2"), "bzip2"),
}
# Upper bound on the bytes of a header, including many comments.
_MOST = 1 << 20
_LARGEST_SIDE, _MOST_AXES = 1 << 16, 16


def open_volume(path: Path) -> StoredVolume:
    """Opens a volume. Axes of time are frames.

    Other axes outside space, such as those of vectors, are channels. The layers of segments become
    one label map.
    """
    fields, keys, listed, end = _header(path)
    sizes = _sizes(path, fields)
    dtype = np.dtype(NUMBERS.get(_need(path, fields, "type").lower(), "V"))
    if dtype.kind == "V":
        raise LeaflightError(
            f"{path}: the type {fields['type'][:40]} is not a number; convert the file to a "
            "scalar type first."
        )
    endian = fields.get("endian", "little").lower()
    dtype = dtype.newbyteorder(">" if endian == "big" else "<")
    axes = axes_of(path, fields, sizes)
    dims = tuple(sizes[i] for i in axes.space)
    if max(dims) > _LARGEST_SIDE:
        raise LeaflightError(
            f"{path}: the header claims the impossible size {text(dims)}; fetch the file again."
        )
    stored = _value_files(path, fields, listed, end, sizes)
    stored.check(sizes[::-1], dtype)
    notes = axes.notes + _notes_on_bytes(stored.surplus(math.prod(sizes) * dtype.itemsize))
    counts = [[sizes[i] for i in group] for group in (axes.frames, axes.channels)]

    channels = math.prod(counts[1])
    segments = segments_of(path, keys, channels) if len(axes.channels) < 2 else ()
    are_layers = bool(segments) and channels > 1

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        index: list[int | slice] = [slice(None)] * len(sizes)
        groups = (axes.frames,) if are_layers else (axes.frames, axes.channels)
        for group, count, chosen in zip(groups, counts, (frame, channel)):
            for i, place in zip(group, np.unravel_index(chosen, count) if group else ()):
                index[i] = int(place)
        picked: Index = tuple(index[::-1])
        values = stored.read(sizes[::-1], dtype, picked, progress)
        if are_layers:
            slower = sum(axis > axes.channels[0] for axis in axes.space)
            values = merged(np.moveaxis(values, slower, 0), segments)
        labels = [segment.label for segment in segments]
        return Volume(values, axes.matrix, path.stem, labels=labels)

    return StoredVolume(
        dims=dims,
        dtype=np.dtype(np.uint16) if are_layers else dtype,
        load=load,
        voxel_size=lengths(axes.matrix),
        unit=axes.unit,
        frames=math.prod(counts[0]),
        channels=1 if are_layers else math.prod(counts[1]),
        channel_list=() if are_layers else _colors(fields, axes.channels, counts[1]),
        patient=axes.patient,
        notes=notes + (LAYERS,) if are_layers else notes,
    )


def _notes_on_bytes(surplus: int) -> tuple[str, ...]:
    if not surplus:
        return ()
    return (
        f"The data hold {surplus} bytes more than the sizes say; the first values are read. If "
        "the bytes are a header, give the line 'byte skip: -1'.",
    )


def _colors(
    fields: dict[str, str], axes: Sequence[int], counts: Sequence[int]
) -> tuple[Channel, ...]:
    """Returns the names of red, green, blue and alpha; none for other channels."""
    kinds = fields.get("kinds", "").lower().split()
    for kind, channels in (("rgb-color", RGB), ("rgba-color", (*RGB, Channel("alpha")))):
        if list(counts) == [len(channels)] and kinds[axes[0] : axes[0] + 1] == [kind]:
            return channels
    return ()


def _header(path: Path) -> tuple[dict[str, str], dict[str, str], list[str], int]:
    """Returns (fields, keys, file names after them, start of the data if they follow).

    keys: Values that other programs have added.
    """
    with open(path, "rb") as file:
        head = file.read(_MOST)
    if not re.match(rb"NRRD000\d\r?\n", head):
        raise LeaflightError(f"{path}: this is not a readable NRRD file; fetch it again.")
    fields, keys, place, closed = {}, {}, head.find(b"\n") + 1, False
    while place < len(head) and not closed:
        end = head.find(b"\n", place)
        end = len(head) if end < 0 else end
        line = head[place:end].rstrip(b"\r").decode("utf-8", "replace")
        place = end + 1
        closed = not line
        if line.startswith("#"):
            continue
        if re.match(r"[^:]*:=", line):
            key, _, value = line.partition(":=")
            keys[key] = value
            continue
        name, colon, value = line.partition(":")
        name = {"datafile": "data file"}.get(name.strip().lower(), name.strip().lower())
        if colon and name in fields:
            raise LeaflightError(
                f"{path}: the header has the field {name[:40]} twice; remove one of them."
            )
        if colon:
            fields[name] = value.strip()
        # This is the last field by the format's rule.
        if name == "data file" and value.strip()[:4].upper() == "LIST":
            return fields, keys, head[place:].decode("utf-8", "replace").splitlines(), place
    if not closed and "data file" not in fields:
        raise LeaflightError(
            f"{path}: the header does not end with a blank line: it is truncated or damaged, "
            "fetch it again."
        )
    return fields, keys, [], place


def _need(path: Path, fields: dict[str, str], name: str) -> str:
    if name not in fields:
        raise LeaflightError(f"{path}: the header has no {name}; fetch it again.")
    return fields[name]


def _sizes(path: Path, fields: dict[str, str]) -> tuple[int, ...]:
    words = _need(path, fields, "sizes").split()
    dimension = fields.get("dimension", str(len(words)))
    if not all(re.fullmatch(r"\d{1,9}", word) for word in words) or dimension != str(len(words)):
        raise LeaflightError(
            f"{path}: the header does not give the size of each axis; fetch it again."
        )
    shape = tuple(map(int, words))
    if not 0 < len(shape) <= _MOST_AXES or min(shape) < 1:
        raise LeaflightError(
            f"{path}: the header claims the impossible size {text(shape[:_MOST_AXES])}; fetch the "
            "file again."
        )
    return shape


def _value_files(
    path: Path, fields: dict[str, str], listed: list[str], end: int, sizes: tuple[int, ...]
) -> ValueFiles:
    encoding = _need(path, fields, "encoding").lower()
    if encoding not in _ENCODINGS:
        raise LeaflightError(
            f"{path}: the encoding {encoding[:40]} is unknown; save the file as raw or gzip."
        )
    name = fields.get("data file")
    return ValueFiles(
        files=(path,) if name is None else data_files(path, name, listed, sizes),
        encoding=_ENCODINGS[encoding],
        start=end if name is None else 0,
        lines=_whole(path, fields, "line skip", 0),
        skip=_whole(path, fields, "byte skip", -(10**15)),
    )


def _whole(path: Path, fields: dict[str, str], name: str, least: int) -> int:
    """Returns a field that is a whole number, 0 if it is missing."""
    value = fields.get(name, fields.get(name.replace(" ", ""), "0"))
    if not re.fullmatch(r"-?\d{1,15}", value) or int(value) < least:
        raise LeaflightError(
            f"{path}: the field {name} is {value[:40]!r}, but must be a whole number; repair the "
            "header."
        )
    return int(value)


_KEY = re.compile(r"Segment(\d{1,5})_(Name|Color|LabelValue|Layer)")

# Note about layers.
LAYERS = "Segments that overlap are merged; later ones hide earlier ones."


@dataclass(frozen=True)
class Segment:
    """A segment: the voxels with a value in one layer."""

    label: Label
    value: int
    layer: int


def segments_of(path: Path, keys: dict[str, str], layers: int) -> tuple[Segment, ...]:
    """Returns the segments in the keys of a header, none if there are none. Raises LeaflightError.

    Their labels are their values. If values of several layers are equal, they are the places in the
    header, from 1.
    layers: Number of layers in the file.
    """
    found: dict[int, dict[str, str]] = {}
    for word, content in keys.items():
        match = _KEY.fullmatch(word)
        if match:
            found.setdefault(int(match[1]), {})[match[2]] = content.strip()
    # Early versions wrote one layer for each segment, and no values.
    is_early = not any("LabelValue" in fields for fields in found.values())
    places = []
    for number, (key, fields) in enumerate(sorted(found.items())):
        value = _segment_number(
            path, fields, "LabelValue", 1 if is_early and layers > 1 else number + 1
        )
        layer = _segment_number(path, fields, "Layer", number if is_early and layers > 1 else 0)
        if layer >= layers:
            raise _damaged(path, f"segment {key} is in layer {layer}, but there are {layers}")
        places.append((value, layer, fields))
    values = [value for value, _, _ in places]
    if len(set(values)) < len(values):
        values = list(range(1, len(values) + 1))
    return tuple(
        Segment(Label.of(number, fields.get("Name", ""), _color(path, fields)), value, layer)
        for number, (value, layer, fields) in zip(values, places)
    )


def merged(layers: Array, segments: Sequence[Segment]) -> Array:
    """Returns the label map of all segments; later ones are on top. layers: [layer, z, y, x]."""
    most = max(segment.label.number for segment in segments)
    values = np.zeros(layers[0].shape, np.uint8 if most < 256 else np.uint16)
    for segment in segments:
        values[layers[segment.layer] == segment.value] = segment.label.number
    return values


def _segment_number(path: Path, fields: dict[str, str], name: str, default: int) -> int:
    text = fields.get(name, str(default))
    if not text.isdecimal() or int(text[:9]) > MOST_LABELS:
        raise _damaged(path, f"{name} {text[:40]!r} of a segment is not in 0 to {MOST_LABELS}")
    return int(text)


def _color(path: Path, fields: dict[str, str]) -> list[float] | None:
    if "Color" not in fields:
        return None
    try:
        red, green, blue = map(float, fields["Color"].split())
        return [red, green, blue]
    except ValueError:
        raise _damaged(path, f"the color {fields['Color'][:40]!r} is not three numbers") from None


def _damaged(path: Path, why: str) -> LeaflightError:
    return LeaflightError(f"{path}: the header is damaged, because {why}: repair it.")
