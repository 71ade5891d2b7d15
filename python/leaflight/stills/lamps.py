# SPDX-License-Identifier: GPL-3.0-or-later
"""Local shading: lamps on a surface, without shadows or light between surfaces.

Viewers of isosurfaces shade in this way, and the thesis compares with it. A lamp with an extent
becomes a few points.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..scene.lights import AreaLight, Light, PointLight, SunLight
from ..scene.scene import Mesh, SceneDescription

# Upper bound on the lamps in the shader of a web page.
MOST_LAMPS = 16
_SUN, _POINT, _ONE_SIDED, _TWO_SIDED = range(4)


@dataclass(frozen=True, eq=False)
class Lamps:
    """Lamps for local shading.

    rows: Position, kind; axis, cosine at the end of a spot's cone; intensity, cosine at the end of
        its bright part. The array is float64 (n, 12). Kind 0 is a sun with the direction to it as
        position and its irradiance as intensity. Kind 1 is a point or spot. Kind 2 is a piece of a
        surface that emits along its axis, kind 3 one that emits to both sides.
    ambient: Mean radiance from all directions.
    lights: Number of the scene's light of each lamp, or -1, int (n,).
    headlight: True if there is no other light.
    """

    rows: Array
    lights: Array
    ambient: Array
    headlight: bool

    def irradiance(self, points: Array, normals: Array, eye: Array) -> Array:
        """Returns irradiance over pi, float64 (n, 3), at points with unit normals."""
        if self.headlight:
            return headlight(points, normals, eye)
        total = np.zeros((len(points), 3))
        for row in self.rows:
            position, kind, axis, end, intensity, bright = np.split(row, [3, 4, 7, 8, 11])
            to_lamp = np.broadcast_to(position, points.shape) - (0.0 if kind == _SUN else points)
            squared = (to_lamp * to_lamp).sum(axis=1)
            to_lamp = to_lamp / np.sqrt(np.maximum(squared, 1e-30))[:, None]
            share = np.maximum((to_lamp * normals).sum(axis=1), 0.0)
            if kind != _SUN:
                cosine = -(to_lamp @ axis)
                share = share / np.maximum(squared, 1e-30)
                if kind == _POINT:
                    share = share * np.clip((cosine - end) / max(bright - end, 1e-6), 0.0, 1.0)
                else:
                    share = share * np.maximum(abs(cosine) if kind == _TWO_SIDED else cosine, 0.0)
            total += share[:, None] * intensity
        return total / math.pi + self.ambient


def headlight(points: Array, normals: Array, eye: Array) -> Array:
    """Returns light of a lamp at the camera that a white surface reflects, float64 (n, 3)."""
    to_eye = eye - points
    cosine = (normals * to_eye).sum(axis=1) / np.linalg.norm(to_eye, axis=1)
    return np.repeat(np.maximum(cosine, 0.0)[:, None], 3, axis=1)


def lamps_of(description: SceneDescription) -> Lamps:
    """Returns the Lamps of a SceneDescription in world coordinates, or the brightest of many."""
    rows = [(k, row) for k, light in enumerate(description.lights) for row in _rows(light)]
    for mesh in description.meshes:
        if max(mesh.emission) > 0.0:
            rows += [(-1, row) for row in _facets(mesh)]
    environment = description.environment
    ambient = np.zeros(3)
    if environment is not None:
        ambient = np.asarray(environment.radiance, np.float64)
        if environment.image is not None:
            ambient = ambient * _mean_of_sky(environment.image)
    brightest = sorted(rows, key=lambda numbered: -max(numbered[1][8:11]))[:MOST_LAMPS]
    lamps = np.array([row for _, row in brightest], np.float64).reshape(-1, 12)
    lights = np.array([light for light, _ in brightest], np.int64)
    return Lamps(lamps, lights, ambient, len(lamps) == 0 and not ambient.any())


def _rows(light: Light) -> list[tuple[float, ...]]:
    if isinstance(light, SunLight):
        return [(*np.negative(light.direction), _SUN, 0, 0, 0, 0, *light.irradiance, 0)]
    if isinstance(light, PointLight):
        if light.cone is None:
            return [(*light.position, _POINT, 0, 0, 0, -2, *light.intensity, -1)]
        cone = light.cone
        end = math.cos(0.5 * cone.angle)
        bright = end + cone.blend * (1.0 - end)
        return [(*light.position, _POINT, *cone.axis, end, *light.intensity, bright)]
    assert isinstance(light, AreaLight)
    corner, u, v = (np.asarray(x, np.float64) for x in (light.corner, light.edge_u, light.edge_v))
    normal = np.cross(u, v)
    area = np.linalg.norm(normal)
    share = 0.25 * (math.pi / 4.0 if light.ellipse else 1.0)
    intensity = np.multiply(light.radiance, area * share)
    return [
        (*(corner + a * u + b * v), _ONE_SIDED, *(normal / area), 0, *intensity, 0)
        for a in (0.25, 0.75)
        for b in (0.25, 0.75)
    ]


def _facets(mesh: Mesh) -> list[tuple[float, ...]]:
    corners = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.triangles, np.int64)]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    largest = np.argsort(-areas)[:MOST_LAMPS]
    return [
        (*corners[k].mean(axis=0), _TWO_SIDED, *(normals[k] / areas[k]), 0)
        + (*np.multiply(mesh.emission, areas[k]), 0)
        for k in largest
        if areas[k] > 0.0
    ]


def _mean_of_sky(image: Array) -> Array:
    """Returns the mean over the sphere of a latitude-longitude image."""
    latitude = (np.arange(len(image)) + 0.5) / len(image) * math.pi
    weight = np.sin(latitude)
    mean: Array = (image.mean(axis=1) * weight[:, None]).sum(axis=0) / weight.sum()
    return mean
