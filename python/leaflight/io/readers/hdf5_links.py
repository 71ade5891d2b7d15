# SPDX-License-Identifier: GPL-3.0-or-later
"""The groups and arrays of an HDF5 file, by links that do not leave its folder."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from ..._core import LeaflightError
from .checks import data_file

# Upper bounds on the links of one path, and on the depth of groups.
_MOST_LINKS, _DEEPEST = 32, 64


def resolved(group: h5py.Group, path: str, most: int = _MOST_LINKS) -> h5py.HLObject | None:
    """Returns the group or array at a path, None if there is none.

    Raises LeaflightError if it is in an absent file, or outside the folder of this file.
    """
    node: Any = group.file if path.startswith("/") else group
    for part in filter(None, path.split("/")):
        link = node.get(part, getlink=True) if isinstance(node, h5py.Group) else None
        if link is None or most == 0:
            return None
        if isinstance(link, h5py.SoftLink):
            node = resolved(node, link.path, most - 1)
        elif isinstance(link, h5py.ExternalLink):
            other = h5py.File(data_file(Path(node.file.filename), link.filename), "r")
            node = resolved(other, link.path, most - 1)
        else:
            node = node.get(part)
        if node is None:
            return None
    return node


def walked(file: h5py.File) -> Iterator[tuple[str, h5py.HLObject]]:
    """Yields (path, group or array) of each object in the file once, including external links.

    Raises LeaflightError at the end if there were only links to absent files.
    """
    seen: set[int] = set()
    absent: list[LeaflightError] = []

    def walk(group: h5py.Group, prefix: str, depth: int) -> Iterator[tuple[str, h5py.HLObject]]:
        for name in group:
            link = group.get(name, getlink=True)
            # Targets of soft links are visited elsewhere.
            if isinstance(link, h5py.SoftLink):
                continue
            try:
                node = resolved(group, name)
            except LeaflightError as error:
                absent.append(error)
                continue
            if node is None or hash(node.id) in seen:
                continue
            seen.add(hash(node.id))
            yield prefix + name, node
            if isinstance(node, h5py.Group) and depth:
                yield from walk(node, f"{prefix}{name}/", depth - 1)

    arrays = 0
    for path, node in walk(file, "", _DEEPEST):
        arrays += isinstance(node, h5py.Dataset)
        yield path, node
    if not arrays and absent:
        raise absent[0]
