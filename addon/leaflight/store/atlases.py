# SPDX-License-Identifier: GPL-3.0-or-later
"""The slice atlases of bakes: images beside the bake, so that a scene renders without this add-on.

They hold the light without the colors of another volume, because they are shown only without it.

The comments in the header of an atlas hold the id of its bake, its volume and its side. An atlas
that is missing or holds other comments is written again from the bake.
"""

import re
from pathlib import Path

import numpy as np
from leaflight import LeaflightError
from leaflight.io.images import read_exr_comments, write_exr

# Limit of width and height in pixels. Graphics drivers and memory rarely hold larger float images.
LARGEST_ATLAS = 8192


def label(identifier, index, back):
    """Returns the comments in the header of an atlas."""
    return f"Leaflight {identifier} volume {index + 1} {'back' if back else 'front'}"


def path_of(bake_path, index=0, back=False):
    """Returns the path of the atlas beside a bake.

    index: the volume in the bake; back: True for the back, False for the front.
    """
    path = Path(bake_path)
    number = f"_{index + 1}" if index else ""
    return path.with_name(f"{path.stem}{number}_atlas{'_back' if back else ''}.exr")


def beside(bake_path):
    """Returns the paths of the atlases beside a bake."""
    path = Path(bake_path)
    name = re.compile(re.escape(path.stem) + r"(_\d+)?_atlas(_back)?\.exr")
    folder = path.parent
    files = sorted(folder.iterdir()) if folder.is_dir() else ()
    return [other for other in files if name.fullmatch(other.name)]


def renamed(atlas, old_bake, new_bake):
    """Returns the path of an atlas after its bake has moved from old_bake to new_bake."""
    return new_bake.with_name(new_bake.stem + atlas.name.removeprefix(old_bake.stem))


def write(grid, bake_path, identifier, index):
    """Writes the atlas of each baked side, unless it is too large.

    Returns the number of tiles in a row, 0 if nothing was written. Raises LeaflightError.
    """
    nx, ny, nz = grid.resolution
    if nx * ny * nz > LARGEST_ATLAS**2:
        return 0
    columns = 0
    for back in (False, True) if grid.has_back else (False,):
        pixels, columns, _ = grid.with_texture(None).atlas(back=back)
        if max(pixels.shape) > LARGEST_ATLAS:
            return 0
        _write(pixels, path_of(bake_path, index, back), label(identifier, index, back))
    return columns


def require(grid, bake_path, identifier, index, back):
    """Writes an atlas unless its file already has the expected label.

    grid: a function that returns the grid. Returns (path, True if the atlas was written). Raises
    LeaflightError.
    """
    path, expected = path_of(bake_path, index, back), label(identifier, index, back)
    try:
        if path.is_file() and read_exr_comments(str(path)) == expected:
            return path, False
    except LeaflightError:
        pass
    _write(grid().with_texture(None).atlas(back=back)[0], path, expected)
    return path, True


def _write(pixels, path, comments):
    # Rows of Blender and of the atlas count from the bottom. Rows of EXR count from the top.
    write_exr(str(path), np.ascontiguousarray(pixels[::-1]), comments)
