# SPDX-License-Identifier: GPL-3.0-or-later
"""Random damage to files, by the methods of fuzzers such as AFL and libFuzzer."""

import re

_NUMBERS = [
    0,
    1,
    -1,
    2**7 - 1,
    2**8 - 1,
    2**15 - 1,
    2**16 - 1,
    2**31 - 1,
    -(2**31),
    2**32 - 1,
]
_NUMBERS += [2**63 - 1, 2**64 - 1]
_TEXTS = [b"0", b"-1", b"1", b"99999999999999999999", b"1e308", b"-1e-308", b"nan", b"inf", b"1e39"]
_TEXTS += [b"2147483648", b"65536", b"\xff\xfe", b"\\ud800", b"\0", b"../x", b"/etc/hostname", b""]
_TEXTS += [b'"', b"[", b"]", b"{", b"\n\n", b"1" * 400, b"null", b"true", b"[[[[[[]]]]]]"]


def mutated(seeds, random):
    """Returns one of the seeds with one to six changes, at most a megabyte."""
    data = bytearray(random.choice(seeds))
    for _ in range(random.choice((1, 1, 2, 3, 6))):
        random.choice(_CHANGES)(data, random, seeds)
    return bytes(data[: 1 << 20])


def _place(data, random):
    """Returns a random position, half of the time in the first 512 bytes, which contain headers."""
    most = len(data) if random.random() < 0.5 else min(len(data), 512)
    return random.randrange(most) if most else 0


def _flip(data, random, _seeds):
    if data:
        data[_place(data, random)] ^= 1 << random.randrange(8)


def _byte(data, random, _seeds):
    if data:
        data[_place(data, random)] = random.choice((0, 1, 127, 128, 255, random.randrange(256)))


def _number(data, random, _seeds):
    size, order = random.choice((1, 2, 4, 8)), random.choice(("little", "big"))
    value = random.choice(_NUMBERS) % (1 << 8 * size)
    place = _place(data, random)
    data[place : place + size] = value.to_bytes(size, order)


def _remove(data, random, _seeds):
    place = _place(data, random)
    del data[place : place + random.choice((1, 4, 16, random.randrange(1, 200)))]


def _repeat(data, random, _seeds):
    place, count = _place(data, random), random.randrange(1, 100)
    data[place:place] = data[place : place + count] * random.choice((1, 2, 50))


def _cut(data, random, _seeds):
    del data[_place(data, random) :]


def _splice(data, random, seeds):
    other = random.choice(seeds)
    data[_place(data, random) :] = other[_place(other, random) :]


def _word(data, random, _seeds):
    """Replaces a number or a word of a text."""
    words = list(re.finditer(rb"[-+.\w]+", bytes(data[:4096])))
    if words:
        begin, end = random.choice(words).span()
        data[begin:end] = random.choice(_TEXTS)


def _insert(data, random, _seeds):
    place = _place(data, random)
    data[place:place] = random.choice(_TEXTS)


def _line(data, random, _seeds):
    """Repeats, removes or moves a line."""
    lines = bytes(data[:8192]).split(b"\n")
    line = lines.pop(random.randrange(len(lines)))
    for _ in range(random.randrange(3)):
        lines.insert(random.randrange(len(lines) + 1), line)
    data[:8192] = b"\n".join(lines)


_CHANGES = (_flip, _byte, _number, _remove, _repeat, _cut, _splice, _word, _word, _insert, _line)
