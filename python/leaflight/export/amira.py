# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of all isosurfaces as an RGBA volume for amira (AmiraMesh, .am): thesis 5.3.

In amira it is the Color Field of an isosurface of the same data.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import display_colors
from ..io.output import check_writable, replaced
from ..paths import AnyPath
from .point_grid import point_grid


def write_amira(path: AnyPath, bake: Bake, volume: int = 0) -> None:
    """Writes the colors of a volume (its number) of a Bake. Raises LeaflightError.

    A point has four bytes: sRGB at the scene's exposure, and 255. The box of the file is the volume
        in world coordinates. A TransformationMatrix places volumes whose axes are not those of the
        world.
    """
    check_writable(path, ".am")
    grid = point_grid(bake, volume)
    nz, ny, nx = grid.values.shape
    pixels = np.full((nz, ny, nx, 4), 255, np.uint8)
    pixels[..., :3] = display_colors(grid.radiance, bake.scene.exposure)
    header = "\n".join(
        [
            "# AmiraMesh BINARY-LITTLE-ENDIAN 2.1",
            f"define Lattice {nx} {ny} {nz}",
            "Parameters {",
            f'    Content "{nx}x{ny}x{nz} byte[4], uniform coordinates",',
            *_place(grid.index_to_world, (nx, ny, nz)),
            '    CoordType "uniform"',
            "}",
            "Lattice { byte[4] Data } @1",
            "# Data section follows",
            "@1",
            "",
        ]
    )
    with replaced(path) as temporary:
        with open(temporary, "wb") as file:
            file.write(header.encode("ascii"))
            file.write(pixels.data)
            file.write(b"\n")


def _place(index_to_world: Array, count: Sequence[int]) -> list[str]:
    """Returns the header lines with the position of the points.

    The box of amira spans the first to the last point.
    """
    axes, origin = index_to_world[:3, :3], index_to_world[:3, 3]
    step = np.diag(axes)
    if np.array_equal(axes, np.diag(step)) and (step > 0).all():
        ends = origin + step * (np.array(count) - 1)
        return [_numbers("BoundingBox", np.stack([origin, ends], axis=1))]
    ends = np.array(count) - 1.0
    return [
        # Matrices are column by column, as in OpenGL.
        _numbers("TransformationMatrix", index_to_world.T),
        _numbers("BoundingBox", np.stack([np.zeros(3), ends], axis=1)),
    ]


def _numbers(name: str, numbers: ArrayLike) -> str:
    return f"    {name} {' '.join(f'{number:.9g}' for number in np.ravel(numbers))},"
