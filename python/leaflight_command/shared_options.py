# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands share, and the class of their parsers.

Like parser.py, it does not import the package.
"""

import argparse
from typing import Any, NoReturn

from .numbers import channel, integer, memory, number
from .region_options import add_region_options

# Names of byte orders in the package.
ENDIANS = ("little", "big")
# Titles of groups of options.
MACHINES = "machines"
COLORS = "colors"
TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


class UsageError(Exception):
    """An error in the options of the command line, as one sentence."""


class Parser(argparse.ArgumentParser):
    """A parser that raises UsageError. argparse would print its usage and exit.

    --help omits groups of options with a title; --help-all prints them.
    """

    def __init__(self, **options: Any) -> None:
        # An abbreviation would change its meaning if an option is added.
        super().__init__(allow_abbrev=False, **options)

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see '{self.prog} --help'.")

    def group(self, title: str) -> argparse._ArgumentGroup:
        """Returns the group of options with this title."""
        found = [group for group in self._titled() if group.title == title]
        return found[0] if found else self.add_argument_group(title)

    def finish(self) -> None:
        """Adds --json, and --help-all if there are groups with a title."""
        self.add_argument(
            "--json", action="store_true", help="print one JSON object as the last line"
        )
        titles = [group.title for group in self._titled() if group.title]
        if titles:
            help = f"show this and the options of {', '.join(titles)}"
            self.add_argument("--help-all", action=_HelpAll, nargs=0, help=help)

    def format_help(self) -> str:
        for group in self._titled():
            for action in group._group_actions:
                action.help = argparse.SUPPRESS
        return super().format_help()

    def format_all(self) -> str:
        """Returns the help with all options."""
        return super().format_help()

    def _titled(self) -> list[argparse._ArgumentGroup]:
        # Keep argparse's own groups (positional arguments, options), and commands.
        return [group for group in self._action_groups[2:] if group is not self._subparsers]


class _HelpAll(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        assert isinstance(parser, Parser)
        print(parser.format_all(), end="")
        parser.exit()


def layout_options() -> Parser:
    """Returns the options for the layout of values in a volume's file."""
    options = Parser(add_help=False)
    parser = options.add_argument_group("files")
    parser.add_argument(
        "--dims",
        type=integer,
        nargs="+",
        metavar="N",
        help=".raw: nx ny nz; generated volume: nodes per side; points: nodes of the longest side",
    )
    parser.add_argument(
        "--type", choices=TYPES, help=".raw, or any file with --dims: type of the values"
    )
    parser.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    parser.add_argument(
        "--skip",
        type=integer,
        metavar="N",
        help=".raw: bytes before the values; -1 if the values end the file (0)",
    )
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
        "--channel",
        type=channel,
        metavar="K",
        help="several values per voxel: number of the channel, from 0, or its name",
    )
    parser.add_argument(
        "--level", type=integer, metavar="K", help="OME-Zarr, HDF5: resolution, 0 is the finest"
    )
    parser.add_argument(
        "--dataset", metavar="NAME", help="several volumes: name of the one to read"
    )
    _add_value_options(parser)
    return options


def _add_value_options(parser: argparse._ArgumentGroup) -> None:
    parser.add_argument(
        "--downsample",
        type=integer,
        choices=(1, 2, 4, 8),
        metavar="N",
        help="average N voxels along each axis: 2, 4 or 8 (1)",
    )
    parser.add_argument(
        "--smooth",
        type=number,
        metavar="S",
        help="smooth values by a Gaussian of S voxels, against noise and terraces (0)",
    )
    parser.add_argument(
        "--smooth-normals",
        type=number,
        metavar="S",
        help="smooth only the normals; isosurfaces do not change (0)",
    )
    parser.add_argument(
        "--field",
        choices=("absolute", "labels"),
        help="values without their sign, for both lobes of an orbital; or boundary of labels",
    )
    parser.add_argument(
        "--hide", type=integer, nargs="+", metavar="N", help="labels that are read as 0"
    )
    parser.add_argument(
        "--label-table", metavar="FILE", help="names and colors of labels (from the volume's file)"
    )
    add_region_options(parser)


def threads_options() -> Parser:
    parser = Parser(add_help=False)
    machine = parser.add_argument_group(MACHINES)
    machine.add_argument(
        "--seed",
        type=integer,
        default=0,
        metavar="N",
        help="random seed; equal seeds give equal results (0)",
    )
    machine.add_argument(
        "--threads",
        type=integer,
        default=0,
        metavar="N",
        help="number of threads; 0 uses every core (0)",
    )
    return parser


def lit_options(volume: str) -> Parser:
    """Returns the options for volumes to be lit."""
    parser = Parser(add_help=False)
    parser.add_argument(
        "volumes", metavar="VOLUME", nargs="*", help=volume + " (those of the scene file)"
    )
    parser.add_argument(
        "--capped", action="store_true", help="close isosurfaces at the border of the volume"
    )
    return parser


def color_options() -> Parser:
    """Returns the options for colors by the values of another volume."""
    options = Parser(add_help=False)
    parser = options.add_argument_group(COLORS)
    parser.add_argument(
        "--color-by",
        metavar="WHAT",
        help="gradient, height, slices on the faces of cuts, or a volume in the same coordinates, "
        "whose values are the colors",
    )
    parser.add_argument(
        "--color-map",
        metavar="NAME",
        help="color map such as viridis, vik or turbo; or labels, a color for each (viridis; "
        "slices: cet-l1)",
    )
    parser.add_argument(
        "--color-range",
        type=number,
        nargs=2,
        metavar=("LO", "HI"),
        help="values at the ends of the color map (those of the data)",
    )
    parser.add_argument(
        "--color-steps", type=integer, metavar="N", help="number of separate colors (smooth)"
    )
    parser.add_argument(
        "--color-reverse", action="store_true", help="exchange the ends of the color map"
    )
    parser.add_argument(
        "--color-symmetric", action="store_true", help="extend the range to be even about 0"
    )
    return options


def scene_options() -> Parser:
    """Returns the options for the light and the isovalue range."""
    parser = Parser(add_help=False)
    parser.add_argument("--scene", metavar="FILE", help="scene file (a box around the data)")
    parser.add_argument(
        "--isovalues",
        type=number,
        nargs=2,
        metavar=("LO", "HI"),
        help="isovalue range to bake (from the data); 0..1 for several volumes",
    )
    return parser


def workers_options(parser: argparse._ActionsContainer, here: str) -> None:
    """Adds the options of worker processes. here: Help of --workers."""
    either = parser.add_mutually_exclusive_group()
    either.add_argument("--workers", type=integer, metavar="N", help=here)
    either.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="address of a Dask scheduler with workers, such as tcp://10.0.0.1:8786",
    )


def memory_options(parser: argparse._ActionsContainer) -> None:
    parser.add_argument(
        "--memory",
        type=memory,
        metavar="SIZE",
        help=(
            "memory limit, such as 4GiB; larger volumes are stored in a file beside the output, "
            "and texels become coarser to fit"
        ),
    )


def resolution_options(parser: argparse._ActionsContainer) -> None:
    parser.add_argument(
        "--resolution",
        type=integer,
        metavar="N",
        help="texels along the longest axis (from the data)",
    )


def limit_options(parser: argparse._ActionsContainer) -> None:
    """Adds the options that end a bake."""
    parser.add_argument(
        "--error",
        type=number,
        metavar="PCT",
        help="target error in percent (1.5)",
    )
    parser.add_argument("--time", type=number, metavar="S", help="time limit in seconds (none)")


def isosurface_options() -> Parser:
    """Returns the options for one isosurface of a bake."""
    parser = Parser(add_help=False)
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    parser.add_argument(
        "--isovalue",
        type=number,
        required=True,
        metavar="C",
        help="isovalue in data units; 0..1 of the range for several volumes",
    )
    side_options(parser)
    return parser


def side_options(parser: argparse._ActionsContainer) -> None:
    """Adds the options that choose an isosurface among several volumes, and its side."""
    parser.add_argument(
        "--volume",
        type=integer,
        default=0,
        metavar="K",
        help="number of the volume, from 0 (0)",
    )
    parser.add_argument("--back", action="store_true", help="the back")
