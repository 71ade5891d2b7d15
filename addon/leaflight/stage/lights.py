# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of Blender's lights as lamps of the bake, in radiometric units."""

import math

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.lights import AreaLight, Cone, PointLight, SunLight

from .. import versions
from . import nodes

# Smallest relative error from a point light's softness that causes a warning.
_SOFTNESS = 0.01


def export_light(obj, matrix, boxes, warnings):
    """Returns the lamp of a light object, or None if it is black. Raises LeaflightError.

    matrix: (4, 4), object to world. boxes: function without arguments that returns the volumes'
    world boxes [(2, 3), ...]. warnings: a list to which sentences are added.
    """
    what = f'Light "{obj.name}"'
    light = obj.data
    if not versions.casts_shadow(light) or light.cycles.is_portal:
        raise LeaflightError(
            f"{what} is a portal or casts no shadows, which the bake cannot model: change that in "
            "its settings or disable it in renders."
        )
    power = _power(what, light)
    axes = np.array(matrix, np.float64)
    if light.type == "AREA":
        lamp = _area(what, obj.name, light, axes, power)
    elif light.type == "SUN":
        lamp = _sun(what, obj.name, light, axes, power)
    else:
        lamp = _point(what, obj.name, light, axes, power)
        _warn_of_softness(what, light, lamp, boxes, warnings)
    return lamp if power.max() > 0 else None


def _power(what, light):
    """Returns the power (3,) in watts, or the irradiance of a sun."""
    if not versions.is_normalized(light):
        raise LeaflightError(
            f"{what} has Normalize off, which the bake does not model: turn it on and adapt its "
            "power."
        )
    power = np.array(light.color, np.float64) * light.energy * 2.0 ** versions.exposure(light)
    power *= np.array(versions.temperature_color(light)) * _tint(what, light)
    if not np.all(power >= 0):
        raise LeaflightError(f"{what} has a negative power: make it zero or positive.")
    return power


def _tint(what, light):
    """Returns the factor (3,) that a light's nodes apply to its color."""
    tree = versions.node_tree(light)
    if tree is None:
        return np.ones(3)
    emission = nodes.linked(tree, "Surface")
    if emission is None:
        return np.zeros(3)
    if emission.type != "EMISSION":
        raise LeaflightError(
            f"{what} ends in a {emission.bl_label} node, but the bake models Emission: change it."
        )
    strength = nodes.constant(what, emission, "Strength")
    return np.array(nodes.color(what, nodes.socket(emission, "Color"))) * strength


def _area(what, name, light, axes, power):
    if light.spread < math.radians(179.9):
        raise LeaflightError(
            f"{what} has a spread of {math.degrees(light.spread):.0f} degrees, but the bake models "
            "a spread of 180 degrees: change its spread."
        )
    width = light.size
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    edge_u, edge_v = axes[:3, 0] * width, axes[:3, 1] * height
    normal = np.cross(edge_u, edge_v)
    area = np.linalg.norm(normal)
    if not area > 0:
        raise LeaflightError(f"{what} has no area: give it a size above zero.")
    if abs(edge_u @ edge_v) > 1e-4 * area:
        raise LeaflightError(
            f"{what} is sheared by its parent, but the bake models rectangles and ellipses: apply "
            "or remove the parent's scale."
        )
    # The light shines along its local -Z, toward the cross product of the edges.
    if normal @ axes[:3, 2] > 0:
        edge_v = -edge_v
    ellipse = light.shape in {"DISK", "ELLIPSE"}
    corner = axes[:3, 3] - 0.5 * (edge_u + edge_v)
    radiance = power * versions.light_units().area / (area * (math.pi / 4 if ellipse else 1.0))
    return AreaLight(
        name, *(_numbers(v) for v in (corner, edge_u, edge_v, radiance)), ellipse=ellipse
    )


def _point(what, name, light, axes, power):
    cone = None
    if light.type == "SPOT":
        if light.use_square:
            raise LeaflightError(
                f"{what} is a square spot, but the bake models round ones: turn Square off."
            )
        axis = -axes[:3, 2] / np.linalg.norm(axes[:3, 2])
        cosine = versions.light_units().spot_cosine
        cone = Cone(_numbers(axis), float(light.spot_size), float(light.spot_blend), cosine)
    intensity = power / (4 * math.pi)
    radius = float(light.shadow_soft_size)
    return PointLight(name, _numbers(axes[:3, 3]), radius, _numbers(intensity), cone)


def _sun(what, name, light, axes, power):
    if light.angle >= math.pi:
        raise LeaflightError(
            f"{what} has an angle of {math.degrees(light.angle):.0f} degrees, but the bake models "
            "suns below 180 degrees: use the world instead."
        )
    irradiance = power * versions.light_units().sun(light.angle)
    direction = -axes[:3, 2] / np.linalg.norm(axes[:3, 2])
    return SunLight(name, _numbers(direction), _numbers(irradiance), float(light.angle))


def _warn_of_softness(what, light, lamp, boxes, warnings):
    if not versions.falls_off_softly(light) or not lamp.radius > 0:
        return
    position = np.array(lamp.position)
    for low, high in boxes():
        distance = np.linalg.norm(np.maximum(np.maximum(low - position, position - high), 0.0))
        if lamp.radius**2 > _SOFTNESS * distance**2:
            darker = lamp.radius**2 / (distance**2 + lamp.radius**2)
            warnings.append(
                f"{what} is so large and near that Cycles renders it up to {100 * darker:.0f} % "
                "darker at the volume than the bake: reduce its radius for a match"
            )
            return


def _numbers(vector):
    return tuple(float(x) for x in vector)
