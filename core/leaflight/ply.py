# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as PLY files."""

from .images import display_colours
from .output import check_writable, replaced


def write_ply(path, surface, exposure):
    """Writes a Surface as binary PLY, under its final name or not at all. Raises LeaflightError.

    Vertex properties: x y z, nx ny nz, radiance_r radiance_g radiance_b (float, W/(m^2 sr), linear)
    and red green blue (uchar, see display_colours).
    """
    import meshio

    check_writable(path, ".ply")
    colours = display_colours(surface.radiance, exposure)
    properties = {}
    for names, columns in (
        (("nx", "ny", "nz"), surface.normals),
        (("radiance_r", "radiance_g", "radiance_b"), surface.radiance),
        (("red", "green", "blue"), colours),
    ):
        properties |= dict(zip(names, columns.T))
    mesh = meshio.Mesh(surface.vertices, [("triangle", surface.triangles)], point_data=properties)
    with replaced(path) as temporary:
        mesh.write(temporary)
