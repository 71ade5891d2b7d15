# SPDX-License-Identifier: GPL-3.0-or-later
"""The node tree of a material of isosurfaces, and the parts of the surface that it shows."""

import functools
from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import versions

# Names of nodes whose values change without a new build: opacity of the surface, change of the
# baked albedo, strength and roughness of the coat.
OPACITY, RECOLOR, GLOSS, COAT = "opacity", "recolor", "gloss", "coat"
# Name of a node: the albedo that a texture multiplies.
ALBEDO = "albedo"


@dataclass(frozen=True)
class Cut:
    """A box that cuts a surface: from low to high, (x, y, z) in the coordinates of its object."""

    box: object = field(repr=False)
    name: str
    low: tuple
    high: tuple
    keeps_inside: bool


@dataclass(frozen=True)
class View:
    """The display options of a surface.

    is_translucent: True if objects behind it show through.
    lies_among: True if it is one of several translucent surfaces.
    cut: A Cut or None.
    is_glossy: True if it has a coat, which reflects the scene's lamps.
    texture: Name of the color attribute that multiplies the albedo, or an empty text.
    """

    is_translucent: bool = False
    lies_among: bool = False
    cut: object = None
    is_glossy: bool = False
    texture: str = ""


class Graph:
    """Builds the node tree of a material from scratch."""

    def __init__(self, material, view=View()):
        self._view, self._hides_back = view, False
        self._material = material
        versions.let_through(material, view.is_translucent, view.lies_among, view.cut is not None)
        self.tree = versions.give_nodes(material)
        self.tree.nodes.clear()

    def node(self, kind, *values, **attributes):
        """Returns a new node whose first inputs are these values or sockets."""
        node = self.tree.nodes.new(kind)
        node.location = (200 * (len(self.tree.nodes) // 12), -160 * (len(self.tree.nodes) % 12))
        node.hide = True
        for name, value in attributes.items():
            if value is not None:
                setattr(node, name, value)
        for value, socket in zip(values, node.inputs):
            self.connect(value, socket)
        return node

    def connect(self, value, socket):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, *values, name=None):
        return self.node("ShaderNodeMath", *values, operation=operation, name=name).outputs[0]

    def vector(self, operation, *values, name=None):
        node = self.node("ShaderNodeVectorMath", *values, operation=operation, name=name)
        return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]

    def combine(self, *values):
        return self.node("ShaderNodeCombineXYZ", *values).outputs[0]

    def texel(self, image, position):
        kind = "ShaderNodeTexImage"
        node = self.node(kind, position, image=image, interpolation="Closest", extension="EXTEND")
        return node.outputs[0]

    def mix(self, a, b, weight):
        """Returns a + weight * (b - a)."""
        splat = self.combine(weight, weight, weight)
        return self.vector("MULTIPLY_ADD", self.vector("SUBTRACT", b, a), splat, a)

    def attribute(self, name):
        return self.node("ShaderNodeAttribute", attribute_name=name).outputs["Color"]

    def lambertian(self):
        return self._colored(self.node("ShaderNodeBsdfDiffuse")).outputs[0]

    def _colored(self, node):
        """Gives a reflecting node the color of the texture."""
        if self._view.texture:
            texture = self.attribute(self._view.texture)
            color = self.vector("MULTIPLY", texture, (1, 1, 1), name=ALBEDO)
            self.connect(color, node.inputs[0])
        return node

    def reflecting(self, scattering, ior):
        if scattering == "DIFFUSE":
            return self.lambertian()
        kind = "ShaderNodeBsdfGlass" if scattering == "GLASS" else "ShaderNodeBsdfGlossy"
        node = self._colored(self.node(kind))
        for socket in node.inputs:
            if socket.identifier in {"Roughness", "IOR"}:
                socket.default_value = ior if socket.identifier == "IOR" else 0.0
        return node.outputs[0]

    def emission(self, color, name=None):
        """Returns emission of a color (r, g, b), which may exceed 1, or of a socket."""
        values = [color]
        if not isinstance(color, bpy.types.NodeSocket):
            strength = max(color)
            values = [(*(x / strength for x in color), 1.0), strength]
        return self.node("ShaderNodeEmission", *values, name=name).outputs[0]

    def sum(self, a, b):
        return self.node("ShaderNodeAddShader", a, b).outputs[0]

    def backfacing(self):
        geometry = self.node("ShaderNodeNewGeometry")
        return next(s for s in geometry.outputs if s.identifier == "Backfacing")

    def recolored(self, radiance):
        return self.vector("MULTIPLY_ADD", radiance, (1, 1, 1), (0, 0, 0), name=RECOLOR)

    def emit_sides(self, front, back=None):
        """Finishes the material with an emission color for each side.

        Without `back`, the back of an opaque surface is Lambertian, and that of a translucent
        surface is invisible. A Lambertian back would show through its front.
        """
        if back is not None:
            radiance = self.mix(front, back, self.backfacing())
            self.finish(self.emission(self.recolored(radiance)))
            return
        front = self.emission(self.recolored(front))
        if self._view.is_translucent:
            self._hides_back = True
            self.finish(front)
            return
        self.finish(self.mix_shaders(self.backfacing(), front, self.lambertian()))

    def mix_shaders(self, weight, a, b):
        return self.node("ShaderNodeMixShader", weight, a, b).outputs[0]

    def transparent(self):
        return self.node("ShaderNodeBsdfTransparent").outputs[0]

    def coated(self, shader):
        """Returns the shader under a clear coat with Schlick's reflectance (1994), index 1.8."""
        facing = self.node("ShaderNodeLayerWeight", 0.5).outputs["Facing"]
        grazing = self.math("POWER", facing, 5.0)
        reflectance = self.math("MULTIPLY_ADD", grazing, 0.92, 0.08)
        gloss = self.node("ShaderNodeValue", name=GLOSS)
        coat = self.node("ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0, 1.0), name=COAT)
        weight = self.math("MULTIPLY", reflectance, gloss.outputs[0])
        return self.mix_shaders(weight, shader, coat.outputs[0])

    def position(self, obj=None):
        """Returns the position in the coordinates of an object, by default the material's."""
        coordinates = self.node("ShaderNodeTexCoord", object=obj)
        return next(s for s in coordinates.outputs if s.identifier == "Object")

    def inside(self, cut):
        """Returns a socket that is 1 within the box of a Cut, else 0."""
        position = self.position(cut.box)
        low, high = np.array(cut.low), np.array(cut.high)
        half = np.maximum(0.5 * (high - low), 1e-6)
        part = self.vector("SUBTRACT", position, tuple(0.5 * (low + high)))
        part = self.vector("ABSOLUTE", self.vector("DIVIDE", part, tuple(half)))
        x, y, z = self.node("ShaderNodeSeparateXYZ", part).outputs
        return self.math("LESS_THAN", self.math("MAXIMUM", self.math("MAXIMUM", x, y), z), 1.0)

    def seen(self):
        """Returns a socket with the visible share of the surface, or None if all is visible."""
        factors = []
        if self._view.is_translucent:
            factors.append(self.node("ShaderNodeValue", name=OPACITY).outputs[0])
        if self._hides_back:
            factors.append(self.math("SUBTRACT", 1.0, self.backfacing()))
        if self._view.cut is not None:
            inside = self.inside(self._view.cut)
            keeps = self._view.cut.keeps_inside
            factors.append(inside if keeps else self.math("SUBTRACT", 1.0, inside))
        product = functools.partial(self.math, "MULTIPLY")
        return functools.reduce(product, factors) if factors else None

    def finish(self, shader):
        if self._view.is_glossy:
            shader = self.coated(shader)
        # Keep Eevee from drawing a hidden back as the nearest layer.
        self._material.use_backface_culling = self._hides_back
        seen = self.seen()
        if seen is not None:
            shader = self.mix_shaders(seen, self.transparent(), shader)
        self.node("ShaderNodeOutputMaterial", shader)
