# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as PLY files."""

import os
import tempfile
from pathlib import Path

import numpy as np

from ._core import LeaflightError
from .output import check_writable


def display_colours(radiance, exposure):
    """Radiance (n, 3) to uint8 sRGB (n, 3): times the exposure, clamped to 0..1, encoded."""
    linear = np.clip(np.asarray(radiance, dtype=np.float32) * np.float32(exposure), 0.0, 1.0)
    curve = 1.055 * np.power(linear, 1.0 / 2.4) - 0.055
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, curve)
    return np.rint(255.0 * encoded).astype(np.uint8)


def write_ply(path, surface, exposure):
    """Writes a Surface as binary PLY, under its final name or not at all. Raises LeaflightError.

    Vertex properties: x y z, nx ny nz, radiance_r radiance_g radiance_b (float, W/(m^2 sr), linear)
    and red green blue (uchar, see display_colours).
    """
    import meshio

    check_writable(path, ".ply")
    path = Path(path)
    colours = display_colours(surface.radiance, exposure)
    properties = {}
    for names, columns in (
        (("nx", "ny", "nz"), surface.normals),
        (("radiance_r", "radiance_g", "radiance_b"), surface.radiance),
        (("red", "green", "blue"), colours),
    ):
        properties |= dict(zip(names, columns.T))
    mesh = meshio.Mesh(surface.vertices, [("triangle", surface.triangles)], point_data=properties)
    # The folder, not the file, is temporary: meshio recognises the format by the suffix.
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".leaflight-") as folder:
        temporary = Path(folder) / "surface.ply"
        try:
            mesh.write(temporary)
            os.replace(temporary, path)
        except OSError as error:
            raise LeaflightError(f"{path}: cannot write the mesh: {error.strerror}.") from None
