# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of Zarr arrays, chunk by chunk; numcodecs decompresses them.

Only subprocesses import this module. The package zarr reads version 3 only with NumPy 1.26 or
later, which Debian and Blender 4.2 do not have. https://zarr-specs.readthedocs.io
"""

import mmap
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil, prod
from pathlib import Path
from typing import Any

import numcodecs
import numpy as np
from crc32c import crc32c
from numcodecs.compat import ensure_contiguous_ndarray

from ..._core import LeaflightError
from ...arrays import Array
from ...volume.memory import bytes_of
from .zarr_folder import header_of

# A part of an array: the first index along each axis and the one after the last.
Box = Sequence[slice]
Bytes = memoryview
_ABSENT = 2**64 - 1


@dataclass(frozen=True)
class _Packing:
    """The encoding of the values of a box of this shape.

    order: Order of the axes in memory.
    codecs: Functions from compressed bytes to bytes.
    shard: Packing of the inner chunks, in the same order of axes; None for plain values.
    """

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    order: tuple[int, ...]
    codecs: tuple[Callable[[Bytes], Bytes], ...]
    shard: "_Shard | None" = None

    def finest(self) -> tuple[int, ...]:
        """Returns the shape that is decoded at once."""
        if self.shard is None:
            return self.shape
        inner = self.shard.chunks.finest()
        return tuple(inner[self.order.index(axis)] for axis in range(len(inner)))

    def part(self, data: Bytes, box: Box) -> Array:
        for codec in self.codecs:
            data = codec(data)
        shape = [self.shape[axis] for axis in self.order]
        turned = [box[axis] for axis in self.order]
        if self.shard is not None:
            values = self.shard.part(data, shape, turned)
        else:
            flat = np.frombuffer(data, self.dtype)
            if flat.size != prod(shape):
                raise ValueError("a chunk has another size")
            values = flat.reshape(shape)[tuple(turned)]
        return values.transpose(np.argsort(self.order))


@dataclass(frozen=True)
class _Shard:
    """Chunks in one run of bytes, with an index of (offset, size) of each."""

    chunks: _Packing
    index: _Packing
    fill: Array
    at_end: bool

    def part(self, data: Bytes, shape: Sequence[int], box: Box) -> Array:
        pairs = (*(ceil(n / m) for n, m in zip(shape, self.chunks.shape)), 2)
        axes = tuple(range(len(pairs)))
        # Only checksums may change the size of the index.
        size = 8 * prod(pairs) + 4 * len(self.index.codecs)
        where = slice(len(data) - size, None) if self.at_end else slice(size)
        index = replace(self.index, shape=pairs, order=axes).part(
            data[where], [slice(None)] * len(axes)
        )

        def fetch(place: tuple[int, ...]) -> Bytes | None:
            start, count = map(int, index[place])
            if start == count == _ABSENT:
                return None
            if start + count > len(data):
                raise ValueError("a shard ends early")
            return data[start : start + count]

        return _gather(box, self.chunks, fetch, self.fill)


def _gather(
    box: Box,
    chunks: _Packing,
    fetch: Callable[[tuple[int, ...]], Bytes | None],
    fill: Array,
) -> Array:
    """Returns a part of a regular grid of chunks. fetch returns a chunk's bytes, None if absent."""
    values = np.full([one.stop - one.start for one in box], fill)
    ranges = [range(b.start // n, ceil(b.stop / n)) for b, n in zip(box, chunks.shape)]
    for place in product(*ranges):
        corner = [i * n for i, n in zip(place, chunks.shape)]
        common = [
            slice(max(b.start, c), min(b.stop, c + n)) for b, c, n in zip(box, corner, chunks.shape)
        ]
        data = fetch(place)
        if data is not None:
            within = [slice(s.start - c, s.stop - c) for s, c in zip(common, corner)]
            target = tuple(slice(s.start - b.start, s.stop - b.start) for s, b in zip(common, box))
            values[target] = chunks.part(data, within)
    return values


def read_slabs(
    path: Path, places: list[int | None], axes: list[int]
) -> tuple[list[Any], Iterator[Array]]:
    """Returns (shape and type, slabs along z) of ZarrArray.read(). Runs in the subprocess."""
    header = header_of(path)
    chunks, fill, name = (_version_3 if header["zarr_format"] == 3 else _version_2)(path, header)
    dtype = chunks.dtype.newbyteorder("=")
    box = [slice(0, n) if p is None else slice(p, p + 1) for p, n in zip(places, header["shape"])]
    shape, step = [header["shape"][axis] for axis in axes], chunks.finest()[axes[0]]
    kept = sorted(axes)

    def fetch(place: tuple[int, ...]) -> Bytes | None:
        return _contents(path / name(place))

    def slabs() -> Iterator[Array]:
        for k in range(0, shape[0], step):
            box[axes[0]] = slice(k, min(k + step, shape[0]))
            part = _gather(box, chunks, fetch, fill)
            part = part.reshape([n for n, place in zip(part.shape, places) if place is None])
            yield np.ascontiguousarray(part.transpose([kept.index(axis) for axis in axes]), dtype)

    return [shape, dtype.str], slabs()


def _contents(path: Path) -> Bytes | None:
    """Returns the bytes of a file, None if there is none."""
    try:
        with open(path, "rb") as file:
            if os.fstat(file.fileno()).st_size == 0:
                return memoryview(b"")
            return memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    except (FileNotFoundError, NotADirectoryError):
        return None


_Layout = tuple[_Packing, Array, Callable[[tuple[int, ...]], str]]


def _version_2(path: Path, header: dict[str, Any]) -> _Layout:
    """Returns (packing of a chunk, value of absent chunks, function from index to file name)."""
    dtype, shape = np.dtype(header["data_type"]), tuple(header["chunks"])
    axes = tuple(range(len(shape)))
    packed = [*(header.get("filters") or ()), *filter(None, [header.get("compressor")])]
    codecs = tuple(_codec(path, one) for one in reversed(packed))
    separator = header.get("dimension_separator", ".")
    return (
        _Packing(shape, dtype, axes[::-1] if header["order"] == "F" else axes, codecs),
        _fill(header.get("fill_value"), dtype),
        lambda place: separator.join(map(str, place)),
    )


def _version_3(path: Path, header: dict[str, Any]) -> _Layout:
    dtype = np.dtype(header["data_type"])
    shape = tuple(header["chunk_grid"]["configuration"]["chunk_shape"])
    fill = _fill(header.get("fill_value"), dtype)
    encoding = _named(header["chunk_key_encoding"])
    old = encoding["name"] == "v2"
    separator = encoding["configuration"].get("separator", "." if old else "/")
    return (
        _packing(path, shape, dtype, fill, header["codecs"]),
        fill,
        lambda place: separator.join(map(str, place if old else ("c", *place))),
    )


def _packing(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[Any], fill: Array, listed: list[Any]
) -> _Packing:
    """Returns the packing for codecs of version 3, which are listed in the order of encoding."""
    order, shard = np.arange(len(shape)), None
    unpack: list[Callable[[Bytes], Bytes]] = []
    for codec in map(_named, listed):
        name, options = codec["name"], codec["configuration"]
        if name == "transpose":
            order = order[options["order"]]
        elif name == "bytes":
            dtype = dtype.newbyteorder(options.get("endian", "little"))
        elif name == "sharding_indexed":
            shard = _shard(path, dtype, fill, options)
        elif name == "crc32c":
            unpack.append(_checked)
        else:
            id = name.removeprefix("numcodecs.")
            unpack.append(_codec(path, {**(options if id != name else {}), "id": id}))
    return _Packing(shape, dtype, tuple(map(int, order)), tuple(reversed(unpack)), shard)


def _shard(path: Path, dtype: np.dtype[Any], fill: Array, options: dict[str, Any]) -> _Shard:
    chunks = _packing(path, tuple(options["chunk_shape"]), dtype, fill, options["codecs"])
    index = _packing(path, (), np.dtype(np.uint64), fill, options.get("index_codecs") or ["bytes"])
    return _Shard(chunks, index, fill, options.get("index_location", "end") == "end")


def _named(codec: str | dict[str, Any]) -> dict[str, Any]:
    named = {"name": codec} if isinstance(codec, str) else codec
    return {"configuration": {}, **named}


def _codec(path: Path, options: dict[str, Any]) -> Callable[[Bytes], Bytes]:
    try:
        codec = numcodecs.get_codec(dict(options))
    except (ValueError, TypeError):
        raise LeaflightError(
            f"{path}: the chunks are compressed by the codec {str(options['id'])[:40]}, which is "
            "not installed; save them with another one, such as Blosc."
        ) from None
    return lambda data: bytes_of(ensure_contiguous_ndarray(codec.decode(data)))


def _checked(data: Bytes) -> Bytes:
    """Returns the data without their checksum. Raises ValueError if it is wrong."""
    if crc32c(data[:-4]) != int.from_bytes(data[-4:], "little"):
        raise ValueError("a checksum is wrong")
    return data[:-4]


def _fill(value: Any, dtype: np.dtype[Any]) -> Array:
    if isinstance(value, str) and value.startswith("0x"):
        return np.array(int(value, 16), f"u{dtype.itemsize}").view(dtype)
    # The text may be "NaN" or "-Infinity".
    return np.array(float(value) if isinstance(value, str) else value or 0).astype(dtype)
