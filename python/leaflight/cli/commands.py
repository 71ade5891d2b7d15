# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: info, bake, batch, surface, still, export, photons, render, compare, flatland.

Results go to stdout, with --json as one JSON object on the last line. Progress goes to stderr. The
exit status is 0 for success. It is 2 after an error, which is one line on stderr, and 130 after
Ctrl-C; no file is written then.
"""

import warnings
from argparse import Namespace
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TextIO

import numpy as np

import leaflight._core as _core

from .._core import Cancelled, LeaflightError, Progress
from ..bake.baked import Bake, Surface
from ..bake.photons import Photons, trace_photons
from ..bake.settings import ChosenSetting, UnusedSetting
from ..bake.statistics import outcome
from ..bake.load_bake import load_bake
from ..export import ply
from ..export.export import export
from ..flatland.flat_scene import load_flat_scene
from ..flatland.flatland import (
    FlatBake,
    bake_flatland,
    bump_box_2d,
    picture,
    read_image,
)
from ..io.images import write_png
from ..io.output import check_writable, replaced_together
from ..io.readers.channels import Channel
from ..io.readers.checks import listed
from ..io.readers.reading import StoredOptions, probe
from ..io.sources import is_generated
from ..measure.compare import compare
from ..progress_bar import run_with_progress
from ..volume.first_isovalue import default_isovalue, default_isovalue_range
from ..volume.label_table import labels_of
from ..words import by, figures
from .bake_command import run_bake
from .batch_command import run_batch
from .lighting import bake_options, given_options, open_with, opened, to_light
from .output import Command, Output, json_line, picked, print_error, print_lines
from .render_command import run_render
from .still_command import run_still


def run(options: Namespace) -> int:
    """Runs the command that the options name, and returns the exit status."""
    try:
        with warnings.catch_warnings():
            for kind in (ChosenSetting, UnusedSetting):
                warnings.simplefilter("always", kind)
            warnings.showwarning = _print_warning
            result, sentences = COMMANDS[options.command](options)
    except Cancelled as end:
        print_error(str(end))
        return 130
    except KeyboardInterrupt:
        print_error("cancelled.")
        return 130
    except LeaflightError as error:
        print_error(_in_flags(error))
        return 2
    except MemoryError:
        print_error("There is not enough memory: give a smaller volume, or use --downsample.")
        return 2
    if not print_lines([*sentences, json_line(result)] if options.json else sentences):
        return 2
    return 0


def _print_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Prints a warning as one line; replaces warnings.showwarning()."""
    print_error(str(message))


def _channels(options: Namespace) -> list[Channel]:
    """Returns the channels of a file; none if there is only one, or if it is generated."""
    if is_generated(options.volume):
        return []
    given = given_options(options, StoredOptions.__annotations__)
    stored = probe(options.volume, **given)
    return [stored.channel(k) for k in range(stored.channels)] if stored.channels > 1 else []


def _info(options: Namespace) -> Output:
    volume = open_with(options.volume, options)
    channels = _channels(options)
    field = volume.field()
    low, high = field.range
    lo, hi = default_isovalue_range(volume)
    isovalue = default_isovalue(volume)
    least, most, first, last, shown = figures(low, high, lo, hi, isovalue)
    numbered = [f"{k} {channel.name}".strip() for k, channel in enumerate(channels)]
    is_map = volume.labels and options.field is None
    labels = labels_of(volume.values, volume.labels) if is_map else ()
    result = {
        "source": volume.source,
        "name": volume.name,
        "dims": list(field.dims),
        "range": [low, high],
        "masked": field.masked,
        "spacing": list(volume.spacing),
        "unit": volume.unit,
        "bounds": np.asarray(field.bounds).tolist(),
        "index_to_world": volume.index_to_world.tolist(),
        "isovalues": [lo, hi],
        "isovalue": isovalue,
        "channels": [asdict(channel) for channel in channels],
        "notes": list(volume.notes),
        "labels": [asdict(label) for label in labels],
    }
    names = [f"{label.number} {label.name}" for label in labels]
    return result, [
        f"{volume.source}: {by(result['dims'])} voxels of {by(result['spacing'])}"
        f" {volume.unit or '(no unit)'}" + (", some without data" if field.masked else ""),
        f"values {least}..{most}; by default isovalues {first}..{last} are baked "
        f"and {shown} is shown",
        *([f"channels {listed(numbered)}"] if channels else []),
        *([f"labels {listed(names)}"] if names else []),
        *volume.notes,
    ]


def _photons(options: Namespace) -> Output:
    ply.library(options.out)
    volumes, scene = to_light(options, ".ply")

    def work(progress: Progress) -> Photons:
        how = picked(options, "isovalues seed")
        photons = trace_photons(volumes, scene, count=options.photons, progress=progress, **how)
        progress.check()
        ply.write_photons(options.out, photons)
        return photons

    photons = run_with_progress(work, "photons", writes=True)
    direct = int(photons.direct.sum())
    result = {"out": options.out, "points": len(photons.direct), "direct": direct}
    return result, [
        f"{options.out}: {result['points']} hits of {photons.count} photons on isosurfaces, "
        f"{direct} of them straight from a light"
    ]


def _in_flags(error: LeaflightError) -> str:
    """Returns the message of an error on one line, with settings as flags."""
    sentence = " ".join(str(error).split())
    flags = ", ".join(
        f"--{setting.replace('_', '-')}" for setting in getattr(error, "settings", ())
    )
    return f"{sentence.removesuffix('.')} ({flags})." if flags else sentence


def _surface(options: Namespace) -> Output:
    ply.library(options.out)
    check_writable(options.out, ".ply", options.bake)
    baked = opened(options)

    def work(progress: Progress) -> Surface:
        surface = baked.surface(options.isovalue, options.volume, options.back)
        progress.check()
        ply.write_ply(options.out, surface, baked.scene.exposure)
        return surface

    surface = run_with_progress(work, "surface", writes=True)
    result = {
        **picked(options, "out isovalue volume"),
        "vertices": len(surface.vertices),
        "triangles": len(surface.triangles),
        "seconds": surface.seconds,
    }
    return result, [
        f"{options.out}: isovalue {_isovalue(baked, options)}, {result['triangles']} triangles in "
        f"{surface.seconds:.3f} s"
    ]


def _compare(options: Namespace) -> Output:
    baked = opened(options)

    def work(progress: Progress) -> dict[str, Any]:
        how = picked(options, "points spp seed threads volume back mesh reference")
        return compare(baked, options.isovalue, progress=progress, **how)

    result = run_with_progress(work, "compare")
    isovalue = _isovalue(baked, options)
    exposed = result["exposed"]
    return result, [
        f"isovalue {isovalue}, all points: {_errors(result)}",
        *([f"isovalue {isovalue}, seen from outside: {_errors(exposed)}"] if exposed else []),
        *([_parts(result["parts"])] if result["parts"] else []),
        f"bake {result['bake_seconds']:.1f} s, reference {result['reference_seconds']:.1f} s at "
        f"{result['points']} points with {result['spp']} paths each",
    ]


def _parts(parts: Mapping[str, float | None]) -> str:
    mesh = parts["mesh_percent"]
    return (
        f"of which noise of the bake {parts['noise_percent']:.2f} %, texture "
        f"{parts['texture_percent']:.2f} %"
        + ("" if mesh is None else f", mesh {mesh:.2f} %")
        + " (squares add up)"
    )


def _isovalue(baked: Bake, options: Namespace) -> str:
    """Returns the common isovalue asked for, with that of the chosen one of several volumes."""
    if len(baked.volumes) == 1:
        return figures(options.isovalue, *baked.isovalues)[0]
    local = baked.isovalue_of(options.volume, options.isovalue)
    return f"{options.isovalue:g} ({local:g} of {baked.scene.isosurfaces[options.volume].name})"


def _flatland(options: Namespace) -> Output:
    check_writable(options.out, ".exr", options.image)
    png = Path(options.out).with_suffix(".png")
    check_writable(png, ".png", options.image)
    scene = load_flat_scene(options.scene) if options.scene else None
    if options.image == "bump_box":
        volume = bump_box_2d(*([] if options.dims is None else [options.dims]))
    elif options.dims is not None:
        raise LeaflightError(f"{options.image}: --dims applies only to bump_box; leave it out.")
    else:
        volume = read_image(options.image)

    def work(progress: Progress) -> FlatBake:
        baked = bake_flatland(volume, scene, progress=progress, **bake_options(options))
        pixels = picture(baked, isolines)
        texture = np.ascontiguousarray(baked.texture()[::-1])
        progress.check()
        with replaced_together(options.out, png) as (texture_file, picture_file):
            _core.write_exr(texture_file, texture)
            write_png(picture_file, pixels)
        return baked

    isolines = options.isolines or [default_isovalue(volume)]
    baked = run_with_progress(work, "flatland", writes=True)
    result = {
        "out": options.out,
        "picture": str(png),
        "isovalues": list(baked.isovalues),
        "isolines": isolines,
        "resolution": list(baked.grid.resolution),
        **baked.statistics.record(),
    }
    lo, hi = baked.isovalues
    return result, [
        f"{options.out}: isovalues {lo:g}..{hi:g} in {baked.scene.name}, "
        f"{by(result['resolution'])} texels, {result['seconds']:.1f} s",
        outcome(baked),
        f"{png}: isolines {', '.join(f'{isovalue:g}' for isovalue in isolines)}",
    ]


def _export(options: Namespace) -> Output:
    baked = load_bake(options.bake)

    def work(progress: Progress) -> dict[float, Surface]:
        how = picked(options, "volume back explode coarser embed")
        return export(baked, options.out, options.isovalue, progress=progress, **how)

    surfaces = run_with_progress(work, "export", writes=True)
    out = Path(options.out)
    if options.embed:
        out = out.with_suffix("")
    size = sum(file.stat().st_size for file in (out.iterdir() if options.embed else [out]))
    result = {
        "out": str(out),
        "bytes": size,
        "volume": options.volume,
        "isosurfaces": [
            {
                "isovalue": isovalue,
                "vertices": len(surface.vertices),
                "triangles": len(surface.triangles),
            }
            for isovalue, surface in surfaces.items()
        ],
    }
    what = "all isosurfaces"
    if surfaces:
        triangles = sum(len(surface.triangles) for surface in surfaces.values())
        shown = ", ".join(figures(*surfaces, *baked.isovalues)[: len(surfaces)])
        what = f"isovalue{'s' if len(surfaces) > 1 else ''} {shown}, {triangles} triangles"
    return result, [f"{out}: {what}, {size / 2**20:.1f} MiB"]


def _errors(result: Mapping[str, Any]) -> str:
    if result["points"] == 0:
        return "none"
    noise = f"(of which noise of the reference {result['reference_noise_percent']:.2f} %)"
    relative = "all dark"
    if result["relative_rms"] is not None:
        relative = (
            f"{100 * result['relative_rms']:.2f} % of the mean radiance, mean ratio "
            f"{result['mean_ratio']:.4f} +- {result['mean_ratio_error']:.4f}"
        )
    return f"RMS error {result['rms_percent']:.2f} % {noise}, {relative}"


COMMANDS: dict[str, Command] = {
    "info": _info,
    "bake": run_bake,
    "batch": run_batch,
    "surface": _surface,
    "still": run_still,
    "export": _export,
    "photons": _photons,
    "render": run_render,
    "compare": _compare,
    "flatland": _flatland,
}
