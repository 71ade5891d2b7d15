# SPDX-License-Identifier: GPL-3.0-or-later
"""Export and import of the material of a volume object's isosurfaces."""

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.scene import Isosurfaces, is_color, ramp_at

from ..store import cache
from . import texture


def export_isosurfaces(obj, several):
    """Returns the Isosurfaces of a volume object. Raises LeaflightError.

    several: True if other volumes are baked with it.
    """
    settings = obj.leaflight
    return Isosurfaces(
        name=obj.name,
        albedo=albedo_ramp(obj),
        emission=emission_of(obj),
        scattering=settings.isosurface_scattering.lower(),
        ior=settings.isosurface_ior,
        isovalues=(settings.low, settings.high) if several else None,
        capped=settings.capped,
        texture=texture.world_texture(obj),
    )


def import_isosurfaces(settings, isosurfaces):
    """Gives the settings of a volume object the material of Isosurfaces, with one emission."""
    settings.capped = isosurfaces.capped
    settings.isosurface_scattering = isosurfaces.scattering.upper()
    settings.isosurface_ior = isosurfaces.ior
    settings.isosurface_stops.clear()
    if is_color(isosurfaces.albedo):
        settings.isosurface_albedo = isosurfaces.albedo
    else:
        for isovalue, color in isosurfaces.albedo:
            add_stop(settings, isovalue, color)
    emission = colors(isosurfaces.emission)[0]
    strength = float(emission.max())
    settings.isosurface_emission_strength = strength
    if strength > 0:
        settings.isosurface_emission = emission / strength


def add_stop(settings, isovalue, color):
    """Adds a stop to the color ramp and makes it the active one."""
    stop = settings.isosurface_stops.add()
    stop.isovalue, stop.color = isovalue, color
    settings.isosurface_stop = len(settings.isosurface_stops) - 1


def _stops(obj):
    """Returns [(isovalue, color), ...] of the stops, by isovalue; empty without a ramp."""
    return sorted((stop.isovalue, tuple(stop.color)) for stop in obj.leaflight.isosurface_stops)


def albedo_ramp(obj):
    """Returns the albedo as one color, or as stops (isovalue, color) in ascending isovalue.

    Raises LeaflightError if two stops have the same isovalue.
    """
    stops = _stops(obj)
    for (below, _), (above, _) in zip(stops, stops[1:]):
        if not below < above:
            raise LeaflightError(
                f'The color ramp of "{obj.name}" has two stops at isovalue {above:g}: move or '
                "remove one."
            )
    return stops or tuple(obj.leaflight.isosurface_albedo)


def colors(ramp):
    """Returns all colors (n, 3) of a ramp: one color, or stops (isovalue, color)."""
    return np.array([ramp] if is_color(ramp) else [color for _, color in ramp])


def albedo_at(obj, isovalue):
    """Returns the albedo (r, g, b) of one isosurface."""
    ramp = _stops(obj) or tuple(obj.leaflight.isosurface_albedo)
    return tuple(ramp_at(ramp, isovalue).tolist())


def emission_of(obj):
    """Returns the radiance (r, g, b) that all isosurfaces emit."""
    settings = obj.leaflight
    return tuple(settings.isosurface_emission_strength * x for x in settings.isosurface_emission)


def world_box(obj):
    """Returns the lowest and highest corner (2, 3) of the volume in world space.

    Raises LeaflightError.
    """
    low, high = np.asarray(cache.volume_of(obj).field().bounds, np.float64)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    matrix = np.array(obj.matrix_world, np.float64)
    world = (low + corners * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
    return np.array([world.min(axis=0), world.max(axis=0)])
