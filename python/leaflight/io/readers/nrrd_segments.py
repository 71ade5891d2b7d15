# SPDX-License-Identifier: GPL-3.0-or-later
"""The segments that 3D Slicer describes in the header of a .seg.nrrd, in layers if they overlap.

https://apidocs.slicer.org/main/classvtkMRMLSegmentationStorageNode.html
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from ...volume.label_table import MOST_LABELS, Label

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
    for word, text in keys.items():
        match = _KEY.fullmatch(word)
        if match:
            found.setdefault(int(match[1]), {})[match[2]] = text.strip()
    # Early versions wrote one layer for each segment, and no values.
    is_early = not any("LabelValue" in fields for fields in found.values())
    places = []
    for number, (key, fields) in enumerate(sorted(found.items())):
        value = _whole(path, fields, "LabelValue", 1 if is_early and layers > 1 else number + 1)
        layer = _whole(path, fields, "Layer", number if is_early and layers > 1 else 0)
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


def _whole(path: Path, fields: dict[str, str], name: str, default: int) -> int:
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
