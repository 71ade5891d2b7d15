# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of isosurfaces and of baked radiance.

Baked radiance is the emission of a volume texture or a vertex attribute. A cut at the border of the
volume may show the back of an isosurface. Without a bake of the back, it is plain Lambertian there.

The volume texture is an atlas of slices without padding. Math nodes blend eight lookups without
interpolation, which gives the same values in Cycles and in Eevee. An image texture must not
interpolate, because the tile of another slice lies next to each texel at the border of a tile.
"""

import os

import bpy
import numpy as np

from .. import versions
from ..store import bake_files
from .shader_graph import ALBEDO, COAT, GLOSS, OPACITY, RECOLOR, Graph, View

# Properties of an atlas image: the comments of its header, and True for the back.
ATLAS, BACK = "leaflight_atlas", "leaflight_back"


# Names of nodes of a slice: the position of a value in the color map, the test for values below the
# isovalue, and the emission.
_PART, _OUTSIDE, _EMISSION = "part", "outside", "emission"


def build_isosurface(material, scattering, ior, emission, view=View()):
    """Builds an unlit isosurface: "DIFFUSE", "MIRROR" or "GLASS". emission: radiance, RGB."""
    graph = Graph(material, view)
    surface = graph.reflecting(scattering, ior)
    if max(emission) > 0:
        surface = graph.sum(surface, graph.emission(emission))
    graph.finish(surface)


def set_albedo(material, albedo):
    """Sets the color of every reflecting node of a material that was built here."""
    color = (*albedo, 1.0)
    for node in material.node_tree.nodes:
        if node.name == ALBEDO and not np.allclose(node.inputs[1].default_value, albedo):
            node.inputs[1].default_value = albedo
        if node.type in {"BSDF_DIFFUSE", "BSDF_GLOSSY", "BSDF_GLASS"} and node.name != COAT:
            if not np.allclose(node.inputs[0].default_value, color, rtol=0, atol=1e-7):
                node.inputs[0].default_value = color


def build_emission(material, radiance):
    """Builds emission of one radiance (r, g, b) on both sides."""
    graph = Graph(material)
    graph.finish(graph.emission(radiance))


def build_attribute(material, front, back=None, view=View()):
    """Builds emission of the color attributes `front` and, if it was baked, `back`."""
    graph = Graph(material, view)
    graph.emit_sides(*(graph.attribute(name) for name in (front, back) if name))


def build_slice(material, name, colors):
    """Builds emission of an attribute through evenly spaced colors, above an isovalue."""
    graph = Graph(material)
    versions.let_through(material, False, False, True)
    value = graph.attribute(name).node.outputs["Fac"]
    part = graph.math("MULTIPLY_ADD", value, 1.0, 0.0, name=_PART)
    ramp = graph.node("ShaderNodeValToRGB", part)
    elements = ramp.color_ramp.elements
    for i, color in enumerate(colors):
        place = i / (len(colors) - 1)
        element = elements[-1] if i == len(colors) - 1 else elements[0] if i == 0 else None
        element = element or elements.new(place)
        element.position, element.color = place, (*color, 1.0)
    emission = graph.emission(ramp.outputs[0], name=_EMISSION)
    outside = graph.math("LESS_THAN", value, 0.0, name=_OUTSIDE)
    graph.finish(graph.mix_shaders(outside, emission, graph.transparent()))


def set_slice(material, low, high, isovalue, strength):
    """Sets the value range of the colors, the lowest visible value and the emission strength."""
    scale = 1.0 / max(high - low, 1e-30)
    nodes = material.node_tree.nodes
    for name, number, value in (
        (_PART, 1, scale),
        (_PART, 2, -low * scale),
        (_OUTSIDE, 1, isovalue),
        (_EMISSION, 1, strength),
    ):
        socket = nodes[name].inputs[number]
        if socket.default_value != np.float32(value):
            socket.default_value = value


def shared_material(tag, name, front, back=None):
    """Returns the material of the file with the property `tag`, or builds it."""
    for material in bpy.data.materials:
        if tag in material:
            return material
    material = bpy.data.materials.new(name)
    material[tag] = True
    versions.do_not_sample_as_light(material)
    build_attribute(material, front, back)
    return material


def set_opacity(material, opacity):
    node = material.node_tree.nodes.get(OPACITY)
    if node is not None and node.outputs[0].default_value != opacity:
        node.outputs[0].default_value = opacity


def set_coat(material, gloss, roughness):
    nodes = material.node_tree.nodes
    for name, socket, value in (
        (GLOSS, lambda node: node.outputs[0], gloss),
        (COAT, lambda node: node.inputs["Roughness"], roughness),
    ):
        node = nodes.get(name)
        if node is not None and socket(node).default_value != value:
            socket(node).default_value = value


def set_recoloring(material, factor, offset):
    """Shows factor * radiance + offset, each (r, g, b), in place of the baked radiance."""
    for node in material.node_tree.nodes:
        if node.name == RECOLOR:
            for socket, value in zip(node.inputs[1:], (factor, offset)):
                if not np.allclose(socket.default_value, value, rtol=1e-7, atol=0):
                    socket.default_value = value


def is_recolored(material):
    """True if set_recoloring() has changed a factor in a material."""
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    factors = [tuple(n.inputs[1].default_value) for n in nodes if n.name == RECOLOR]
    return any(factor != (1.0, 1.0, 1.0) for factor in factors)


def build_atlas(material, images, resolution, columns, texel_from_object, view=View()):
    """Builds emission of a radiance grid from its atlas.

    images: Atlas of the front and, if it was baked, of the back.
    resolution: Texels (nx, ny, nz), at least 2 each.
    columns: Tiles in a row of an image.
    texel_from_object: Matrix from the object's coordinates to those of texel centers, (4, 4).
    """
    nx, ny, nz = resolution
    rows = -(-nz // columns)
    graph = Graph(material, view)
    position = graph.position()
    low, weight = [], []
    for axis, count in enumerate((nx, ny, nz)):
        row = texel_from_object[axis]
        texel = graph.math("ADD", graph.vector("DOT_PRODUCT", position, row[:3]), row[3])
        texel = graph.math("MINIMUM", graph.math("MAXIMUM", texel, 0.0), count - 1.0)
        cell = graph.math("MINIMUM", graph.math("FLOOR", texel), count - 2.0)
        low.append(cell)
        weight.append(graph.math("SUBTRACT", texel, cell))

    corner_x = [low[0], graph.math("ADD", low[0], 1.0)]
    corner_y = [low[1], graph.math("ADD", low[1], 1.0)]
    places = []
    for k in range(2):
        slice_ = graph.math("ADD", low[2], float(k))
        # Add a half, because rounding near whole quotients could change the tile.
        row = graph.math(
            "FLOOR", graph.math("DIVIDE", graph.math("ADD", slice_, 0.5), float(columns))
        )
        column = graph.math("SUBTRACT", slice_, graph.math("MULTIPLY", row, float(columns)))
        tile_x = graph.math("MULTIPLY_ADD", column, float(nx), 0.5)
        tile_y = graph.math("MULTIPLY_ADD", row, float(ny), 0.5)
        for j in range(2):
            v = graph.math("DIVIDE", graph.math("ADD", tile_y, corner_y[j]), float(rows * ny))
            for i in range(2):
                u = graph.math(
                    "DIVIDE", graph.math("ADD", tile_x, corner_x[i]), float(columns * nx)
                )
                places.append(graph.combine(u, v))
    graph.emit_sides(*(_trilinear(graph, image, places, weight) for image in images))


def _trilinear(graph, image, places, weight):
    """Blends the texels at eight places, with x fastest, by a weight for each axis."""
    color = [graph.texel(image, place) for place in places]
    for axis in range(3):
        color = [
            graph.mix(color[2 * n], color[2 * n + 1], weight[axis]) for n in range(len(color) // 2)
        ]
    return color[0]


def texel_from_object(volume, resolution):
    """Returns the matrix (4, 4) from the coordinates of an object's volume to texel centers.

    The first and the last texel of an axis lie on the first and the last node of the volume.
    """
    nodes = np.array(volume.values.shape[::-1], np.float64)
    texels = np.array(resolution, np.float64)
    scale = np.diag([*((texels - 1.0) / (nodes - 1.0)), 1.0])
    return scale @ np.linalg.inv(volume.index_to_world)


def images_of(material):
    """Returns the images in the nodes of a material."""
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    return {node.image for node in nodes if node.type == "TEX_IMAGE" and node.image is not None}


def atlas_image(path, label, back, written):
    """Returns the image of an atlas file (store/atlases.py), in full precision.

    label: Identifies the image of an atlas after its file has moved.
    back: True for the back.
    written: True if the file was written after Blender may have read it.
    """
    images = (image for image in bpy.data.images if image.library is None)
    image = next((image for image in images if image.get(ATLAS) == label), None)
    if image is None:
        image = bpy.data.images.load(bake_files.portable(path))
        image[ATLAS], image[BACK] = label, back
        image.colorspace_settings.name = "Non-Color"
        image.use_half_precision = False
        image.alpha_mode = "NONE"
    elif os.path.normpath(bpy.path.abspath(image.filepath)) != str(path):
        image.filepath = bake_files.portable(path)
    elif written:
        image.reload()
    return image
