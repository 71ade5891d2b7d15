# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: info, bake, surface, compare, flatland, report and bench.

Results go to stdout, with --json as one JSON object on the last line; progress goes to stderr.
Exit status: 0; 1 when a report found an error that is not what it must be; 2 after an error, told
in one line on stderr; 130 after Ctrl-C; after the last two nothing is written.
"""

import json
import sys
from dataclasses import asdict, replace
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import Cancelled, LeaflightError
from ..bake.bake import bake, load_bake
from ..bake.estimate import estimate
from ..bake.outcome import outcome
from ..bake.photons import trace_photons
from ..bake.settings import PhotonMap, Scattered
from ..flatland.flat_scene import load_flat_scene
from ..flatland.flatland import (
    BRIGHTNESS_CORRECTION,
    bake_flatland,
    bump_box_2d,
    picture,
    read_image,
)
from ..io.images import write_png
from ..io.output import check_writable
from ..io.ply import write_photons, write_ply
from ..io.scene_file import cornell_box, load_scene
from ..io.sources import open_volume
from ..measure.compare import compare
from ..volume.volume import default_isovalue, default_window
from .parser import make_parser
from .progress import run_with_progress


def main(arguments=None):
    """Runs one command; returns the exit status."""
    try:
        options = make_parser(COMMANDS).parse_args(arguments)
        result, sentences = options.command(options)
    except (Cancelled, KeyboardInterrupt):
        print("leaflight: cancelled, nothing written.", file=sys.stderr)
        return 130
    except LeaflightError as error:
        print(f"leaflight: {_in_flags(error)}", file=sys.stderr)
        return 2
    for sentence in sentences:
        print(sentence)
    if options.json:
        print(json.dumps(result))
    return 0 if result.get("passed", True) else 1


def _info(options):
    volume = _open(options.volume, options)
    field = volume.field()
    low, high = field.range
    lo, hi = default_window(volume)
    result = {
        "source": volume.source,
        "name": volume.name,
        "dims": list(field.dims),
        "range": [low, high],
        "masked": field.masked,
        "spacing": np.linalg.norm(volume.index_to_world[:3, :3], axis=0).tolist(),
        "bounds": np.asarray(field.bounds).tolist(),
        "index_to_world": volume.index_to_world.tolist(),
        "isovalues": [lo, hi],
        "isovalue": default_isovalue(volume),
    }
    return result, [
        f"{volume.source}: {_by(result['dims'])} voxels of {_by(result['spacing'])}"
        + (", some without data" if field.masked else ""),
        f"values {low:g}..{high:g}; by default isovalues {lo:g}..{hi:g} are baked "
        f"and {result['isovalue']:g} is shown",
    ]


def _to_light(options, suffix):
    """The volumes and the scene of a command that lights them and writes a file."""
    scene = load_scene(options.scene) if options.scene else cornell_box()
    sources = options.volumes or [leaves.source for leaves in scene.leaves]
    if None in sources:
        raise LeaflightError(
            "Nothing to light: name a VOLUME, or give --scene a file whose volumes have a source."
        )
    if options.out is not None:
        check_writable(options.out, suffix, *sources)
    volumes = [_open(source, options) for source in sources]
    if options.capped:
        scene = replace(scene, leaves=[replace(leaves, capped=True) for leaves in scene.leaves])
    return volumes, scene


def _photons(options):
    volumes, scene = _to_light(options, ".ply")

    def work(progress):
        return trace_photons(
            volumes,
            scene,
            count=options.photons,
            isovalues=options.isovalues,
            seed=options.seed,
            progress=progress,
        )

    photons = run_with_progress(work, "photons")
    write_photons(options.out, photons)
    direct = int(photons.direct.sum())
    result = {"out": options.out, "points": len(photons.direct), "direct": direct}
    return result, [
        f"{options.out}: {result['points']} arrivals of {photons.count} photons at isosurfaces, "
        f"{direct} of them straight from a light"
    ]


def _bake(options):
    volumes, scene = _to_light(options, ".vdb")
    names = ("error", "time", "caustic_photons", "soft_spacing", "refine")
    settings = {
        **_work_options(options),
        **_given(options, **{name: name for name in names}),
        "both_sides": options.both_sides,
        "surroundings": options.surroundings,
    }
    if options.estimate:
        return _estimate(volumes, scene, settings)

    def work(progress):
        return bake(volumes, scene, progress=progress, **settings)

    baked = run_with_progress(work, "bake")
    baked.save(options.out)
    result = {
        "out": options.out,
        "scene": baked.scene.name,
        "isovalues": list(baked.isovalues),
        "volumes": [
            {"name": leaves.name, "isovalues": list(leaves.isovalues or baked.isovalues)}
            for leaves in baked.scene.leaves
        ],
        "resolution": list(baked.grid.resolution),
        "levels": baked.grid.levels,
        **baked.statistics,
    }
    lo, hi = baked.isovalues
    end = outcome(baked, why=f"the {options.time or 0:g} s are over")
    return result, [
        f"{options.out}: isovalues {lo:g}..{hi:g} in {baked.scene.name}, "
        f"{result['texels']} texels, {result['seconds']:.1f} s, "
        f"{result['rays_per_second'] / 1e6:.2f} million rays/s, "
        f"{result['peak_memory_bytes'] / 2**20:.0f} MiB, "
        f"noise about {result['estimated_rms_percent']:.2f} %",
        *([end] if end else []),
        *_leaf_map(baked),
        *(f"skipped: {name} ({reason})" for name, reason in result["skipped_passes"]),
    ]


def _estimate(volumes, scene, settings):
    def work(progress):
        return estimate(volumes, scene, progress=progress, **settings)

    cost = run_with_progress(work, "estimate")
    return asdict(cost), [
        f"about {cost.seconds:.0f} s and {cost.memory_bytes / 2**20:.0f} MiB to an error of "
        f"{cost.error:.2g} %, by {cost.pilot_rounds} of {cost.rounds} rounds done in "
        f"{cost.pilot_seconds:.1f} s"
    ]


def _work_options(options):
    """What is baked, and how well: those arguments that bake and bake_flatland have in common."""
    names = ("isovalues", "resolution", "samples", "photons", "estimator", "seed", "threads")
    return {
        **_given(options, **{name: name for name in names}),
        "photon_map": _photon_map(options),
        "scattered": _scattered(options),
    }


def _photon_map(options):
    given = _given(options, k="k", radius="photon_radius", g="g", region="region")
    return PhotonMap(**given) if given else None


def _scattered(options):
    given = _given(
        options,
        strategy="strategy",
        count="count",
        isovalues="isovalue_count",
        filter="filter",
        radius="filter_radius",
    )
    if not given:
        return None
    if "strategy" not in given or "count" not in given:
        raise LeaflightError("Scattered samples need both --strategy NAME and --count N.")
    return Scattered(**given)


def _in_flags(error):
    """The sentence of an error on one line, with the flags of the settings that it speaks of."""
    sentence = " ".join(str(error).split())
    flags = ", ".join(f"--{setting}" for setting in getattr(error, "settings", ()))
    return f"{sentence.removesuffix('.')} ({flags})." if flags else sentence


def _given(options, **names):
    """The options that were given, by the names that the settings have for them."""
    values = {name: getattr(options, option) for name, option in names.items()}
    return {name: value for name, value in values.items() if value is not None}


def _leaf_map(baked):
    """What the volumes show at the leaf coordinates 0..1, where there are several."""
    if len(baked.volumes) == 1:
        return []
    return [
        f"--isovalue 0..1 shows volume {k} ({leaves.name}) at {leaves.isovalues[0]:g}.."
        f"{leaves.isovalues[1]:g}"
        for k, leaves in enumerate(baked.scene.leaves)
    ]


def _surface(options):
    check_writable(options.out, ".ply", options.bake)
    baked = load_bake(options.bake)

    def work(progress):
        return baked.surface(
            options.isovalue,
            options.volume,
            options.back,
            settle=options.settle,
            seed=options.seed,
            threads=options.threads,
            progress=progress,
        )

    surface = run_with_progress(work, "surface")
    write_ply(options.out, surface, baked.scene.exposure)
    result = {
        "out": options.out,
        "isovalue": options.isovalue,
        "volume": options.volume,
        "vertices": len(surface.vertices),
        "triangles": len(surface.triangles),
        "settled": options.settle,
        "seconds": surface.seconds,
    }
    return result, [
        f"{options.out}: isovalue {_isovalue(baked, options)}, {result['triangles']} triangles in "
        f"{surface.seconds:.3f} s"
    ]


def _compare(options):
    baked = load_bake(options.bake)

    def work(progress):
        return compare(
            baked,
            options.isovalue,
            points=options.points,
            spp=options.spp,
            seed=options.seed,
            threads=options.threads,
            progress=progress,
            volume=options.volume,
            back=options.back,
            mesh=options.mesh,
            reference=options.reference,
            settle=options.settle,
        )

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


def _parts(parts):
    mesh = parts["mesh_percent"]
    return (
        f"of which noise of the bake {parts['noise_percent']:.2f} %, texture "
        f"{parts['texture_percent']:.2f} %"
        + ("" if mesh is None else f", mesh instead of the leaf {mesh:.2f} %")
        + " (squares add up)"
    )


def _isovalue(baked, options):
    """The leaf coordinate asked for, and with several volumes what it shows of the one."""
    if len(baked.volumes) == 1:
        return f"{options.isovalue:g}"
    own = baked.isovalue_of(options.volume, options.isovalue)
    return f"{options.isovalue:g} ({own:g} of {baked.scene.leaves[options.volume].name})"


def _flatland(options):
    check_writable(options.out, ".exr", options.image)
    png = Path(options.out).with_suffix(".png")
    check_writable(png, ".png", options.image)
    scene = load_flat_scene(options.scene) if options.scene else None
    if options.image == "bump_box":
        volume = bump_box_2d(*([] if options.dims is None else [options.dims]))
    elif options.dims is not None:
        raise LeaflightError(f"{options.image}: --dims has no meaning here; leave it out.")
    else:
        volume = read_image(options.image)

    # A bake of space takes as many by default.
    work_options = {"samples": 32, **_work_options(options)}

    def work(progress):
        return bake_flatland(volume, scene, progress=progress, **work_options)

    baked = run_with_progress(work, "flatland")
    isolines = options.isolines or [default_isovalue(volume)]
    correction = 1.0 if options.uncorrected else BRIGHTNESS_CORRECTION
    pixels = picture(baked, isolines, correction=correction)
    _core.write_exr(options.out, np.ascontiguousarray(baked.texture()[::-1]))
    write_png(png, pixels)
    result = {
        "out": options.out,
        "picture": str(png),
        "isovalues": list(baked.isovalues),
        "isolines": isolines,
        "resolution": list(baked.grid.resolution),
        **baked.statistics,
    }
    lo, hi = baked.isovalues
    return result, [
        f"{options.out}: isovalues {lo:g}..{hi:g} in {baked.scene.name}, "
        f"{_by(result['resolution'])} texels, {result['seconds']:.1f} s",
        f"{png}: isolines {', '.join(f'{isovalue:g}' for isovalue in isolines)}",
    ]


def _report(options):
    try:
        # Not everywhere is the report installed, and only this command needs it.
        from ..report.command import run_report
    except ModuleNotFoundError:
        raise LeaflightError(
            "The report is not part of this installation: pip install 'leaflight[report]'."
        ) from None
    return run_report(options, run_with_progress)


def _bench(options):
    try:
        # As the report.
        from ..bench.command import run_bench
    except ModuleNotFoundError:
        raise LeaflightError(
            "The benchmarks are not part of this installation: pip install leaflight."
        ) from None
    return run_bench(options, run_with_progress)


def _errors(result):
    if result["points"] == 0:
        return "none"
    noise = f"(of which the reference's noise {result['reference_noise_percent']:.2f} %)"
    relative = "all dark"
    if result["relative_rms"] is not None:
        relative = (
            f"{100 * result['relative_rms']:.2f} % of the mean radiance, mean ratio "
            f"{result['mean_ratio']:.4f} +- {result['mean_ratio_error']:.4f}"
        )
    return f"RMS error {result['rms_percent']:.2f} % {noise}, {relative}"


def _open(source, options):
    names = ("dims", "type", "endian", "spacing", "grid", "frame")
    return open_volume(source, **{name: getattr(options, name) for name in names})


def _by(numbers):
    return " x ".join(f"{number:g}" for number in numbers)


COMMANDS = {
    "info": _info,
    "bake": _bake,
    "surface": _surface,
    "photons": _photons,
    "compare": _compare,
    "flatland": _flatland,
    "report": _report,
    "bench": _bench,
}
