# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between versions of Blender in building, reading and animating scenes.

The add-on uses it, and cycles_scene.py in a Blender that has neither the add-on nor the package. So
it imports neither of them, nor Blender itself.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class LightUnits:
    """The radiometric units of lights in Cycles.

    A point or spot light has the radiant intensity power / 4 pi and a radius that no scale changes.
    """

    # Radiance of an AREA light per watt and unit area, its object's scale counted.
    area: float
    # True if a spot also fades with the cosine to its axis.
    spot_cosine: bool
    # True if always E = I / (d^2 + r^2) at the distance d from a point light of radius r; None
    # if a setting of the light decides. Otherwise E = I / d^2, as in the bake.
    soft_points: bool | None
    # True if the sun is sampled on a disc of directions, a little dimmer than its strength.
    sun_disc: bool

    def sun(self, angle: float) -> float:
        """Returns the irradiance of a sun of this angle, per unit of its strength."""
        cosine = math.cos(0.5 * angle)  # computes the mean cosine over the disc below
        return 2.0 * cosine / (1.0 + cosine) if self.sun_disc else 1.0


# Units from each version on. They changed between 3.4 and 4.2; PyPI has no version in between to
# test.
_LIGHT_UNITS = (
    ((3, 4), LightUnits(area=1 / 4, spot_cosine=True, soft_points=True, sun_disc=True)),
    ((4, 2), LightUnits(area=1 / math.pi, spot_cosine=False, soft_points=None, sun_disc=False)),
)

# Versions whose lights were compared with Cycles in tests (docs/reliability.md).
CHECKED = ((3, 4), (4, 2), (4, 3), (4, 5), (5, 0), (5, 1), (5, 2))


def light_units(version: Sequence[int]) -> LightUnits | None:
    """Returns the LightUnits of a version, None before the first."""
    rows = [units for since, units in _LIGHT_UNITS if tuple(version[:2]) >= since]
    return rows[-1] if rows else None


def node_tree(owner: Any) -> Any:
    """Returns the node tree of a material, world or light that renders; None if it uses none."""
    return owner.node_tree if _always_has_nodes(owner) or owner.use_nodes else None


def give_nodes(owner: Any) -> Any:
    """Returns the node tree, after enabling nodes."""
    if not _always_has_nodes(owner):
        owner.use_nodes = True
    return owner.node_tree


def _always_has_nodes(owner: Any) -> bool:
    """Returns True for materials and worlds from 5.0 on, and lights from 5.2 on.

    Blender 6.0 drops the property use_nodes.
    """
    switch = owner.bl_rna.properties.get("use_nodes")
    return switch is None or getattr(switch, "is_deprecated", False)


def fcurves(owner: Any) -> list[Any]:
    """Returns the curves that animate a data-block; from 4.4 on those of its slot in the action."""
    data = owner.animation_data
    if data is None or data.action is None:
        return []
    if not hasattr(data.action, "layers"):
        return list(data.action.fcurves)
    slot = data.action_slot
    strips = [strip for layer in data.action.layers for strip in layer.strips]
    bags = [strip.channelbag(slot) for strip in strips if slot is not None]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def set_normals(mesh: Any, normals: ArrayLike) -> None:
    """Sets custom normals (n, 3) of the vertices. Until 4.0 they need auto smooth."""
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(normals)


def set_loop_starts(mesh: Any, starts: Sequence[int] | NDArray[Any], corners: int) -> None:
    """Creates polygons with this many corners each. From 4.0 on their starts are enough."""
    mesh.polygons.foreach_set("loop_start", starts)
    if not mesh.polygons[0].bl_rna.properties["loop_total"].is_readonly:
        mesh.polygons.foreach_set("loop_total", np.full(len(starts), corners, np.int32))


def polish(bsdf: Any) -> None:
    """Makes a Glossy or Glass node perfectly smooth. Until 3.6 this needs another distribution."""
    if "SHARP" in bsdf.bl_rna.properties["distribution"].enum_items:
        bsdf.distribution = "SHARP"
    for socket in bsdf.inputs:
        if socket.identifier == "Roughness":
            socket.default_value = 0.0
