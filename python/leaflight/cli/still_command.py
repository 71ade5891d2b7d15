# SPDX-License-Identifier: GPL-3.0-or-later
"""The command still: a picture of a lit isosurface."""

import time
from argparse import Namespace
from pathlib import Path

import leaflight._core as _core

from .._core import LeaflightError, Progress
from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import write_png
from ..io.output import check_writable
from ..stills.camera import Camera, load_camera
from ..scene.color_bar import captions_of
from ..stills.drawn_color_bar import bar_of_bake, with_color_bar
from ..stills.first_view import camera_around_bake
from ..stills.photograph import metered_stops, photographed
from ..stills.still import still
from ..volume.setting_error import SettingError
from ..words import figures
from ..progress_bar import run_with_progress
from .lighting import opened
from .output import Output

SUFFIXES = (".png", ".exr")


def run_still(options: Namespace) -> Output:
    suffix = Path(options.out).suffix.lower()
    if suffix not in SUFFIXES:
        raise LeaflightError(f"{options.out}: a picture must end in {' or '.join(SUFFIXES)}.")
    check_writable(options.out, suffix, options.bake)
    baked = opened(options)
    isovalue = options.isovalue
    camera = _camera(baked, options, isovalue)
    start = time.perf_counter()

    def work(progress: Progress) -> Array:
        return still(
            baked,
            isovalue,
            camera,
            options.size,
            options.samples,
            walls=not options.no_walls,
            local=options.local,
            progress=progress,
        )

    if options.color_bar and suffix == ".exr":
        raise SettingError(
            f"{options.out}: a color bar is not radiance: write a .png, or leave it out.",
            "color_bar",
        )
    bar = bar_of_bake(baked) if options.color_bar else None
    picture = run_with_progress(work, "still")
    if suffix == ".exr":
        _core.write_exr(options.out, picture)
    else:
        exposure = baked.scene.exposure * 2.0 ** metered_stops(baked)
        pixels = photographed(picture, exposure)
        write_png(options.out, pixels if bar is None else with_color_bar(pixels, bar))
    seconds = time.perf_counter() - start
    captions = captions_of(baked.scene)
    result = {
        "out": options.out,
        "isovalue": isovalue,
        "colors": captions,
        "size": list(options.size),
        "filled": float(picture[..., 3].mean()),
        "seconds": seconds,
    }
    width, height = options.size
    shown, *_ = figures(isovalue, *baked.isovalues)
    return result, [
        f"{options.out}: isovalue {shown}, {width} x {height} pixels, {seconds:.1f} s",
        *(f"color: {caption}" for caption in captions),
    ]


def _camera(baked: Bake, options: Namespace, isovalue: float) -> Camera:
    if options.camera is None:
        zoom = 1.0 if options.zoom is None else options.zoom
        around, up = options.view or (None, None)
        return camera_around_bake(baked, around, up, zoom, isovalue, options.size)
    if options.zoom is not None:
        raise SettingError("The zoom does not apply to a camera from a file: leave it out.", "zoom")
    return load_camera(options.camera)
