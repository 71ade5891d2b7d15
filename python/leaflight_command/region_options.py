# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that cut, clean and mask volumes. They add records of regions, in their order."""

import argparse
import os
import re
from collections.abc import Callable
from typing import Any

from .numbers import number

Record = dict[str, Any]


class _AddRegion(argparse.Action):
    """Adds the record that `make` returns for the numbers of the option."""

    def __init__(self, option_strings: Any, dest: str, **options: Any) -> None:
        self._make: Callable[[list[Any]], Record] = options.pop("make")
        super().__init__(option_strings, "regions", **options)

    def __call__(
        self, parser: Any, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        before = getattr(namespace, "regions", None) or []
        namespace.regions = [*before, self._make(values)]


class _OpenCuts(argparse.Action):
    """Opens the cuts that were given before."""

    def __call__(
        self, parser: Any, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        for record in getattr(namespace, "regions", None) or []:
            if "cut" in record:
                record["cut"] = "open"


def _box(keep: str) -> Callable[[list[float]], Record]:
    def make(ends: list[float]) -> Record:
        low, high = ends[:3], ends[3:]
        rows = [
            [0.5 * (high[a] - low[a]) if a == b else 0.0 for b in range(3)]
            + [0.5 * (low[a] + high[a])]
            for a in range(3)
        ]
        rows.append([0.0, 0.0, 0.0, 1.0])
        return {"kind": "box", "matrix": rows, "keep": keep, "cut": "capped"}

    return make


def _sphere(numbers: list[float]) -> Record:
    rows = [[numbers[3] if a == b else 0.0 for b in range(3)] + [numbers[a]] for a in range(3)]
    rows.append([0.0, 0.0, 0.0, 1.0])
    return {"kind": "ball", "matrix": rows, "keep": "outside", "cut": "capped"}


def _half_space(numbers: list[float]) -> Record:
    return {"kind": "half_space", "point": numbers[:3], "normal": numbers[3:], "cut": "capped"}


def _part(numbers: list[float]) -> Record:
    return {"kind": "part", "point": numbers[:3], "isovalue": numbers[3]}


def _move_apart(numbers: list[float]) -> Record:
    return {"kind": "apart", "along": numbers[:3], "isovalue": numbers[3]}


def _within(texts: list[str]) -> Record:
    path, _, numbers = texts[0].rpartition(":")
    if not path or not re.fullmatch(r"[0-9]+(,[0-9]+)*", numbers):
        path, numbers = texts[0], ""
    labels = [int(number) for number in numbers.split(",") if number]
    return {"kind": "within_labels", "label_map": os.path.abspath(path), "labels": labels}


def add_region_options(parser: argparse._ArgumentGroup) -> None:
    box = ("X", "Y", "Z", "X", "Y", "Z")
    for name, count, metavar, make, help in (
        ("--crop", 6, box, _box("inside"), "keep a box between two corners"),
        ("--cut-away", 6, box, _box("outside"), "remove a box between two corners"),
        (
            *("--cut-plane", 6, ("X", "Y", "Z", "NX", "NY", "NZ"), _half_space),
            "remove what a normal points to, from a point on",
        ),
        (
            *("--remove-sphere", 4, ("X", "Y", "Z", "RADIUS"), _sphere),
            "remove a sphere about a point",
        ),
        (
            *("--keep-largest", 1, "ISOVALUE"),
            lambda found: {"kind": "largest_part", "isovalue": found[0]},
            "keep the largest part at or above this isovalue",
        ),
        (
            *("--remove-part", 4, ("X", "Y", "Z", "ISOVALUE"), _part),
            "remove the part at a point",
        ),
        (
            *("--move-apart", 4, ("X", "Y", "Z", "ISOVALUE"), _move_apart),
            "move the outermost parts at or above this isovalue apart by a vector",
        ),
        (
            *("--remove-dust", 2, ("VOXELS", "ISOVALUE")),
            lambda found: {"kind": "dust", "voxels": int(found[0]), "isovalue": found[1]},
            "remove parts with fewer voxels",
        ),
    ):
        parser.add_argument(
            name, action=_AddRegion, type=number, nargs=count, metavar=metavar, make=make, help=help
        )
    parser.add_argument(
        "--within",
        action=_AddRegion,
        nargs=1,
        metavar="FILE:LABELS",
        make=_within,
        help="keep what is within labels of a label map, such as seg.nrrd:3,5; without numbers, "
        "within all of them",
    )
    parser.add_argument(
        "--open-cuts",
        action=_OpenCuts,
        nargs=0,
        dest="regions",
        help="let light into the cuts that were given before",
    )
