# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line."""

import argparse

from .._core import LeaflightError
from ..io.readers.raw import ENDIANS, TYPES
from ..io.sources import GENERATED
from ..measure.compare import REFERENCES
from ..version import __version__

ESTIMATORS = ("gather", "volumetric", "path", "thesis")


class Parser(argparse.ArgumentParser):
    """Raises LeaflightError where argparse would print its usage and exit."""

    def __init__(self, **options):
        # Abbreviations would change meaning whenever an option is added.
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        raise LeaflightError(f"{message}; see '{self.prog} --help'.")


def make_parser(commands):
    """The parser of the whole command line; commands: the function of each command by name."""
    parser = Parser(
        prog="leaflight", description="Global illumination for every isosurface of a volume."
    )
    parser.add_argument("--version", action="version", version=f"leaflight {__version__}")
    subparsers = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    layout, threads, scene, leaf = _layout(), _threads(), _scene(), _leaf()
    volume = f"a file, a folder of TIFF slices, or {', '.join(GENERATED)}"

    info = subparsers.add_parser("info", parents=[layout], help="what a volume holds")
    info.add_argument("volume", metavar="VOLUME", help=volume)

    lit = _lit(volume)
    bake = subparsers.add_parser(
        "bake", parents=[layout, lit, scene, threads], help="light every isosurface of volumes"
    )
    target = bake.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", metavar="X.vdb", help="file to write")
    target.add_argument(
        "--estimate",
        action="store_true",
        help="tell the seconds and the memory that it would take, and write nothing",
    )
    bake.add_argument(
        "--error",
        type=float,
        metavar="PCT",
        help="go on until the error is this, in percent as compare tells it (1.5)",
    )
    bake.add_argument(
        "--time", type=float, metavar="S", help="or until so many seconds are over (no limit)"
    )
    for option, text in (
        ("--both-sides", "light the inner side of isosurfaces, too"),
        ("--surroundings", "keep the light on the surroundings, too"),
    ):
        bake.add_argument(option, action="store_true", help=text)
    _resolution(bake)
    research = bake.add_argument_group(
        "settings of research: a fixed amount of work in place of --error and --time"
    )
    _work(research)
    research.add_argument(
        "--caustic-photons",
        type=int,
        metavar="N",
        help="photons by way of mirrors and glass (as many as photons)",
    )
    research.add_argument(
        "--soft-spacing",
        type=int,
        metavar="N",
        help="texels between the points that soft light is gathered at (1)",
    )
    research.add_argument(
        "--refine",
        type=int,
        metavar="N",
        help="how many times to halve texels where light varies most; once doubles the time (0)",
    )
    _thesis(bake)

    surface = subparsers.add_parser(
        "surface", parents=[leaf, threads], help="one lit isosurface as a mesh"
    )
    surface.add_argument("--out", required=True, metavar="MESH.ply", help="file to write")
    surface.add_argument(
        "--settle", action="store_true", help="trace the light at the mesh's vertices: sharper"
    )

    photons = subparsers.add_parser(
        "photons", parents=[layout, lit, scene], help="photons on isosurfaces as points"
    )
    photons.add_argument("--out", required=True, metavar="POINTS.ply", help="file to write")
    photons.add_argument(
        "--photons", type=int, default=100_000, metavar="N", help="that lights send (100000)"
    )
    photons.add_argument("--seed", type=int, default=0, metavar="N", help="as of a bake (0)")

    compare = subparsers.add_parser(
        "compare", parents=[leaf, threads], help="the error of a bake against path tracing"
    )
    compare.add_argument(
        "--settle", action="store_true", help="of the surface that surface --settle writes"
    )
    compare.add_argument("--points", type=int, default=3000, metavar="N", help="points (3000)")
    compare.add_argument("--spp", type=int, default=1024, metavar="N", help="paths a point (1024)")
    compare.add_argument(
        "--reference",
        choices=REFERENCES,
        default=REFERENCES[0],
        help="path: the core's own path tracer; cycles: Blender's (path)",
    )
    compare.add_argument(
        "--mesh",
        metavar="NAME",
        help="compare on this mesh of the surroundings; --back: seen against its normals",
    )

    flatland = subparsers.add_parser(
        "flatland", parents=[scene, threads], help="light every isoline of an image in the plane"
    )
    flatland.add_argument("image", metavar="IMAGE", help="PNG, JPEG, TIFF or EXR, or bump_box")
    flatland.add_argument("--dims", type=int, metavar="N", help="bump_box: nodes a side (200)")
    flatland.add_argument(
        "--out", required=True, metavar="X.exr", help="texture to write, and a picture X.png"
    )
    flatland.add_argument(
        "--isolines", type=float, nargs="+", metavar="C", help="isolines of the picture (one)"
    )
    flatland.add_argument(
        "--uncorrected",
        action="store_true",
        help="leave the picture at the plane's brightness, pi/2 of that in space",
    )

    _resolution(flatland)
    _work(flatland)
    _thesis(flatland)

    report = subparsers.add_parser(
        "report", parents=[threads], help="measure errors and seconds, and write a report of them"
    )
    alone = report.add_mutually_exclusive_group()
    alone.add_argument(
        "--tables", action="store_true", help="Tables 3.1 and 4.2 and Fig. 4.9 of the thesis alone"
    )
    alone.add_argument("--cycles", action="store_true", help="bakes against Cycles alone")
    report.add_argument(
        "--quick", action="store_true", help="less of everything: ten minutes, not hours"
    )
    report.add_argument(
        "--out", default="report", metavar="DIR", help="folder to write into (report)"
    )
    report.add_argument(
        "--data", metavar="DIR", help="folder of real data sets, which are left out without it"
    )

    bench = subparsers.add_parser(
        "bench", parents=[threads], help="measure how fast bakes are, with Cycles beside them"
    )
    bench.add_argument(
        "what",
        choices=("bake", "scale"),
        help="bake: against Cycles to the same error; scale: by size and threads",
    )
    bench.add_argument("--quick", action="store_true", help="tiny, to see that it works")
    bench.add_argument(
        "--data", metavar="DIR", help="folder of real volumes, which are left out without it"
    )
    bench.add_argument("--only", metavar="TEXT", help="bakes with this in their name")
    bench.add_argument("--out", metavar="FILE.md", help="document to write the tables into")

    for name, command in subparsers.choices.items():
        command.set_defaults(command=commands[name])
        command.add_argument(
            "--json", action="store_true", help="print one JSON object as the last line"
        )
    return parser


def _layout():
    """How the values of a volume lie in its file."""
    parser = Parser(add_help=False)
    parser.add_argument(
        "--dims",
        type=int,
        nargs="+",
        metavar="N",
        help=".raw: nx ny nz; generated volumes: nodes a side",
    )
    parser.add_argument("--type", choices=TYPES, help=".raw: type of the values")
    parser.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    parser.add_argument(
        "--spacing",
        type=float,
        nargs="+",
        metavar="S",
        help=".raw, TIFF: voxel size, one or X Y Z (1)",
    )
    parser.add_argument(
        "--grid", metavar="NAME", help=".vdb: name of the grid (the first scalar one)"
    )
    parser.add_argument("--frame", type=int, metavar="K", help="4D data: frame to read, from 0")
    return parser


def _threads():
    parser = Parser(add_help=False)
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="same seed, same result (0)"
    )
    parser.add_argument(
        "--threads", type=int, default=0, metavar="N", help="threads (0: every core)"
    )
    return parser


def _lit(volume):
    """Volumes in space that are to be lit."""
    parser = Parser(add_help=False)
    parser.add_argument(
        "volumes", metavar="VOLUME", nargs="*", help=volume + " (those of the scene file)"
    )
    parser.add_argument(
        "--capped", action="store_true", help="close isosurfaces at the border of the volume"
    )
    return parser


def _scene():
    """In which light, and within which isovalues."""
    parser = Parser(add_help=False)
    parser.add_argument("--scene", metavar="FILE", help="scene file (a box around the data)")
    parser.add_argument(
        "--isovalues",
        type=float,
        nargs=2,
        metavar=("LO", "HI"),
        help="window to bake (from the data); of several volumes within 0..1",
    )
    return parser


def _resolution(parser):
    parser.add_argument(
        "--resolution", type=int, metavar="N", help="texels on the longest axis (one a voxel)"
    )


def _work(parser):
    """How much is done, where the amount is fixed."""
    parser.add_argument("--samples", type=int, metavar="N", help="rays a texel (32)")
    parser.add_argument("--photons", type=int, metavar="N", help="photons (2000000)")
    parser.add_argument("--estimator", choices=ESTIMATORS, help="(gather)")


def _thesis(parser):
    """The thesis's own ways."""
    thesis = parser.add_argument_group("of --estimator thesis")
    thesis.add_argument("--k", type=int, metavar="N", help="photons of an estimate (200)")
    thesis.add_argument(
        "--photon-radius",
        type=float,
        metavar="R",
        help="how far an estimate reaches, in longest sides of the volume (without limit)",
    )
    thesis.add_argument(
        "--g", type=float, metavar="G", help="weight of isovalues against distances (10)"
    )
    thesis.add_argument(
        "--region", metavar="NAME", help="sphere, clipped_sphere (default), box, cylinder, graph"
    )

    scattered = parser.add_argument_group("samples strewn over the domain, not in each texel")
    scattered.add_argument(
        "--strategy",
        metavar="NAME",
        help="uniform, stratified, importance, level_set, letters, slabs, regular",
    )
    scattered.add_argument(
        "--count", type=int, metavar="N", help="how many, of --samples rays each"
    )
    scattered.add_argument(
        "--isovalue-count", type=int, metavar="N", help="level_set: isovalues (9)"
    )
    scattered.add_argument("--filter", metavar="NAME", help="shepard (default), tent, box")
    scattered.add_argument(
        "--filter-radius", type=int, metavar="D", help="texels that a sample reaches (3)"
    )


def _leaf():
    """One isosurface of a bake."""
    parser = Parser(add_help=False)
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    parser.add_argument(
        "--isovalue",
        type=float,
        required=True,
        metavar="C",
        help="in data units; of several volumes 0..1, from the lowest to the highest of each",
    )
    parser.add_argument(
        "--volume", type=int, default=0, metavar="K", help="which of several volumes, from 0 (0)"
    )
    parser.add_argument("--back", action="store_true", help="the inner side")
    return parser
