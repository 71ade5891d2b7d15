# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: info, bake, surface and compare.

Results go to stdout, with --json as one JSON object on the last line; progress goes to stderr.
Exit status: 0; 2 after an error, told in one line on stderr; 130 after Ctrl-C; after both nothing
is written.
"""

import argparse
import json
import sys
from dataclasses import replace

import numpy as np

from ._core import Cancelled, LeaflightError
from .bake import bake, load_bake
from .compare import compare
from .output import check_writable
from .ply import write_ply
from .progress import run_with_progress
from .readers.raw import ENDIANS, TYPES
from .scene_file import cornell_box, load_scene
from .sources import GENERATED, open_volume
from .version import __version__
from .volume import default_isovalue, default_window

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


def _bake(options):
    scene = load_scene(options.scene) if options.scene else cornell_box()
    sources = options.volumes or [leaves.source for leaves in scene.leaves]
    if None in sources:
        raise LeaflightError(
            "bake: name a VOLUME, or give --scene a file whose volumes all have a source."
        )
    check_writable(options.out, ".vdb", *sources)
    volumes = [_open(source, options) for source in sources]
    if options.capped:
        scene = replace(scene, leaves=[replace(leaves, capped=True) for leaves in scene.leaves])

    def work(progress):
        return bake(
            volumes,
            scene,
            isovalues=options.isovalues,
            resolution=options.resolution,
            samples=options.samples,
            photons=options.photons,
            caustic_photons=options.caustic_photons,
            estimator=options.estimator,
            seed=options.seed,
            threads=options.threads,
            both_sides=options.both_sides,
            surroundings=options.surroundings,
            progress=progress,
        )

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
        **baked.statistics,
    }
    lo, hi = baked.isovalues
    return result, [
        f"{options.out}: isovalues {lo:g}..{hi:g} in {baked.scene.name}, "
        f"{result['texels']} texels, {result['seconds']:.1f} s, "
        f"{result['rays_per_second'] / 1e6:.2f} million rays/s, "
        f"{result['peak_memory_bytes'] / 2**20:.0f} MiB",
        *_leaf_map(baked),
        *(f"skipped: {name} ({reason})" for name, reason in result["skipped_passes"]),
    ]


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
    surface = baked.surface(options.isovalue, options.volume, options.back)
    write_ply(options.out, surface, baked.scene.exposure)
    result = {
        "out": options.out,
        "isovalue": options.isovalue,
        "volume": options.volume,
        "vertices": len(surface.vertices),
        "triangles": len(surface.triangles),
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
        )

    result = run_with_progress(work, "compare")
    isovalue = _isovalue(baked, options)
    exposed = result["exposed"]
    return result, [
        f"isovalue {isovalue}, all points: {_errors(result)}",
        *([f"isovalue {isovalue}, seen from outside: {_errors(exposed)}"] if exposed else []),
        f"bake {result['bake_seconds']:.1f} s, reference {result['reference_seconds']:.1f} s at "
        f"{result['points']} points with {result['spp']} paths each",
    ]


def _isovalue(baked, options):
    """The leaf coordinate asked for, and with several volumes what it shows of the one."""
    if len(baked.volumes) == 1:
        return f"{options.isovalue:g}"
    own = baked.isovalue_of(options.volume, options.isovalue)
    return f"{options.isovalue:g} ({own:g} of {baked.scene.leaves[options.volume].name})"


def _errors(result):
    if result["points"] == 0:
        return "none"
    relative = result["relative_rms"]
    return (
        f"RMS error {result['rms_percent']:.2f} % "
        f"(of which the reference's noise {result['reference_noise_percent']:.2f} %), "
        + (f"{100 * relative:.2f} % of the mean radiance" if relative is not None else "all dark")
    )


def _open(source, options):
    names = ("dims", "type", "endian", "spacing", "grid", "frame")
    return open_volume(source, **{name: getattr(options, name) for name in names})


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

    layout = _Parser(add_help=False)
    layout.add_argument(
        "--dims",
        type=int,
        nargs="+",
        metavar="N",
        help=".raw: nx ny nz; generated volumes: nodes a side",
    )
    layout.add_argument("--type", choices=TYPES, help=".raw: type of the values")
    layout.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    layout.add_argument(
        "--spacing",
        type=float,
        nargs="+",
        metavar="S",
        help=".raw, TIFF: voxel size, one or X Y Z (1)",
    )
    layout.add_argument(
        "--grid", metavar="NAME", help=".vdb: name of the grid (the first scalar one)"
    )
    layout.add_argument("--frame", type=int, metavar="K", help="4D data: frame to read, from 0")

    seed = _Parser(add_help=False)
    seed.add_argument("--seed", type=int, default=0, metavar="N", help="same seed, same result (0)")
    seed.add_argument("--threads", type=int, default=0, metavar="N", help="threads (0: every core)")

    isovalue = _Parser(add_help=False)
    isovalue.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    isovalue.add_argument(
        "--isovalue",
        type=float,
        required=True,
        metavar="C",
        help="in data units; of several volumes 0..1, from the lowest to the highest of each",
    )
    isovalue.add_argument(
        "--volume", type=int, default=0, metavar="K", help="which of several volumes, from 0 (0)"
    )
    isovalue.add_argument("--back", action="store_true", help="the inner side")

    volume = f"a file, a folder of TIFF slices, or {', '.join(GENERATED)}"
    info = commands.add_parser("info", parents=[layout], help="what a volume holds")
    info.add_argument("volume", metavar="VOLUME", help=volume)
    info.set_defaults(command=_info)

    baking = commands.add_parser(
        "bake", parents=[layout, seed], help="light every isosurface of one or more volumes"
    )
    baking.add_argument(
        "volumes", metavar="VOLUME", nargs="*", help=volume + " (the scene file's own)"
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
        help="window to bake (from the data); of several volumes within 0..1",
    )
    baking.add_argument(
        "--resolution", type=int, metavar="N", help="texels on the longest axis (one a voxel)"
    )
    baking.add_argument("--samples", type=int, default=32, metavar="N", help="rays a texel (32)")
    baking.add_argument(
        "--photons", type=int, default=2_000_000, metavar="N", help="photons (2000000)"
    )
    baking.add_argument(
        "--caustic-photons",
        type=int,
        metavar="N",
        help="photons by way of mirrors and glass (as many as photons)",
    )
    baking.add_argument(
        "--both-sides", action="store_true", help="light the inner side of isosurfaces, too"
    )
    baking.add_argument(
        "--surroundings", action="store_true", help="keep the light on the surroundings, too"
    )
    baking.add_argument(
        "--capped", action="store_true", help="close isosurfaces at the border of the volume"
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
