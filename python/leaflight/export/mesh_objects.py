# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as meshes of other Python packages: the methods to_*() of Surface.

exposure: The exposure of the scene, for the colors.
"""

from importlib import import_module
from typing import Any

from .._core import LeaflightError
from ..bake.baked import Surface
from ..io.images import display_colors


def to_vtk(surface: Surface, exposure: float = 1.0) -> Any:
    """Returns a vtkPolyData with point data (vtk_files.py). Raises LeaflightError without VTK."""
    needed("vtkmodules", "vtk")
    return import_module(".vtk_files", __package__).polygons(surface, exposure)


def to_pyvista(surface: Surface, exposure: float = 1.0) -> Any:
    """Returns to_vtk() as a pyvista.PolyData. Raises LeaflightError without PyVista."""
    return needed("pyvista").wrap(to_vtk(surface, exposure))


def to_trimesh(surface: Surface, exposure: float = 1.0) -> Any:
    """Returns a trimesh.Trimesh with vertex colors (sRGB) and normals.

    Its vertex_attributes have the radiance, and the values of volumes that color it.
    Raises LeaflightError without trimesh.
    """
    return needed("trimesh").Trimesh(
        surface.vertices,
        surface.triangles,
        vertex_normals=surface.normals,
        vertex_colors=display_colors(surface.radiance, exposure),
        vertex_attributes={"radiance": surface.radiance, **surface.values},
        process=False,
    )


def needed(module: str, package: str = "") -> Any:
    """Returns a module of another package. Raises LeaflightError without it."""
    try:
        return import_module(module)
    except ImportError:
        package = package or module
        raise LeaflightError(
            f"This needs the Python package {package}: install it with pip install {package}."
        ) from None
