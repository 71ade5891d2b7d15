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
# Types of values by the words that stand for them in the help. Others are text.
_OF_WORDS = {
    **dict.fromkeys(("N", "K", "W", "FIRST"), integer),
    **dict.fromkeys(("C", "S", "Z", "PCT", "LO", "AROUND"), number),
    "SIZE": memory,
}


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
        switch(self, "--json", "print one JSON object as the last line")
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


def value(
    parser: argparse._ActionsContainer, name: str, words: str, help: str, **options: Any
) -> None:
    """Adds an option with values. words: One for each value, or one and "..." for any number."""
    first, *others = words.split()
    metavar: Any = first
    if others == ["..."]:
        options["nargs"] = "+"
    elif others:
        options["nargs"], metavar = 1 + len(others), (first, *others)
    options.setdefault("type", _OF_WORDS.get(first))
    parser.add_argument(name, metavar=metavar, help=help, **options)


def switch(parser: argparse._ActionsContainer, name: str, help: str, **options: Any) -> None:
    """Adds an option without values."""
    parser.add_argument(name, action="store_true", help=help, **options)


def layout_options() -> Parser:
    """Returns the options for the layout of values in a volume's file."""
    options = Parser(add_help=False)
    parser = options.add_argument_group("files")
    text = ".raw: nx ny nz; generated volume: nodes per side; points: nodes of the longest side"
    value(parser, "--dims", "N ...", text)
    text = ".raw, or any file with --dims: type of the values"
    parser.add_argument("--type", choices=TYPES, help=text)
    parser.add_argument("--endian", choices=ENDIANS, help=".raw: byte order (little)")
    text = ".raw: bytes before the values; -1 if the values end the file (0)"
    value(parser, "--skip", "N", text)
    text = ".raw, TIFF, HDF5, NumPy: voxel size, one or X Y Z (1)"
    value(parser, "--spacing", "S ...", text)
    value(parser, "--grid", "NAME", ".vdb: name of the grid (the first scalar one)")
    value(parser, "--frame", "K", "4D data: frame to read, from 0")
    text = "several values per voxel: number of the channel, from 0, or its name"
    value(parser, "--channel", "K", text, type=channel)
    value(parser, "--level", "K", "OME-Zarr, HDF5: resolution, 0 is the finest")
    value(parser, "--dataset", "NAME", "several volumes: name of the one to read")
    text = "average N voxels along each axis: 2, 4 or 8 (1)"
    value(parser, "--downsample", "N", text, choices=(1, 2, 4, 8))
    text = "smooth values by a Gaussian of S voxels, against noise and terraces (0)"
    value(parser, "--smooth", "S", text)
    text = "smooth only the normals; isosurfaces do not change (0)"
    value(parser, "--smooth-normals", "S", text)
    text = "values without their sign, for both lobes of an orbital; or boundary of labels"
    parser.add_argument("--field", choices=("absolute", "labels"), help=text)
    value(parser, "--hide", "N ...", "labels that are read as 0")
    value(parser, "--label-table", "FILE", "names and colors of labels (from the volume's file)")
    add_region_options(parser)
    return options


def seed_option(parser: argparse._ActionsContainer, help: str) -> None:
    value(parser, "--seed", "N", help, default=0)


def threads_options() -> Parser:
    parser = Parser(add_help=False)
    machine = parser.add_argument_group(MACHINES)
    seed_option(machine, "random seed; equal seeds give equal results (0)")
    value(machine, "--threads", "N", "number of threads; 0 uses every core (0)", default=0)
    return parser


def lit_options(volume: str) -> Parser:
    """Returns the options for volumes to be lit."""
    parser = Parser(add_help=False)
    text = f"{volume} (those of the scene file)"
    parser.add_argument("volumes", metavar="VOLUME", nargs="*", help=text)
    switch(parser, "--capped", "close isosurfaces at the border of the volume")
    return parser


def color_options() -> Parser:
    """Returns the options for colors by the values of another volume."""
    options = Parser(add_help=False)
    parser = options.add_argument_group(COLORS)
    text = (
        "gradient, height, slices on the faces of cuts, or a volume in the same coordinates, "
        "whose values are the colors"
    )
    value(parser, "--color-by", "WHAT", text)
    text = (
        "color map such as viridis, vik or turbo; or labels, a color for each (viridis; "
        "slices: cet-l1)"
    )
    value(parser, "--color-map", "NAME", text)
    text = "values at the ends of the color map (those of the data)"
    value(parser, "--color-range", "LO HI", text)
    value(parser, "--color-steps", "N", "number of separate colors (smooth)")
    switch(parser, "--color-reverse", "exchange the ends of the color map")
    switch(parser, "--color-symmetric", "extend the range to be even about 0")
    return options


def scene_options() -> Parser:
    """Returns the options for the light and the isovalue range."""
    parser = Parser(add_help=False)
    value(parser, "--scene", "FILE", "scene file (a box around the data)")
    text = "isovalue range to bake (from the data); 0..1 for several volumes"
    value(parser, "--isovalues", "LO HI", text)
    return parser


def workers_options(parser: argparse._ActionsContainer, here: str) -> None:
    """Adds the options of worker processes. here: Help of --workers."""
    either = parser.add_mutually_exclusive_group()
    value(either, "--workers", "N", here)
    text = "address of a Dask scheduler with workers, such as tcp://10.0.0.1:8786"
    value(either, "--scheduler", "ADDRESS", text)


def limit_options(parser: argparse._ActionsContainer) -> None:
    """Adds the options that end a bake."""
    value(parser, "--error", "PCT", "target error in percent (1.5)")
    value(parser, "--time", "S", "time limit in seconds (none)")


def resolution_options(parser: argparse._ActionsContainer) -> None:
    value(parser, "--resolution", "N", "texels along the longest axis (from the data)")


def bake_options() -> Parser:
    """Returns the option for the bake that a command reads."""
    parser = Parser(add_help=False)
    parser.add_argument("bake", metavar="BAKE", help="a .vdb written by bake")
    return parser


def isovalue_option(parser: argparse._ActionsContainer, words: str = "C") -> None:
    text = "isovalue in data units; 0..1 of the range for several volumes (chosen)"
    value(parser, "--isovalue", words, text)


def isosurface_options() -> Parser:
    """Returns the options for one isosurface of a bake."""
    parser = bake_options()
    isovalue_option(parser)
    side_options(parser)
    return parser


def side_options(parser: argparse._ActionsContainer) -> None:
    """Adds the options that choose an isosurface among several volumes, and its side."""
    value(parser, "--volume", "K", "number of the volume, from 0 (0)", default=0)
    switch(parser, "--back", "the back")
