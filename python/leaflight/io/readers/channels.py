# SPDX-License-Identifier: GPL-3.0-or-later
"""Names and colors of the channels of a file, and their choice."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...srgb import linear_from_srgb
from ...volume.setting_error import SettingError
from .checks import choose, listed

Color = tuple[float, float, float]
# A choice of channels: numbers from 0, or names. None is the only one.
Chosen = int | str | Sequence[int | str] | None

# Longest name of a channel.
_LONGEST = 60


@dataclass(frozen=True)
class Channel:
    """A channel of a file.

    name: Name, "" if the file has none.
    color: Color (red, green, blue), linear in 0..1, None if the file has none.
    """

    name: str = ""
    color: Color | None = None


RGB = tuple(
    Channel(name, color)
    for name, color in (
        ("red", (1.0, 0.0, 0.0)),
        ("green", (0.0, 1.0, 0.0)),
        ("blue", (0.0, 0.0, 1.0)),
    )
)


def channel_of(name: object, srgb: Sequence[float] | Array | None = None) -> Channel:
    """Returns a channel. A name that is no text is left out, and so is black, which hides it.

    srgb: Color of the file in 0..1.
    """
    text = " ".join(name.split())[:_LONGEST] if isinstance(name, str) else ""
    try:
        color = linear_from_srgb(np.clip(np.array(srgb, np.float64), 0, 1))
    except (TypeError, ValueError):
        color = np.empty(0)
    if color.shape != (3,) or not np.isfinite(color).all() or not color.any():
        return Channel(text)
    red, green, blue = color.tolist()
    return Channel(text, (red, green, blue))


def channel_of_json(name: str, color: list[float] | None) -> Channel:
    """Returns the Channel of JSON data."""
    return Channel(name) if color is None else Channel(name, (color[0], color[1], color[2]))


def bytes_of_hex(text: object) -> list[float] | None:
    """Returns an sRGB color in 0..1 of RRGGBB or #AARRGGBB, None for other data."""
    found = re.fullmatch(r"(?:#?[0-9a-fA-F]{2})?#?([0-9a-fA-F]{6})", str(text).strip())
    return [byte / 255 for byte in bytes.fromhex(found[1])] if found else None


def chosen_channels(
    path: Path, chosen: Chosen, count: int, channels: Sequence[Channel]
) -> list[int]:
    """Returns the numbers of the chosen channels of `count`. Raises SettingError.

    channels: All channels, or none if the file has no names.
    """
    if chosen is None or isinstance(chosen, (int, str)):
        return [_chosen(path, chosen, count, channels)]
    several: list[int | str | None] = [*chosen]
    return [_chosen(path, one, count, channels) for one in several or [None]]


def _chosen(path: Path, chosen: int | str | None, count: int, channels: Sequence[Channel]) -> int:
    names = [channel.name for channel in channels]
    # Names are often wavelengths.
    if isinstance(chosen, int) and not 0 <= chosen < count and str(chosen) in names:
        chosen = str(chosen)
    if not isinstance(chosen, str):
        return choose(path, "channel", chosen, count, [name for name in names if name])
    found = [number for number, name in enumerate(names) if name == chosen]
    if len(found) == 1:
        return found[0]
    if found:
        raise SettingError(
            f"{path}: the name {chosen!r} is that of {len(found)} channels; choose one of "
            f"{listed([str(number) for number in found])}.",
            "channel",
        )
    known = listed([name for name in names if name])
    raise SettingError(
        f"{path}: there is no channel {chosen!r}{f' among {known}' if known else ''}; choose "
        + (f"one of 0..{count - 1}." if count > 1 else "none, because there is only one."),
        "channel",
    )
