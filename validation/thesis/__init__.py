# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods of the thesis: bakes with a fixed number of samples, to compare with leaflight.bake.

PYTHONPATH=build/release/python:validation python3

import thesis

bake = thesis.bake(volume, samples=64, estimator="path")
"""

from .bake import bake
from .flatland import bake_flatland
from .graph import graph_mesh, graph_radiance
from .settings import PhotonMap, Scattered

__all__ = ["PhotonMap", "Scattered", "bake", "bake_flatland", "graph_mesh", "graph_radiance"]
