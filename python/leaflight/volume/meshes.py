# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangle meshes: isosurfaces without light, their parts and their edges (_core.pyi)."""

from .._core import PolygonEdges as PolygonEdges
from .._core import connected_parts as connected_parts
from .._core import contour as contour
from .._core import large_parts as large_parts
from .._core import project_along as project_along
