# SPDX-License-Identifier: GPL-3.0-or-later
"""The signature in a file of macOS, without which Apple's processors do not run it.

The layout is that of cs_blobs.h in Apple's XNU.
"""

import hashlib
import struct
from dataclasses import dataclass

_SUPER_BLOB, _CODE_DIRECTORY = 0xFADE0CC0, 0xFADE0C02
_SHA256 = 2


@dataclass(frozen=True)
class Signature:
    """A signature. ad_hoc: signed without a certificate. wrong: pages whose hash does not match
    their bytes.
    """

    ad_hoc: bool
    signed_bytes: int
    wrong: list[int]


def read(data, offset):
    """Reads a signature. data: the bytes of the file. offset: of the signature in it."""
    magic, _, count = struct.unpack_from(">3I", data, offset)
    assert magic == _SUPER_BLOB
    places = [struct.unpack_from(">2I", data, offset + 12 + 8 * i)[1] for i in range(count)]
    (start,) = (
        offset + place
        for place in places
        if struct.unpack_from(">I", data, offset + place)[0] == _CODE_DIRECTORY
    )
    flags, hashes, _, _, slots, limit = struct.unpack_from(">6I", data, start + 12)
    size, kind, _, page_bits = struct.unpack_from("4B", data, start + 36)
    assert (size, kind) == (32, _SHA256)
    page = 1 << page_bits
    assert slots == -(-limit // page)
    wrong = []
    for i in range(slots):
        signed = data[start + hashes + size * i :][:size]
        if hashlib.sha256(data[page * i : min(page * (i + 1), limit)]).digest() != signed:
            wrong.append(i)
    return Signature(bool(flags & 2), limit, wrong)
