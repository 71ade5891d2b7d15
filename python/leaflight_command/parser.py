# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line.

It does not import the package, because loading that would take most of the time of --help.
"""

import argparse

from .numbers import integer, number
from .shared_options import (
    MACHINES,
    Parser,
    color_options,
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

# Names in the package.
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
_VOLUME = "a file, a folder of slices, or a generated volume"


class _Version(argparse.Action):
    """Prints the version of the installed package."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from leaflight import __version__

        print(f"leaflight {__version__}")
        parser.exit()


def make_parser() -> Parser:
    """Returns the parser of the whole command line. Its option `command` names the command."""
    parser = Parser(
        prog="leaflight", description="Global illumination for every isosurface of a volume."
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    subparsers = parser.add_subparsers(
        title="commands", required=True, dest="command", metavar="COMMAND"
    )
    for add in _COMMANDS:
        add(subparsers)
    for command in subparsers.choices.values():
        command.finish()
    return parser


def _add_info(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "info", parents=[layout_options()], help="show the contents of a volume"
    )
    parser.add_argument(
        "volume",
        metavar="VOLUME",
        help=f"a file, a folder of TIFF or DICOM slices, or {', '.join(GENERATED)}",
    )


def _add_bake(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "bake",
        parents=[
            lit_options(_VOLUME),
            scene_options(),
            threads_options(),
            layout_options(),
            color_options(),
        ],
        usage="leaflight bake VOLUME ... --out X.vdb [OPTION ...]",
        help="light every isosurface of volumes",
    )
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("--out", metavar="X.vdb", help="file to write")
    target.add_argument(
        "--resume",
        metavar="X.vdb",
        help="resume the interrupted bake to this file",
    )
    target.add_argument(
        "--estimate",
        action="store_true",
        help="print the expected time and memory instead of baking",
    )
    limit_options(parser)
    parser.add_argument(
        "--continue",
        dest="previous",
        metavar="BAKE.vdb",
        help="continue a finished bake, instead of a VOLUME",
    )
    # The default is true if the back is visible.
    parser.add_argument(
        "--both-sides",
        action="store_true",
        default=None,
        help="light the backs, too (off: --no-both-sides)",
    )
    parser.add_argument(
        "--no-both-sides", dest="both_sides", action="store_false", help=argparse.SUPPRESS
    )
    for option, text in (
        ("--walls", "bake the light of the walls, too"),
        ("--verbose", "print the passes that were skipped, and why"),
    ):
        parser.add_argument(option, action="store_true", help=text)
    resolution_options(parser)
    machines = parser.group(MACHINES)
    memory_options(machines)
    workers_options(machines, "number of processes on this machine (Dask); the result is the same")


def _add_batch_and_render(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    batch = subparsers.add_parser(
        "batch", help="run many bakes; resumes them after an interruption"
    )
    batch.add_argument(
        "list", metavar="LIST.txt", help="file with the arguments of one bake per line"
    )
    render = subparsers.add_parser(
        "render",
        help="render the frames of a .blend by workers; resumes them after an interruption",
    )
    render.add_argument("blend", metavar="X.blend", help="file with keyframes")
    render.add_argument(
        "--out", required=True, metavar="OUT", help="folder for the frames (.png), or an .mp4"
    )
    render.add_argument(
        "--frames",
        type=integer,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help="(those of the .blend)",
    )
    render.add_argument(
        "--blender", default="blender", metavar="PROGRAM", help="path of Blender (blender)"
    )
    for one in (batch, render):
        workers_options(one, "number of Blenders on this machine (1)")


def _add_surface(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "surface", parents=[isosurface_options()], help="write one lit isosurface as a mesh"
    )
    parser.add_argument("--out", required=True, metavar="MESH.ply", help="file to write")


def _add_still(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "still", help="render a picture of a lit isosurface, without Blender"
    )
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    parser.add_argument(
        "--isovalue",
        type=float,
        metavar="C",
        help="isovalue in data units; 0..1 of the range for several volumes (chosen)",
    )
    parser.add_argument(
        "--out",
        required=True,
        metavar="X.png",
        help="file to write: .png (exposed, transparent background) or .exr (radiance)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--view",
        type=float,
        nargs=2,
        metavar=("AROUND", "UP"),
        help=(
            "azimuth from -y and elevation in degrees (a patient's front, or the largest "
            "silhouette from slightly above)"
        ),
    )
    where.add_argument(
        "--camera", metavar="FILE", help="JSON file with position, target, up and angle"
    )
    parser.add_argument(
        "--zoom",
        type=float,
        metavar="Z",
        help="factor on the size of the isosurface in the picture (1)",
    )
    parser.add_argument(
        "--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="pixels"
    )
    parser.add_argument(
        "--samples", type=int, default=2, metavar="N", help="rays per side of a pixel (2)"
    )
    parser.add_argument("--no-walls", action="store_true", help="leave the walls out")
    parser.add_argument(
        "--color-bar", action="store_true", help=".png: draw the color bar of --color-by"
    )
    parser.add_argument(
        "--local",
        action="store_true",
        help="shade by lamps without shadows or indirect light, for comparison",
    )


def _add_export(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "export",
        help="write a bake as a web page, or for ParaView, amira, glTF, USD or PLY",
    )
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    parser.add_argument(
        "--out",
        required=True,
        metavar="X.EXT",
        help=(
            "file to write; all isosurfaces: .html (browser), .vti, .am; one: .vtp, .ply; one or "
            "a sequence: .glb, .usda, .usdc, .usd"
        ),
    )
    parser.add_argument(
        "--isovalue",
        type=number,
        nargs="+",
        metavar="C",
        help="isovalue in data units; 0..1 of the range for several volumes (chosen)",
    )
    side_options(parser)
    parser.add_argument(
        "--coarser",
        type=int,
        default=0,
        metavar="N",
        help=".html: halve voxels and texels N times along each axis, 1 to 3 (0)",
    )
    parser.add_argument(
        "--embed",
        action="store_true",
        help=".html: write a folder for an iframe on a web server",
    )


def _add_photons(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "photons",
        parents=[layout_options(), color_options(), lit_options(_VOLUME), scene_options()],
        help="write photons on isosurfaces as points",
    )
    parser.add_argument("--out", required=True, metavar="POINTS.ply", help="file to write")
    parser.add_argument(
        "--photons",
        type=integer,
        default=100_000,
        metavar="N",
        help="number of emitted photons (100000)",
    )
    parser.add_argument("--seed", type=integer, default=0, metavar="N", help="random seed (0)")


def _add_compare(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "compare",
        parents=[isosurface_options(), threads_options()],
        help="measure the error of a bake by path tracing",
    )
    parser.add_argument("--points", type=integer, default=3000, metavar="N", help="points (3000)")
    parser.add_argument(
        "--spp", type=integer, default=1024, metavar="N", help="paths per point (1024)"
    )
    parser.add_argument(
        "--reference",
        choices=REFERENCES,
        default=REFERENCES[0],
        help="path: Leaflight's path tracer; cycles: Blender's Cycles (path)",
    )
    parser.add_argument(
        "--mesh",
        metavar="NAME",
        help="compare this mesh of the walls; --back is the side against its normals",
    )


def _add_flatland(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "flatland",
        parents=[scene_options(), threads_options()],
        help="light every isoline of an image within the plane",
    )
    parser.add_argument("image", metavar="IMAGE", help="PNG, JPEG, TIFF or EXR, or bump_box")
    parser.add_argument("--dims", type=integer, metavar="N", help="bump_box: nodes per side (200)")
    parser.add_argument(
        "--out",
        required=True,
        metavar="X.exr",
        help="texture to write; also writes a picture X.png",
    )
    parser.add_argument(
        "--isolines", type=number, nargs="+", metavar="C", help="isolines of the picture (chosen)"
    )
    limit_options(parser)
    resolution_options(parser)


_COMMANDS = (
    _add_info,
    _add_bake,
    _add_batch_and_render,
    _add_surface,
    _add_still,
    _add_export,
    _add_photons,
    _add_compare,
    _add_flatland,
)
