# SPDX-License-Identifier: GPL-3.0-or-later
"""The slice atlases of bakes: images beside the bake, so that a scene renders without this add-on.

Each holds the id of its bake, its volume and its side in the comments of its header. One that is
missing or holds anything else is written again from the bake.
"""

import re
from pathlib import Path

import numpy as np
from leaflight import LeaflightError, _core

# Larger float images exceed what graphics drivers and memory commonly hold.
LARGEST_ATLAS = 8192


def label(identifier, index, back):
    """What the header of an atlas holds."""
    return f"Leaflight {identifier} volume {index + 1} {'back' if back else 'front'}"


def path_of(bake_path, index=0, back=False):
    """The atlas beside a bake; index: of the volume in it; back: of the back."""
    path = Path(bake_path)
    number = f"_{index + 1}" if index else ""
    return path.with_name(f"{path.stem}{number}_atlas{'_back' if back else ''}.exr")


def beside(bake_path):
    """The atlases that lie beside a bake."""
    path = Path(bake_path)
    name = re.compile(re.escape(path.stem) + r"(_\d+)?_atlas(_back)?\.exr")
    folder = path.parent
    there = sorted(folder.iterdir()) if folder.is_dir() else ()
    return [other for other in there if name.fullmatch(other.name)]


def renamed(atlas, old_bake, new_bake):
    """The name of an atlas when its bake gets a new one."""
    return new_bake.with_name(new_bake.stem + atlas.name.removeprefix(old_bake.stem))


def write(grid, bake_path, identifier, index):
    """Writes the atlas of each side that was baked, unless it is too large.

    Returns the tiles in a row of it, 0 when nothing was written. Raises LeaflightError.
    """
    nx, ny, nz = grid.resolution
    if nx * ny * nz > LARGEST_ATLAS**2:
        return 0
    columns = 0
    for back in (False, True) if grid.has_back else (False,):
        pixels, columns, _ = grid.atlas(back=back)
        if max(pixels.shape) > LARGEST_ATLAS:
            return 0
        _write(pixels, path_of(bake_path, index, back), label(identifier, index, back))
    return columns


def require(grid, bake_path, identifier, index, back):
    """The path of an atlas that holds what its label says; grid: a function that returns the grid.

    Returns (path, whether it was written just now). Raises LeaflightError.
    """
    path, expected = path_of(bake_path, index, back), label(identifier, index, back)
    try:
        if path.is_file() and _core.read_exr_comments(str(path)) == expected:
            return path, False
    except LeaflightError:
        pass
    _write(grid().atlas(back=back)[0], path, expected)
    return path, True


def _write(pixels, path, comments):
    # Blender's rows and the atlas's count from the bottom, those of EXR from the top.
    _core.write_exr(str(path), np.ascontiguousarray(pixels[::-1]), comments)
