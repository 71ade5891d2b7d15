# SPDX-License-Identifier: GPL-3.0-or-later
"""Global illumination for every isosurface of a scalar volume, baked once.

import leaflight

volume = leaflight.read_volume("brain.nii.gz")  # or any array of three axes
bake = leaflight.bake(volume)
surface = bake.surface(45.5)       # vertices, triangles and their radiance
bake.save("brain.vdb")
"""

from . import self_check  # noqa: F401 - first: it refuses a broken installation
from . import flatland
from ._core import Cancelled, LeaflightError, Progress
from .bake.bake import bake
from .bake.baked import Bake, Surface
from .bake.checkpoint import Checkpoint
from .bake.estimate import Estimate, estimate
from .bake.load_bake import load_bake
from .bake.moved_scene import moved
from .bake.refine import refine
from .export.datasets import to_xarray
from .export.export import export
from .export.mesh_objects import to_pyvista, to_trimesh, to_vtk
from .export.page import export_page
from .export.notebook import picture, show, widget
from .io.readers import read_volume
from .io.scene_file import cornell_box, load_scene
from .measure.compare import compare
from .scene.scene import fit_scene
from .scene.volume_texture import VolumeTexture, label_texture, texture_of
from .stills.still import still
from .version import __version__
from .volume import examples
from .volume.derived import gradient_of, height_of, slices_of
from .volume.memory import limit_memory
from .volume.other_arrays import as_volume
from .volume.particles import lapr, neuron, nucleons
from .volume.first_isovalue import default_isovalue, default_isovalue_range
from .volume.volume import Volume, bump_box

__all__ = [
    "Bake",
    "Cancelled",
    "Checkpoint",
    "Estimate",
    "LeaflightError",
    "Progress",
    "Surface",
    "Volume",
    "VolumeTexture",
    "__version__",
    "as_volume",
    "bake",
    "bump_box",
    "compare",
    "cornell_box",
    "default_isovalue",
    "default_isovalue_range",
    "estimate",
    "examples",
    "export",
    "export_page",
    "fit_scene",
    "flatland",
    "gradient_of",
    "height_of",
    "label_texture",
    "lapr",
    "limit_memory",
    "load_bake",
    "load_scene",
    "neuron",
    "nucleons",
    "read_volume",
    "refine",
    "slices_of",
    "still",
    "texture_of",
]

# Functions of layers above bakes become methods. Bake declares their signatures for type checkers.
setattr(Surface, "to_pyvista", to_pyvista)
setattr(Surface, "to_trimesh", to_trimesh)
setattr(Surface, "to_vtk", to_vtk)
setattr(Bake, "moved", moved)
setattr(Bake, "to_xarray", to_xarray)
setattr(Bake, "export_page", export_page)
setattr(Bake, "show", show)
setattr(Bake, "widget", widget)
setattr(Bake, "still", picture)
