# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces and photons as PLY files."""

from importlib import import_module
from typing import Any

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Surface
from ..bake.photons import Photons
from ..io.images import display_colors
from ..io.output import check_writable, replaced
from ..paths import AnyPath
from ..scene.volume_texture import identifiers


def write_ply(path: AnyPath, surface: Surface, exposure: float) -> None:
    """Writes a Surface as binary PLY, under its final name or not at all. Raises LeaflightError.

    Vertex properties: x y z, nx ny nz, radiance_r radiance_g radiance_b (float, W/(m^2 sr), linear)
    and red green blue (uchar, see display_colors).
    Volumes that color it add their values (float). A value is NaN where they have none.
    """
    colors = display_colors(surface.radiance, exposure)
    properties = {
        **_columns("nx ny nz", surface.normals),
        **_columns("radiance_r radiance_g radiance_b", surface.radiance),
        **_columns("red green blue", colors),
    }
    properties |= identifiers(surface.values, [*"xyz", *properties])
    _write(path, surface.vertices, [("triangle", surface.triangles)], properties)


def write_photons(path: AnyPath, photons: Photons) -> None:
    """Writes Photons as binary PLY of points, as write_ply does.

    Vertex properties: x y z (double), flux_r flux_g flux_b and common_isovalue (float, see
    photons.py), direct (uchar, 0 or 1), red green blue (uchar).
    """
    properties = {
        **_columns("flux_r flux_g flux_b", photons.flux_height),
        "common_isovalue": photons.common_isovalue,
        "direct": photons.direct.astype("uint8"),
        **_columns("red green blue", display_colors(photons.colors(), 1.0)),
    }
    _write(path, photons.positions, [], properties)


def library(path: AnyPath) -> Any:
    """Returns the module that writes PLY. Raises LeaflightError if it is not installed."""
    try:
        return import_module("meshio")
    except ImportError:
        raise LeaflightError(
            f"{path}: writing .ply needs the Python package meshio, which is not installed; "
            "install python3-meshio, or pip install meshio."
        ) from None


def _columns(names: str, values: Array) -> dict[str, Array]:
    return dict(zip(names.split(), values.T))


def _write(
    path: AnyPath, points: Array, cells: list[tuple[str, Array]], properties: dict[str, Array]
) -> None:
    meshio = library(path)
    check_writable(path, ".ply")
    mesh = meshio.Mesh(points, cells, point_data=properties)
    with replaced(path) as temporary:
        mesh.write(temporary)
