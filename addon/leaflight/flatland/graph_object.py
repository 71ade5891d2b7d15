# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatland in space: an image as its height graph, with isolines lit within the plane.

The graph is a grid mesh with a node for each pixel. A node has the baked radiance of the isoline
through it. A child object has the isolines as thin tubes on the graph. Both emit the color
attribute `radiance`; before a bake they are Lambertian.
"""

import bpy
import numpy as np
from leaflight import LeaflightError, _core, flatland

from .. import session
from ..show import display, fill, shader, surface_object
from ..show.isosurface import RADIANCE

# Largest number of nodes along a side. More would slow down the viewport; the bake has every pixel.
_MOST_NODES = 1024

_GRAPH, _ISOLINES = "graph", "isolines"

# Albedos before a bake.
_PLAIN_GRAPH, _PLAIN_LINE = (0.8, 0.8, 0.8), (0.1, 0.1, 0.1)

# Caches, which are never saved: height fields by (source, nodes), and bakes by their id.
_fields = session.cache()
_bakes = session.cache()


def field_of(obj):
    """Returns the height field of a flatland object, a 2D Volume. Raises LeaflightError."""
    settings = obj.leaflight_flat
    key = (bpy.path.abspath(settings.source), settings.nodes)
    if key not in _fields:
        source, nodes = key
        _fields[key] = flatland.read_image(source) if source else flatland.bump_box_2d(nodes)
    return _fields[key]


def keep_bake(identifier, bake):
    _bakes[identifier] = bake


def forget():
    _fields.clear()
    _bakes.clear()


def create(context, field, size, settings):
    """Adds the graph of a height field with its isolines, unlit.

    settings: attributes of Object.leaflight_flat.
    """
    graph = bpy.data.objects.new(field.name, bpy.data.meshes.new(field.name))
    lines = bpy.data.objects.new(
        f"{field.name} Isolines", bpy.data.meshes.new(f"{field.name} Isolines")
    )
    display.mark(graph, _GRAPH)
    display.mark(lines, _ISOLINES)
    lines.parent = graph
    low, high = np.asarray(field.field().bounds, np.float64)
    center = 0.5 * (low + high)
    graph.scale = (size, size, size)
    graph.location = (-size * center[0], -size * center[1], 0.0)
    for obj in (graph, lines):
        context.collection.objects.link(obj)
        obj.data.materials.append(bpy.data.materials.new(obj.name))
    for name, value in settings.items():
        setattr(graph.leaflight_flat, name, value)
    graph.leaflight_flat.is_flatland = True
    rebuild(graph)
    return graph


def isolines_of(obj):
    """Returns the object of the isolines, None if it was deleted."""
    return next((child for child in obj.children if display.is_display(child, _ISOLINES)), None)


def isovalues(settings):
    """Returns the isovalues of the isolines, spread evenly in the isovalue range."""
    parts = (np.arange(settings.count) + 0.5) / settings.count
    return settings.low + parts * (settings.high - settings.low)


def rebuild(obj, passed=None):
    """Builds graph and isolines again, after a bake or a change of their shape.

    passed: the FlatBake of a pass to show instead of the object's bake. Errors go to
    surface_object.problems.
    """
    surface_object.problems.pop(obj.name, None)
    try:
        field = field_of(obj)
        settings = obj.leaflight_flat
        bake = passed or _bakes.get(settings.bake_id)
        if settings.bake_id and bake is None:
            raise LeaflightError(
                f'The bake of "{obj.name}" was not saved with the file: bake again to light it.'
            )
    except LeaflightError as error:
        surface_object.problems[obj.name] = str(error)
        return
    _fill(obj, *_graph(field, settings, bake))
    lines = isolines_of(obj)
    if lines is not None:
        _fill(lines, *_tubes(field, settings, bake))


def _fill(obj, vertices, quads, radiance):
    material = obj.data.materials[0]
    if radiance is None:
        fill.fill(obj.data, vertices, quads, {})
        shader.build_lambertian(
            material, _PLAIN_LINE if display.is_display(obj, _ISOLINES) else _PLAIN_GRAPH
        )
    else:
        fill.fill(obj.data, vertices, quads, {RADIANCE: radiance})
        shader.build_attribute(material, RADIANCE, RADIANCE)


def _heights(field, settings, values):
    """Returns heights in the object's coordinates, where the image's longest side is 1."""
    low, high = field.field().range
    return settings.height * (np.asarray(values, np.float64) - low) / (high - low)


def _graph(field, settings, bake):
    """Returns (vertices, quads, radiance or None) of the graph; at most _MOST_NODES per axis."""
    rows, columns = field.values.shape
    step = -(-max(rows, columns) // _MOST_NODES)
    i, j = np.arange(0, columns, step), np.arange(0, rows, step)
    x, y = np.meshgrid(i, j)
    index = np.stack([x.ravel(), y.ravel(), np.ones(x.size)], axis=-1)
    points = (index @ np.asarray(field.index_to_world, np.float64).T)[:, :2]
    heights = _heights(field, settings, field.values[y.ravel(), x.ravel()])
    vertices = np.concatenate([points, heights[:, None]], axis=1)
    corner = np.arange(x.size).reshape(x.shape)
    quads = np.stack(
        [corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]], axis=-1
    ).reshape(-1, 4)
    return vertices, quads, _radiance(settings, bake, points)


def _tubes(field, settings, bake):
    """Returns (vertices, quads, radiance or None) of the isolines, as tubes with four edges."""
    vertices, quads, radiance = [np.empty((0, 3))], [np.empty((0, 4), int)], [np.empty((0, 3))]
    count = 0
    for isovalue in isovalues(settings):
        points, _, segments = _core.contour2(field.field(), float(isovalue))
        vertices.append(
            _rings(points, segments, _heights(field, settings, isovalue), settings.width)
        )
        a, b = (4 * (count + segments[:, end]) for end in (0, 1))
        for edge in range(4):
            following = (edge + 1) % 4
            quads.append(np.stack([a + edge, b + edge, b + following, a + following], axis=-1))
        if bake is not None:
            radiance.append(_radiance(settings, bake, points).repeat(4, axis=0))
        count += len(points)
    lit = np.concatenate(radiance) if bake is not None else None
    return np.concatenate(vertices), np.concatenate(quads), lit


def _rings(points, segments, height, width):
    """Returns vertices (4 n, 3) around points (n, 2), in the order beside, above, beside, below."""
    rings = np.zeros((len(points), 4, 3))
    rings[..., :2] = points[:, None]
    rings[..., 2] = height
    across = 0.5 * width * _normals(points, segments)
    rings[:, 0, :2] += across
    rings[:, 1, 2] += 0.5 * width
    rings[:, 2, :2] -= across
    rings[:, 3, 2] -= 0.5 * width
    return rings.reshape(-1, 3)


def _normals(points, segments):
    """Returns unit vectors (n, 2) across the lines at their vertices."""
    along = points[segments[:, 1]] - points[segments[:, 0]]
    tangents = np.zeros_like(points, dtype=np.float64)
    for end in (0, 1):
        np.add.at(tangents, segments[:, end], along)
    lengths = np.linalg.norm(tangents, axis=1, keepdims=True)
    tangents /= np.maximum(lengths, 1e-30)
    return np.stack([-tangents[:, 1], tangents[:, 0]], axis=-1)


def _radiance(settings, bake, points):
    if bake is None:
        return None
    factor = flatland.BRIGHTNESS_CORRECTION if settings.brightness_correction else 1.0
    return factor * bake.radiance(np.ascontiguousarray(points, np.float64))
