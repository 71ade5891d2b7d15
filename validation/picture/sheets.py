# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures beside each other."""

from PIL import Image

# Gap between pictures, in pixels.
GAP = 6


def sheet(pictures, columns, gap=GAP):
    """Returns pictures of one size in rows of so many columns, on white."""
    width, height = (size + gap for size in pictures[0].size)
    rows = -(-len(pictures) // columns)
    whole = Image.new("RGB", (columns * width - gap, rows * height - gap), "white")
    for number, picture in enumerate(pictures):
        whole.paste(picture, (number % columns * width, number // columns * height))
    return whole


def save_webp(picture, path, quality=85):
    picture.convert("RGB").save(path, quality=quality, method=6)
