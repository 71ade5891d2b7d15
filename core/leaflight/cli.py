# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: info, bake, surface and compare.

Results go to stdout, with --json as one JSON object on the last line; progress goes to stderr.
Exit status: 0; 2 after an error, told in one line on stderr; 130 after Ctrl-C; after both nothing
is written.
"""

import argparse
import json
import sys

import numpy as np

from ._core import Cancelled, LeaflightError
from .bake import bake, load_bake
from .compare import compare
from .output import check_writable
from .ply import write_ply
from .progress import run_with_progress
from .readers import read_volume
from .readers.raw import ENDIANS, TYPES
from .scene_file import load_scene
from .version import __version__
from .volume import bump_box, default_isovalue, default_window

ESTIMATORS = ("gather", "volumetric", "path")


def main(arguments=None):
    """Runs one command; returns the exit status."""
    try:
        options = _parser().parse_args(arguments)
        result, sentences = options.command(options)
    except (Cancelled, KeyboardInterrupt):
        print("leaflight: cancelled, nothing written.", file=sys.stderr)
        return 130
    except LeaflightError as error:
        print(f"leaflight: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    for sentence in sentences:
        print(sentence)
    if options.json:
        print(json.dumps(result))
    return 0


def _info(options):
    volume = _volume(options)
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


def _bake(options):
    check_writable(options.out, ".vdb", options.volume)
    scene = load_scene(options.scene) if options.scene else None
    volume = _volume(options)

    def work(progress):
        return bake(
            volume,
            scene,
            isovalues=options.isovalues,
            resolution=options.resolution,
            samples=options.samples,
            photons=options.photons,
            estimator=options.estimator,
            seed=options.seed,
            threads=options.threads,
            progress=progress,
        )

    baked = run_with_progress(work, "bake")
    baked.save(options.out)
    result = {
        "out": options.out,
        "scene": baked.scene.name,
        "isovalues": list(baked.isovalues),
        "resolution": list(baked.grid.resolution),
        **baked.statistics,
    }
    lo, hi = baked.isovalues
    return result, [
        f"{options.out}: isovalues {lo:g}..{hi:g} in {baked.scene.name}, "
        f"{result['texels']} texels, {result['seconds']:.1f} s, "
        f"{result['rays_per_second'] / 1e6:.2f} million rays/s, "
        f"{result['peak_memory_bytes'] / 2**20:.0f} MiB",
        *(f"skipped: {name} ({reason})" for name, reason in result["skipped_passes"]),
    ]


def _surface(options):
    check_writable(options.out, ".ply", options.bake)
    baked = load_bake(options.bake)
    surface = baked.surface(options.isovalue)
    write_ply(options.out, surface, baked.scene.exposure)
    result = {
        "out": options.out,
        "isovalue": options.isovalue,
        "vertices": len(surface.vertices),
        "triangles": len(surface.triangles),
        "seconds": surface.seconds,
    }
    return result, [
        f"{options.out}: isovalue {options.isovalue:g}, {result['triangles']} triangles in "
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
        )

    result = run_with_progress(work, "compare")
    return result, [
        f"isovalue {options.isovalue:g}, all points: {_errors(result)}",
        f"isovalue {options.isovalue:g}, seen from outside: {_errors(result['exposed'])}",
        f"bake {result['bake_seconds']:.1f} s, reference {result['reference_seconds']:.1f} s at "
        f"{result['points']} points with {result['spp']} paths each",
    ]


def _errors(result):
    if result["points"] == 0:
        return "none"
    relative = result["relative_rms"]
    return (
        f"RMS error {result['rms_percent']:.2f} % "
        f"(of which the reference's noise {result['reference_noise_percent']:.2f} %), "
        + (f"{100 * relative:.2f} % of the mean radiance" if relative is not None else "all dark")
    )


def _volume(options):
    layout = {
        name: getattr(options, name) for name in ("type", "endian", "spacing", "grid", "frame")
    }
    if options.volume == "bump_box":
        for name, value in layout.items():
            if value is not None:
                raise LeaflightError(f"bump_box: --{name} has no meaning here; leave it out.")
        if options.dims is not None and len(options.dims) != 1:
            raise LeaflightError("bump_box: --dims takes one number of nodes a side.")
        return bump_box(*(options.dims or []))
    return read_volume(options.volume, dims=options.dims, **layout)


class _Parser(argparse.ArgumentParser):
    def __init__(self, **options):
        # Abbreviations would change meaning whenever an option is added.
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        raise LeaflightError(f"{message}; see '{self.prog} --help'.")


def _parser():
    parser = _Parser(
        prog="leaflight", description="Global illumination for every isosurface of a volume."
    )
    parser.add_argument("--version", action="version", version=f"leaflight {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")

    volume = _Parser(add_help=False)
    volume.add_argument(
        "volume", metavar="VOLUME", help="a file, a folder of TIFF slices, or bump_box"
    )
    volume.add_argument(
        "--dims",
        type=int,
        nargs="+",
        metavar="N",
        help=".raw: nx ny nz; bump_box: nodes a side (100)",
    )
    volume.add_argument("--type", choices=TYPES, help=".raw: type of the values")
    volume.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    volume.add_argument(
        "--spacing",
        type=float,
        nargs="+",
        metavar="S",
        help=".raw, TIFF: voxel size, one or X Y Z (1)",
    )
    volume.add_argument(
        "--grid", metavar="NAME", help=".vdb: name of the grid (the first scalar one)"
    )
    volume.add_argument("--frame", type=int, metavar="K", help="4D data: frame to read, from 0")

    seed = _Parser(add_help=False)
    seed.add_argument("--seed", type=int, default=0, metavar="N", help="same seed, same result (0)")
    seed.add_argument("--threads", type=int, default=0, metavar="N", help="threads (0: every core)")

    isovalue = _Parser(add_help=False)
    isovalue.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    isovalue.add_argument(
        "--isovalue", type=float, required=True, metavar="C", help="in data units"
    )

    info = commands.add_parser("info", parents=[volume], help="what a volume holds")
    info.set_defaults(command=_info)

    baking = commands.add_parser(
        "bake", parents=[volume, seed], help="light every isosurface of a volume"
    )
    baking.add_argument("--out", required=True, metavar="X.vdb", help="file to write")
    baking.add_argument(
        "--scene", metavar="FILE", help="scene file (a Cornell box around the volume)"
    )
    baking.add_argument(
        "--isovalues",
        type=float,
        nargs=2,
        metavar=("LO", "HI"),
        help="window to bake (from the data)",
    )
    baking.add_argument(
        "--resolution", type=int, metavar="N", help="texels on the longest axis (one a voxel)"
    )
    baking.add_argument("--samples", type=int, default=32, metavar="N", help="rays a texel (32)")
    baking.add_argument(
        "--photons", type=int, default=2_000_000, metavar="N", help="photons (2000000)"
    )
    baking.add_argument("--estimator", choices=ESTIMATORS, default="gather", help="(gather)")
    baking.set_defaults(command=_bake)

    surface = commands.add_parser(
        "surface", parents=[isovalue], help="one lit isosurface as a mesh"
    )
    surface.add_argument("--out", required=True, metavar="MESH.ply", help="file to write")
    surface.set_defaults(command=_surface)

    comparison = commands.add_parser(
        "compare", parents=[isovalue, seed], help="the error of a bake against path tracing"
    )
    comparison.add_argument("--points", type=int, default=3000, metavar="N", help="points (3000)")
    comparison.add_argument(
        "--spp", type=int, default=1024, metavar="N", help="paths a point (1024)"
    )
    comparison.set_defaults(command=_compare)

    for command in (info, baking, surface, comparison):
        command.add_argument(
            "--json", action="store_true", help="print one JSON object as the last line"
        )
    return parser


def _by(numbers):
    return " x ".join(f"{number:g}" for number in numbers)
