# SPDX-License-Identifier: GPL-3.0-or-later
"""The channels of a file: their choice in the file dialog, their names and colors."""

from dataclasses import dataclass
from itertools import cycle

import leaflight
import numpy as np
from leaflight import LeaflightError
from leaflight.io.readers.channels import RGB
from mathutils import Color

from .. import icons
from ..props import BoolProperty, BoolVectorProperty
from ..show import texture
from ..store import cache, source_files
from ..translations import iface_

# Length of the list of channels, the largest of a property of Blender.
MOST = 32
# Albedo of a channel that is white in its file. An albedo of 1 would absorb no light.
_WHITE = 0.85
# Albedos of channels without a color: red, green, blue, magenta, cyan and yellow.
_FIXED = (
    *((0.85, 0.1, 0.08), (0.08, 0.6, 0.12), (0.12, 0.25, 0.9)),
    *((0.75, 0.12, 0.75), (0.08, 0.65, 0.7), (0.85, 0.7, 0.08)),
)
# Side of a swatch, in pixels.
_SIDE = 16


class Choices:
    """The choice of channels in the file dialog, beside the number of a single one."""

    all_channels: BoolProperty(
        "All Channels",
        "Import each channel as a separate volume in the same place, with its own isovalue "
        "and color",
        options={"SKIP_SAVE"},
    )
    channels: BoolVectorProperty(
        "Channels",
        "Channels to import. Several are separate volumes in the same place",
        MOST,
        options={"SKIP_SAVE"},
    )
    as_rgb: BoolProperty(
        "As RGB",
        "Import three channels as one volume, the brightest of them at each voxel, which they "
        "color as red, green and blue",
        options={"SKIP_SAVE"},
    )


@dataclass(frozen=True)
class Choice:
    """The values of Choices."""

    channel: int
    channels: tuple
    all_channels: bool
    as_rgb: bool

    @classmethod
    def of(cls, operator):
        chosen = tuple(operator.channels)
        return cls(operator.channel, chosen, operator.all_channels, operator.as_rgb)

    def numbers(self, stored):
        """Returns the numbers of the chosen channels, [-1] without a choice."""
        if stored.channels > 1 and self.all_channels:
            return list(range(stored.channels))
        chosen = self.channels[: stored.channels if stored.channels > 1 else 0]
        return [number for number, is_on in enumerate(chosen) if is_on] or [self.channel]

    def is_rgb(self, stored):
        """True if three channels are imported as the colors of one volume."""
        return self.as_rgb or (self.numbers(stored) == [-1] and is_picture(stored))

    def is_open(self, stored):
        """True if the file has several channels, and none is chosen."""
        is_chosen = self.numbers(stored) != [-1] or self.is_rgb(stored)
        return stored.channels > 1 and not is_chosen

    def red_green_blue(self, path, stored):
        """Returns the numbers of three channels for red, green and blue. Raises LeaflightError.

        They are those of these colors in the file, or in the order of the file.
        """
        numbers = self.numbers(stored)
        if numbers == [-1]:
            numbers = list(range(3 if is_picture(stored) else stored.channels))
        if len(numbers) != 3:
            raise LeaflightError(
                f"{path}: As RGB takes three channels, not {len(numbers)}: choose three."
            )
        colors = [stored.channel(number).color or (0.0,) for number in numbers]
        of_color = {int(np.argmax(color)): number for number, color in zip(numbers, colors)}
        is_by_color = len(of_color) == 3 and (0.0,) not in colors
        return [of_color[k] for k in range(3)] if is_by_color else numbers


def is_picture(stored):
    """True if the channels of a file are the red, green and blue of pictures."""
    return stored.channel_list[:3] == RGB


def albedos(stored):
    """Returns the albedo of each channel: the color in the file, if colors differ."""
    colors = [stored.channel(number).color for number in range(stored.channels)]
    differ = len(set(colors)) > 1
    return [
        tuple(_WHITE * part for part in color) if color and differ else fixed
        for color, fixed in zip(colors, cycle(_FIXED))
    ]


def dress(obj, others, stored, is_rgb):
    """Gives the objects of channels their names and colors.

    is_rgb: True if three others color the isosurfaces of the object. None among them is black.
    """
    colors = albedos(stored)
    for one in filter(None, others if is_rgb else [obj, *others]):
        number, name = one.leaflight.channel, cache.volume_of(one).name
        own = stored.channel(number)
        if others:
            one.name = name if own.name else iface_("%s channel %d") % (name, number)
        if others or own.color:
            one.leaflight.isosurface_albedo = colors[number]
    if is_rgb:
        _color_by(obj, others, stored)


def _color_by(obj, others, stored):
    """Colors the isosurfaces of an object by three others, which it hides."""
    settings = obj.leaflight
    settings.texture_kind = "CHANNELS"
    settings.texture_volume, settings.texture_green, settings.texture_blue = others
    low, high = np.transpose([texture.begin(other) for other in others if other is not None])
    settings.texture_srgb = is_picture(stored) and stored.dtype.kind == "u"
    is_bytes = settings.texture_srgb and stored.dtype.itemsize == 1
    settings.texture_low, settings.texture_high = min(0, low.min()), 255 if is_bytes else high.max()


def about(others, stored, is_rgb):
    """Returns words for the report of the import."""
    if not is_rgb:
        return f", {1 + len(others)} channels" if others else ""
    names = ["none" if one is None else _word(stored, one.leaflight.channel) for one in others]
    return (
        ", the brightest of three channels, which color it: "
        f"red is {names[0]}, green is {names[1]}, blue is {names[2]}"
    )


def _word(stored, number):
    """Returns the name of a channel for messages."""
    return stored.channel(number).name or f"channel {number}"


def read(path, stored, choices, is_needed, progress):
    """Returns the volume of source_files.CHOICES. Raises LeaflightError.

    Returns None if it is not needed, and all voxels have the same value, so that it has no
    isosurface.
    """
    try:
        return source_files.read_volume(path, progress=progress, **choices)
    except LeaflightError:
        frame, channel = max(choices["frame"], 0), choices["channel"]
        if is_needed or channel < 0 or not _is_constant(stored, frame, channel):
            raise
        return None


def _is_constant(stored, frame, channel):
    values = stored.load(frame, channel, leaflight.Progress()).values
    first = values[0].flat[0]
    return all((plane == first).all() for plane in values)


def why_left_out(stored, number):
    """Returns a sentence on a channel whose voxels have the same value."""
    name = _word(stored, number)
    return f"All voxels of {name} have the same value, so it is left out."


def draw(layout, operator, stored):
    """Draws the list of channels, each with its name and its color."""
    choice = Choice.of(operator)
    layout.prop(operator, "all_channels")
    column = layout.column(align=True)
    column.active = not operator.all_channels
    if stored.channels > MOST:
        text = iface_("Channel (0 to %d)") % (stored.channels - 1)
        column.prop(operator, "channel", text=text)
    else:
        for number, albedo in enumerate(albedos(stored)):
            row = column.row(align=True)
            text = stored.channel(number).name or iface_("Channel %d") % number
            row.prop(operator, "channels", index=number, text=text, translate=False)
            row.label(text="", icon_value=_swatch(albedo))
    if stored.channels >= 3:
        layout.prop(operator, "as_rgb")
    if choice.is_rgb(stored) and not operator.as_rgb:
        layout.label(text="In the colors of the picture", icon="INFO")


def _swatch(albedo):
    """Returns the icon of a color."""
    key = repr(albedo)
    if key not in icons.pictures():
        picture = icons.pictures().new(key)
        picture.icon_size = (_SIDE, _SIDE)
        pixel = (*Color(albedo).from_scene_linear_to_srgb(), 1.0)
        picture.icon_pixels_float.foreach_set(np.tile(np.array(pixel, np.float32), _SIDE * _SIDE))
    return icons.pictures()[key].icon_id
