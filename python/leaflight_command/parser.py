# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line.

It does not import the package, because loading that would take most of the time of --help.
"""

import argparse

from .numbers import number
from .shared_options import (
    MACHINES,
    Parser,
    bake_options,
    color_options,
    isosurface_options,
    isovalue_option,
    layout_options,
    limit_options,
    lit_options,
    resolution_options,
    scene_options,
    seed_option,
    side_options,
    switch,
    threads_options,
    value,
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
    text = f"a file, a folder of TIFF or DICOM slices, or {', '.join(GENERATED)}"
    parser.add_argument("volume", metavar="VOLUME", help=text)


def _add_bake(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    shared = lit_options(_VOLUME), scene_options(), threads_options()
    parser = subparsers.add_parser(
        "bake",
        parents=[*shared, layout_options(), color_options()],
        usage="leaflight bake VOLUME ... --out X.vdb [OPTION ...]",
        help="light every isosurface of volumes",
    )
    target = parser.add_mutually_exclusive_group(required=True)
    value(target, "--out", "X.vdb", "file to write")
    value(target, "--resume", "X.vdb", "resume the interrupted bake to this file")
    switch(target, "--estimate", "print the expected time and memory instead of baking")
    limit_options(parser)
    text = "continue a finished bake, instead of a VOLUME"
    value(parser, "--continue", "BAKE.vdb", text, dest="previous")
    # The default is true if the back is visible.
    switch(parser, "--both-sides", "light the backs, too (off: --no-both-sides)", default=None)
    parser.add_argument(
        "--no-both-sides", dest="both_sides", action="store_false", help=argparse.SUPPRESS
    )
    switch(parser, "--walls", "bake the light of the walls, too")
    switch(parser, "--verbose", "print the passes that were skipped, and why")
    resolution_options(parser)
    machines = parser.group(MACHINES)
    text = "memory limit, such as 4GiB; larger volumes are stored in a file beside the output, "
    value(machines, "--memory", "SIZE", text + "and texels become coarser to fit")
    workers_options(machines, "number of processes on this machine (Dask); the result is the same")


def _add_batch_and_render(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    batch = subparsers.add_parser(
        "batch", help="run many bakes; resumes them after an interruption"
    )
    text = "file with the arguments of one bake per line, or a folder of volumes"
    batch.add_argument("list", metavar="LIST.txt", help=text)
    value(batch, "--out", "FOLDER", "for a folder: the folder of its bakes")
    value(batch, "--each", "ARGUMENTS", "for a folder: arguments of each bake, in quotes")
    value(batch, "--table", "X.csv", "table of the results to write")
    render = subparsers.add_parser(
        "render",
        help="render the frames of a .blend by workers; resumes them after an interruption",
    )
    render.add_argument("blend", metavar="X.blend", help="file with keyframes")
    value(render, "--out", "OUT", "folder for the frames (.png), or an .mp4", required=True)
    value(render, "--frames", "FIRST LAST", "(those of the .blend)")
    value(render, "--blender", "PROGRAM", "path of Blender (blender)", default="blender")
    workers_options(batch, "number of processes on this machine (1)")
    workers_options(render, "number of Blenders on this machine (1)")


def _add_surface(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "surface", parents=[isosurface_options()], help="write one lit isosurface as a mesh"
    )
    value(parser, "--out", "MESH.ply", "file to write", required=True)


def _add_still(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "still",
        parents=[bake_options()],
        help="render a picture of a lit isosurface, without Blender",
    )
    isovalue_option(parser)
    text = "file to write: .png (exposed, transparent background) or .exr (radiance)"
    value(parser, "--out", "X.png", text, required=True)
    where = parser.add_mutually_exclusive_group()
    text = "azimuth from -y and elevation in degrees (a patient's front, or the largest "
    value(where, "--view", "AROUND UP", text + "silhouette from slightly above)")
    value(where, "--camera", "FILE", "JSON file with position, target, up and angle")
    value(parser, "--zoom", "Z", "factor on the size of the isosurface in the picture (1)")
    value(parser, "--size", "W H", "pixels", default=(1280, 720))
    value(parser, "--samples", "N", "rays per side of a pixel (2)", default=2)
    switch(parser, "--no-walls", "leave the walls out")
    switch(parser, "--color-bar", ".png: draw the color bar of --color-by")
    text = "shade by lamps without shadows or indirect light, for comparison"
    switch(parser, "--local", text)


def _add_export(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "export",
        parents=[bake_options()],
        help="write a bake as a web page, or for Blender, ParaView, amira, glTF, USD or PLY",
    )
    text = "file to write; all isosurfaces: .html, .blend, .vti, .am; one: .vtp, .ply; one or "
    value(parser, "--out", "X.EXT", text + "a sequence: .glb, .usda, .usdc, .usd", required=True)
    isovalue_option(parser, "C ...")
    side_options(parser)
    parser.add_argument(
        "--explode",
        type=number,
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="meshes: move the outermost parts apart by this vector, and others in proportion",
    )
    text = ".html: halve voxels and texels N times along each axis, 1 to 3 (0)"
    value(parser, "--coarser", "N", text, default=0)
    switch(parser, "--embed", ".html: write a folder for an iframe on a web server")


def _add_photons(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "photons",
        parents=[layout_options(), color_options(), lit_options(_VOLUME), scene_options()],
        help="write photons on isosurfaces as points",
    )
    value(parser, "--out", "POINTS.ply", "file to write", required=True)
    value(parser, "--photons", "N", "number of emitted photons (100000)", default=100_000)
    seed_option(parser, "random seed (0)")


def _add_compare(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "compare",
        parents=[isosurface_options(), threads_options()],
        help="measure the error of a bake by path tracing",
    )
    value(parser, "--points", "N", "points (3000)", default=3000)
    value(parser, "--spp", "N", "paths per point (1024)", default=1024)
    text = "path: Leaflight's path tracer; cycles: Blender's Cycles (path)"
    parser.add_argument("--reference", choices=REFERENCES, default=REFERENCES[0], help=text)
    text = "compare this mesh of the walls; --back is the side against its normals"
    value(parser, "--mesh", "NAME", text)


def _add_flatland(subparsers: "argparse._SubParsersAction[Parser]") -> None:
    parser = subparsers.add_parser(
        "flatland",
        parents=[scene_options(), threads_options()],
        help="light every isoline of an image within the plane",
    )
    parser.add_argument("image", metavar="IMAGE", help="PNG, JPEG, TIFF or EXR, or bump_box")
    value(parser, "--dims", "N", "bump_box: nodes per side (200)")
    value(parser, "--out", "X.exr", "texture to write; also writes a picture X.png", required=True)
    value(parser, "--isolines", "C ...", "isolines of the picture (chosen)")
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
