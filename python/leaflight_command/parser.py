# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line.

Imports nothing of the package, which takes longer to load than all else that help needs.
"""

import argparse

from .numbers import integer, number
from .shared_options import (
    MACHINES,
    Parser,
    layout_options,
    isosurface_options,
    limit_options,
    lit_options,
    memory_options,
    resolution_options,
    scene_options,
    side_options,
    threads_options,
    workers_options,
)

# What the package knows by these names.
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
    layout, threads = layout_options(), threads_options()
    scene, isosurface = scene_options(), isosurface_options()
    volume = "a file, a folder of slices, or a generated volume"

    info = subparsers.add_parser("info", parents=[layout], help="what a volume holds")
    info.add_argument(
        "volume",
        metavar="VOLUME",
        help=f"a file, a folder of TIFF or DICOM slices, or {', '.join(GENERATED)}",
    )

    lit = lit_options(volume)
    bake = subparsers.add_parser(
        "bake",
        parents=[lit, scene, threads, layout],
        usage="leaflight bake VOLUME ... --out X.vdb [OPTION ...]",
        help="light every isosurface of volumes",
    )
    target = bake.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", metavar="X.vdb", help="file to write")
    target.add_argument(
        "--resume",
        metavar="X.vdb",
        help="go on with the interrupted bake to this file",
    )
    target.add_argument(
        "--estimate",
        action="store_true",
        help="print the seconds and the memory that it would take",
    )
    limit_options(bake)
    bake.add_argument(
        "--continue",
        dest="previous",
        metavar="KEPT.vdb",
        help="go on with a finished bake, in place of a VOLUME",
    )
    for option, text in (
        ("--both-sides", "light the back of isosurfaces, too"),
        ("--walls", "keep the light on the walls, too"),
        ("--verbose", "print the passes that were left out, and why"),
    ):
        bake.add_argument(option, action="store_true", help=text)
    resolution_options(bake)
    machines = bake.group(MACHINES)
    memory_options(machines)
    workers_options(machines, "sweep light in so many processes here, by Dask; the same bake")
    batch = subparsers.add_parser("batch", help="many bakes, resumed where they stopped")
    batch.add_argument(
        "list", metavar="LIST.txt", help="a file with the arguments of one bake on each line"
    )
    render = subparsers.add_parser(
        "render", help="the frames of a .blend by workers, resumed where they stopped"
    )
    render.add_argument("blend", metavar="X.blend", help="what moves is keyframed in it")
    render.add_argument(
        "--out", required=True, metavar="OUT", help="a folder for the frames (.png), or an .mp4"
    )
    render.add_argument(
        "--frames",
        type=integer,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help="(those of the .blend)",
    )
    render.add_argument(
        "--blender", default="blender", metavar="PROGRAM", help="Blender's program (blender)"
    )
    for one in (batch, render):
        workers_options(one, "so many at a time on this machine (1)")

    surface = subparsers.add_parser(
        "surface", parents=[isosurface], help="one lit isosurface as a mesh"
    )
    surface.add_argument("--out", required=True, metavar="MESH.ply", help="file to write")

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
        help="degrees around the volumes, 0 from -y, and above the horizon (a patient's front, or "
        "the largest silhouette, from slightly above)",
    )
    where.add_argument("--camera", metavar="FILE", help="JSON: position, target, up, angle")
    still.add_argument(
        "--zoom", type=float, metavar="Z", help="how much larger than framed the isosurface is (1)"
    )
    still.add_argument(
        "--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="pixels"
    )
    still.add_argument(
        "--samples", type=int, default=2, metavar="N", help="rays along a pixel's side (2)"
    )
    still.add_argument("--no-walls", action="store_true", help="leave the walls out")
    still.add_argument(
        "--local",
        action="store_true",
        help="the lamps upon the surface alone, without shadows, to compare with",
    )

    export = subparsers.add_parser(
        "export",
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
    side_options(export)
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
        "compare", parents=[isosurface, threads], help="the error of a bake against path tracing"
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
        help="compare on this mesh of the walls; --back: seen against its normals",
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
    limit_options(flatland)
    resolution_options(flatland)

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
        command.offer_all()
    return parser
