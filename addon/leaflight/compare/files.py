# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a comparison, and the picture with all its stills."""

import csv
import json
from pathlib import Path

import bpy
import numpy as np
from leaflight.io.images import display_colors, write_exr, write_png
from leaflight.io.output import replaced

from .stills import flip_words

# Gain of the difference in its PNG, which would be black otherwise. The EXR has the signed values.
_DIFFERENCE_GAIN = 5.0

_STILLS = ("baked", "cycles", "local", "difference")


def write(folder, name, result):
    """Writes the result of stills.compare().

    The files are STEM_{baked,cycles,local,difference}.{exr,png} and STEM_comparison.{png,csv,json}.
    The .csv has a row for each still, the .json all numbers. Returns the path of the .json.
    """
    stem = str(Path(folder) / f"{name}_{result['isovalue']:g}".replace("/", "_"))
    for still in _STILLS:
        image = np.ascontiguousarray(result[still])
        write_exr(f"{stem}_{still}.exr", image)
        shown = _DIFFERENCE_GAIN * np.abs(image) if still == "difference" else image
        write_png(f"{stem}_{still}.png", display_colors(shown, result["exposure"]))
    write_sheet(f"{stem}_comparison.png", name, result)
    numbers = {key: value for key, value in result.items() if not isinstance(value, np.ndarray)}
    numbers = {"name": name, **numbers}
    _write_table(f"{stem}_comparison.csv", numbers)
    path = Path(f"{stem}_comparison.json")
    with replaced(path) as temporary:
        temporary.write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    return path


def _write_table(path, numbers):
    rows = [
        ("baked", "baked_seconds", "isosurface_rms_percent"),
        ("local", "local_seconds", "local_rms_percent"),
        ("cycles", "cycles_seconds", None),
    ]
    with replaced(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["name", "isovalue", "still", "render_seconds", "rms_percent_on_isosurface"])
        for still, seconds, rms in rows:
            error = "" if rms is None else f"{numbers[rms]:.4f}"
            isovalue = f"{numbers['isovalue']:g}"
            table.writerow([numbers["name"], isovalue, still, f"{numbers[seconds]:.3f}", error])


# Least width of a still in pixels, which fits its label, and greatest width, which fits a screen.
_NARROWEST, _WIDEST = 560, 960
_WHITE, _INK, _PAPER = (255, 255, 255), (20, 20, 20), (255, 255, 255)

# Colors of the difference: baked darker, equal, baked brighter.
_COLORS = np.array([[0.02, 0.19, 0.58], [0.97, 0.97, 0.97], [0.70, 0.02, 0.15]])


def write_sheet(path, name, result):
    """Writes the picture (.png) of a result of stills.compare()."""
    from PIL import Image, ImageDraw

    exposure = result["exposure"]
    difference, most = _percent_off(result, exposure)
    height, width = difference.shape
    scale = _scale(width)
    size = (round(scale * width), round(scale * height))
    text = max(13, size[0] // 42)
    gap, line = text, round(1.45 * text)
    font = _font(text)
    pictures = [display_colors(result[name], exposure) for name in ("baked", "cycles", "local")]
    pictures.append(_colored(difference / most))
    bar = 7 * text
    top = gap + 2 * line
    cell = (size[0] + gap, size[1] + 2 * line + gap)
    sheet = Image.new("RGB", (gap + 2 * cell[0] + bar, top + 2 * cell[1]), _PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((gap, gap), f"{name}, isovalue {result['isovalue']:g}", _INK, _font(text + 4))
    # Keep the pixels of small stills visible.
    resample = Image.NEAREST if scale >= 2 else Image.LANCZOS
    for number, (pixels, (title, detail)) in enumerate(zip(pictures, _words(result))):
        x, y = gap + (number % 2) * cell[0], top + (number // 2) * cell[1]
        sheet.paste(Image.fromarray(pixels).resize(size, resample), (x, y))
        draw.text((x, y + size[1] + 4), title, _INK, font)
        draw.text((x, y + size[1] + 4 + line), detail, (90, 90, 90), font)
    _draw_bar(sheet, draw, font, (gap + 2 * cell[0], top + cell[1]), (text, size[1]), most)
    with replaced(path) as temporary:
        sheet.save(temporary)


def _words(result):
    """Returns [(title, detail), ...], the texts below the pictures."""
    rendered = "rendered in {baked_seconds:.1f} s; all isosurfaces baked in {bake_seconds:.0f} s"
    local = "rendered in {local_seconds:.1f} s; RMS {local_rms_percent:.1f} % on the isosurface"
    difference = (
        "RMS {isosurface_rms_percent:.2f} % on the isosurface, including noise "
        "{isosurface_noise_percent:.2f} %; {flip}"
    )
    texts = (
        ("Baked", rendered),
        ("Cycles, {samples} samples", "path-traced in {cycles_seconds:.1f} s"),
        ("Local shading: no shadows, no bounces", local),
        ("Baked minus Cycles", difference),
    )
    numbers = {**result, "flip": flip_words(result)}
    return [(title.format(**numbers), detail.format(**numbers)) for title, detail in texts]


def _percent_off(result, exposure):
    """Returns (displayed baked minus Cycles in percent, mean of the channels; a round range)."""
    baked, cycles = (
        np.clip(result[name] * exposure, 0.0, 1.0).mean(axis=-1) for name in ("baked", "cycles")
    )
    off = 100.0 * (baked - cycles)
    largest = max(float(np.percentile(np.abs(off), 99.5)), 0.1)
    power = 10.0 ** np.floor(np.log10(largest))
    return off, next(step * power for step in (1, 2, 5, 10) if step * power >= largest)


def _colored(share):
    """Returns the colors, uint8, of shares -1 to 1 of the range."""
    place = np.clip(share, -1.0, 1.0)
    channels = [np.interp(place, (-1, 0, 1), _COLORS[:, channel]) for channel in range(3)]
    return np.rint(255 * np.stack(channels, axis=-1)).astype(np.uint8)


def _draw_bar(sheet, draw, font, corner, size, most):
    """Draws the colors of the difference from top to bottom, with their values."""
    from PIL import Image

    (x, y), (width, height) = corner, size
    shares = np.repeat(np.linspace(1.0, -1.0, height)[:, None], width, axis=1)
    sheet.paste(Image.fromarray(_colored(shares)), (x, y))
    draw.rectangle([x, y, x + width, y + height - 1], outline=_INK)
    for share in (1.0, 0.5, 0.0, -0.5, -1.0):
        at = y + (1.0 - share) / 2.0 * (height - 1)
        draw.line([x + width, at, x + width + 4, at], _INK)
        label = "0" if share == 0 else f"{share * most:+.3g} %"
        draw.text((x + width + 8, at), label, _INK, font, anchor="lm")


def _scale(width):
    if width < _NARROWEST:
        scale = _NARROWEST / width
        return float(np.ceil(scale)) if scale > 2 else scale
    return min(1.0, _WIDEST / width)


def _font(size):
    """Returns Blender's font, whose name depends on the version, or else that of Pillow."""
    from PIL import ImageFont

    folder = bpy.utils.system_resource("DATAFILES", path="fonts")
    for name in ("DejaVuSans.woff2", "Inter.woff2", "droidsans.ttf"):
        try:
            return ImageFont.truetype(str(Path(folder) / name), size)
        except OSError:
            continue
    return ImageFont.load_default()
