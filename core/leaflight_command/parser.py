# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line.

Imports nothing of the package, which takes longer to load than all else that help needs.
"""

import argparse

from .numbers import integer, number

# What the package knows by these names.
ENDIANS = ("little", "big")
ESTIMATORS = ("gather", "volumetric", "path", "thesis")
GENERATED = (
    "bump_box",
    "nucleons:0",
    "nucleons:1",
    "lapr:0",
    "lapr:1",
    "neuron",
    "hydrogen",
)
REFERENCES = ("path", "cycles")
TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


class UsageError(Exception):
    """Of options that cannot be parsed: one sentence."""


class Parser(argparse.ArgumentParser):
    """Raises UsageError where argparse would print its usage and exit."""

    def __init__(self, **options):
        # Abbreviations would change meaning whenever an option is added.
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        raise UsageError(f"{message}; see '{self.prog} --help'.")


class _Version(argparse.Action):
    """Prints the version of the package that is installed."""

    def __call__(self, parser, *_):
        from leaflight import __version__

        print(f"leaflight {__version__}")
        parser.exit()


def make_parser():
    """The parser of the whole command line; the name of the command is the option `command`."""
    parser = Parser(
        prog="leaflight", description="Global illumination for every isosurface of a volume."
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, help="show the version of Leaflight and exit"
    )
    subparsers = parser.add_subparsers(
        title="commands", required=True, dest="command", metavar="COMMAND"
    )
    layout, threads, scene, leaf = _layout(), _threads(), _scene(), _leaf()
    volume = f"a file, a folder of TIFF or DICOM slices, or {', '.join(GENERATED)}"

    info = subparsers.add_parser("info", parents=[layout], help="what a volume holds")
    info.add_argument("volume", metavar="VOLUME", help=volume)

    lit = _lit(volume)
    bake = subparsers.add_parser(
        "bake", parents=[layout, lit, scene, threads], help="light every isosurface of volumes"
    )
    target = bake.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", metavar="X.vdb", help="file to write")
    target.add_argument(
        "--resume",
        metavar="X.vdb",
        help="go on with the bake to this file that was interrupted, from X.vdb.checkpoint",
    )
    target.add_argument(
        "--estimate",
        action="store_true",
        help="tell the seconds and the memory that it would take, and write nothing",
    )
    bake.add_argument(
        "--error",
        type=number,
        metavar="PCT",
        help="go on until the error is this, in percent as compare tells it (1.5)",
    )
    bake.add_argument(
        "--time", type=number, metavar="S", help="or until so many seconds are over (no limit)"
    )
    bake.add_argument(
        "--continue",
        dest="kept",
        metavar="KEPT.vdb",
        help="go on with a bake that was stopped or shall err less, in place of a VOLUME",
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
        type=integer,
        metavar="N",
        help="photons by way of mirrors and glass (as many as photons)",
    )
    research.add_argument(
        "--soft-spacing",
        type=integer,
        metavar="N",
        help="texels between the points that soft light is gathered at (1)",
    )
    research.add_argument(
        "--refine",
        type=integer,
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

    still = subparsers.add_parser("still", help="a picture of a lit isosurface, without Blender")
    still.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    still.add_argument(
        "--isovalue",
        type=float,
        metavar="C",
        help="in data units; of several volumes 0..1, from the lowest to the highest of each (one)",
    )
    still.add_argument(
        "--out",
        required=True,
        metavar="X.png",
        help="file to write: .png, exposed and transparent where nothing is, or .exr, radiance",
    )
    where = still.add_mutually_exclusive_group()
    where.add_argument(
        "--view",
        type=float,
        nargs=2,
        metavar=("AROUND", "UP"),
        help="degrees around the volumes, 0 from the front, -y, and above the horizon (0 20)",
    )
    where.add_argument("--camera", metavar="FILE", help="JSON: position, target, up, angle")
    still.add_argument(
        "--zoom", type=float, metavar="Z", help="how much larger than whole they are seen (1)"
    )
    still.add_argument(
        "--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="pixels"
    )
    still.add_argument(
        "--samples", type=int, default=2, metavar="N", help="rays along a pixel's side (2)"
    )
    still.add_argument("--no-walls", action="store_true", help="leave the lit surroundings out")
    still.add_argument(
        "--local",
        action="store_true",
        help="the lamps upon the surface alone, without shadows, to compare with",
    )

    export = subparsers.add_parser(
        "export",
        parents=[threads],
        help="a bake as a web page, or for ParaView, amira, glTF, USD or PLY",
    )
    export.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    export.add_argument(
        "--out",
        required=True,
        metavar="X.EXT",
        help="file to write: .html shows all isosurfaces in a browser, .vti and .am hold all, .vtp "
        "and .ply one, .glb, .usda, .usdc and .usd one or a sequence",
    )
    export.add_argument(
        "--isovalue",
        type=number,
        nargs="+",
        metavar="C",
        help="in data units; of several volumes 0..1, from the lowest to the highest of each (one)",
    )
    _side(export)
    export.add_argument(
        "--settle", action="store_true", help="trace the light at the mesh's vertices: sharper"
    )
    export.add_argument(
        "--coarser",
        type=int,
        default=0,
        metavar="N",
        help=".html: halve voxels and texels N times along each axis, 1 to 3 (0)",
    )
    export.add_argument(
        "--embed",
        action="store_true",
        help=".html: a folder for an iframe on a web server in place of one file",
    )

    photons = subparsers.add_parser(
        "photons", parents=[layout, lit, scene], help="photons on isosurfaces as points"
    )
    photons.add_argument("--out", required=True, metavar="POINTS.ply", help="file to write")
    photons.add_argument(
        "--photons", type=integer, default=100_000, metavar="N", help="that lights send (100000)"
    )
    photons.add_argument("--seed", type=integer, default=0, metavar="N", help="as of a bake (0)")

    compare = subparsers.add_parser(
        "compare", parents=[leaf, threads], help="the error of a bake against path tracing"
    )
    compare.add_argument(
        "--settle", action="store_true", help="of the surface that surface --settle writes"
    )
    compare.add_argument("--points", type=integer, default=3000, metavar="N", help="points (3000)")
    compare.add_argument(
        "--spp", type=integer, default=1024, metavar="N", help="paths a point (1024)"
    )
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
    flatland.add_argument("--dims", type=integer, metavar="N", help="bump_box: nodes a side (200)")
    flatland.add_argument(
        "--out", required=True, metavar="X.exr", help="texture to write, and a picture X.png"
    )
    flatland.add_argument(
        "--isolines", type=number, nargs="+", metavar="C", help="isolines of the picture (one)"
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
        choices=("bake", "scale", "rays", "scrub"),
        help="bake: against Cycles to the same error; scale: by size and threads; rays: against "
        "Embree; scrub: isovalues against VTK, and in Blender",
    )
    bench.add_argument("--quick", action="store_true", help="tiny, to see that it works")
    bench.add_argument(
        "--data", metavar="DIR", help="folder of real volumes, which are left out without it"
    )
    bench.add_argument("--only", metavar="TEXT", help="bakes with this in their name")
    bench.add_argument("--out", metavar="FILE.md", help="document to write the tables into")

    for command in subparsers.choices.values():
        command.add_argument(
            "--json", action="store_true", help="print one JSON object as the last line"
        )
    return parser


def _layout():
    """How the values of a volume lie in its file."""
    parser = Parser(add_help=False)
    parser.add_argument(
        "--dims",
        type=integer,
        nargs="+",
        metavar="N",
        help=".raw: nx ny nz; generated volumes: nodes a side; points: nodes of the longest side",
    )
    parser.add_argument("--type", choices=TYPES, help=".raw: type of the values")
    parser.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    parser.add_argument(
        "--spacing",
        type=number,
        nargs="+",
        metavar="S",
        help=".raw, TIFF, HDF5, NumPy: voxel size, one or X Y Z (1)",
    )
    parser.add_argument(
        "--grid", metavar="NAME", help=".vdb: name of the grid (the first scalar one)"
    )
    parser.add_argument("--frame", type=integer, metavar="K", help="4D data: frame to read, from 0")
    parser.add_argument(
        "--channel", type=integer, metavar="K", help="several values a voxel: which to read, from 0"
    )
    parser.add_argument(
        "--level", type=integer, metavar="K", help="OME-Zarr: resolution, 0 the finest"
    )
    parser.add_argument(
        "--dataset", metavar="NAME", help="several volumes in one file or folder: which to read"
    )
    parser.add_argument(
        "--downsample",
        type=integer,
        choices=(1, 2, 4, 8),
        metavar="N",
        help="keep the mean of N voxels along each axis: 2, 4 or 8 (1)",
    )
    return parser


def _threads():
    parser = Parser(add_help=False)
    parser.add_argument(
        "--seed", type=integer, default=0, metavar="N", help="same seed, same result (0)"
    )
    parser.add_argument(
        "--threads", type=integer, default=0, metavar="N", help="threads (0: every core)"
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
        type=number,
        nargs=2,
        metavar=("LO", "HI"),
        help="window to bake (from the data); of several volumes within 0..1",
    )
    return parser


def _resolution(parser):
    parser.add_argument(
        "--resolution", type=integer, metavar="N", help="texels on the longest axis (one a voxel)"
    )


def _work(parser):
    """How much is done, where the amount is fixed."""
    parser.add_argument("--samples", type=integer, metavar="N", help="rays a texel (32)")
    parser.add_argument("--photons", type=integer, metavar="N", help="photons (2000000)")
    parser.add_argument("--estimator", choices=ESTIMATORS, help="(gather)")


def _thesis(parser):
    """The thesis's own ways."""
    thesis = parser.add_argument_group("of --estimator thesis")
    thesis.add_argument("--k", type=integer, metavar="N", help="photons of an estimate (200)")
    thesis.add_argument(
        "--photon-radius",
        type=number,
        metavar="R",
        help="how far an estimate reaches, in longest sides of the volume (without limit)",
    )
    thesis.add_argument(
        "--g", type=number, metavar="G", help="weight of isovalues against distances (10)"
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
        "--count", type=integer, metavar="N", help="how many, of --samples rays each"
    )
    scattered.add_argument(
        "--isovalue-count", type=integer, metavar="N", help="level_set: isovalues (9)"
    )
    scattered.add_argument("--filter", metavar="NAME", help="shepard (default), tent, box")
    scattered.add_argument(
        "--filter-radius", type=integer, metavar="D", help="texels that a sample reaches (3)"
    )


def _leaf():
    """One isosurface of a bake."""
    parser = Parser(add_help=False)
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    parser.add_argument(
        "--isovalue",
        type=number,
        required=True,
        metavar="C",
        help="in data units; of several volumes 0..1, from the lowest to the highest of each",
    )
    _side(parser)
    return parser


def _side(parser):
    """Which of the isosurfaces of that isovalue, and seen from where."""
    parser.add_argument(
        "--volume",
        type=integer,
        default=0,
        metavar="K",
        help="which of several volumes, from 0 (0)",
    )
    parser.add_argument("--back", action="store_true", help="the inner side")
