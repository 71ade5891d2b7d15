# SPDX-License-Identifier: GPL-3.0-or-later
"""The node tree of a material of isosurfaces, and which parts of the surface it shows."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import versions

# Names of the nodes whose values change without a build: how opaque the surface is; what gives
# baked radiance another albedo; how strong and how rough the coat is.
OPACITY, RECOLOR, GLOSS, COAT = "opacity", "recolor", "gloss", "coat"


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
    """What of a surface is seen.

    is_translucent: whether what lies behind it shows through; lies_among: whether other such
    surfaces do, or it through them; cut: a Cut or None; is_glossy: whether it has a coat, which
    the scene's own lamps light.
    """

    is_translucent: bool = False
    lies_among: bool = False
    cut: object = None
    is_glossy: bool = False


class Graph:
    """Builds the node tree of a material from scratch."""

    def __init__(self, material, view=View()):
        self._view, self._hides_back = view, False
        self._material = material
        versions.let_through(material, view.is_translucent, view.lies_among, view.cut is not None)
        self.tree = versions.give_nodes(material)
        self.tree.nodes.clear()

    def node(self, kind):
        node = self.tree.nodes.new(kind)
        node.location = (200 * (len(self.tree.nodes) // 12), -160 * (len(self.tree.nodes) % 12))
        node.hide = True
        return node

    def connect(self, value, socket):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, *values):
        node = self.node("ShaderNodeMath")
        node.operation = operation
        for value, socket in zip(values, node.inputs):
            self.connect(value, socket)
        return node.outputs[0]

    def vector(self, operation, *values):
        node = self.node("ShaderNodeVectorMath")
        node.operation = operation
        for value, socket in zip(values, node.inputs):
            self.connect(value, socket)
        return node.outputs["Vector"]

    def dot(self, vector, constant):
        node = self.node("ShaderNodeVectorMath")
        node.operation = "DOT_PRODUCT"
        self.connect(vector, node.inputs[0])
        node.inputs[1].default_value = constant
        return node.outputs["Value"]

    def combine(self, x, y):
        node = self.node("ShaderNodeCombineXYZ")
        self.connect(x, node.inputs[0])
        self.connect(y, node.inputs[1])
        return node.outputs[0]

    def texel(self, image, position):
        node = self.node("ShaderNodeTexImage")
        node.image = image
        node.interpolation = "Closest"
        node.extension = "EXTEND"
        self.connect(position, node.inputs[0])
        return node.outputs[0]

    def mix(self, a, b, weight):
        """a + weight * (b - a)."""
        difference = self.vector("SUBTRACT", b, a)
        splat = self.node("ShaderNodeCombineXYZ")
        for socket in splat.inputs:
            self.connect(weight, socket)
        return self.vector("MULTIPLY_ADD", difference, splat.outputs[0], a)

    def attribute(self, name):
        node = self.node("ShaderNodeAttribute")
        node.attribute_name = name
        return node.outputs["Color"]

    def lambertian(self):
        return self.node("ShaderNodeBsdfDiffuse").outputs[0]

    def reflecting(self, scattering, ior):
        if scattering == "DIFFUSE":
            return self.lambertian()
        kind = "ShaderNodeBsdfGlass" if scattering == "GLASS" else "ShaderNodeBsdfGlossy"
        node = self.node(kind)
        for socket in node.inputs:
            if socket.identifier in {"Roughness", "IOR"}:
                socket.default_value = ior if socket.identifier == "IOR" else 0.0
        return node.outputs[0]

    def emission(self, colour):
        """Emission of a colour (r, g, b) without bounds, or of a socket."""
        node = self.node("ShaderNodeEmission")
        if isinstance(colour, bpy.types.NodeSocket):
            self.connect(colour, node.inputs[0])
        else:
            strength = max(colour)
            node.inputs[0].default_value = (*(x / strength for x in colour), 1.0)
            node.inputs[1].default_value = strength
        return node.outputs[0]

    def sum(self, a, b):
        node = self.node("ShaderNodeAddShader")
        self.connect(a, node.inputs[0])
        self.connect(b, node.inputs[1])
        return node.outputs[0]

    def backfacing(self):
        geometry = self.node("ShaderNodeNewGeometry")
        return next(s for s in geometry.outputs if s.identifier == "Backfacing")

    def recolored(self, radiance):
        node = self.node("ShaderNodeVectorMath")
        node.name, node.operation = RECOLOR, "MULTIPLY_ADD"
        self.connect(radiance, node.inputs[0])
        node.inputs[1].default_value, node.inputs[2].default_value = (1, 1, 1), (0, 0, 0)
        return node.outputs["Vector"]

    def emit_sides(self, front, back=None):
        """Emission of one colour on each side; without the back, the Lambertian isosurface
        there.

        Where others show through, nothing is there: who looks at the front of a surface does
        not look for the back behind it.
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
        node = self.node("ShaderNodeMixShader")
        for value, socket in zip((weight, a, b), node.inputs):
            self.connect(value, socket)
        return node.outputs[0]

    def coated(self, shader):
        """A clear coat over it, whose reflectance is Schlick's (1994) for an index of 1.8."""
        facing = self.node("ShaderNodeLayerWeight")
        facing.inputs["Blend"].default_value = 0.5
        grazing = self.math("POWER", facing.outputs["Facing"], 5.0)
        reflectance = self.math("MULTIPLY_ADD", grazing, 0.92, 0.08)
        gloss = self.node("ShaderNodeValue")
        gloss.name = GLOSS
        coat = self.node("ShaderNodeBsdfGlossy")
        coat.name = COAT
        coat.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        weight = self.math("MULTIPLY", reflectance, gloss.outputs[0])
        return self.mix_shaders(weight, shader, coat.outputs[0])

    def inside(self, cut):
        """1 within the box of a Cut, else 0."""
        coordinates = self.node("ShaderNodeTexCoord")
        coordinates.object = cut.box
        position = next(s for s in coordinates.outputs if s.identifier == "Object")
        low, high = np.array(cut.low), np.array(cut.high)
        half = np.maximum(0.5 * (high - low), 1e-6)
        part = self.vector("SUBTRACT", position, tuple(0.5 * (low + high)))
        part = self.vector("ABSOLUTE", self.vector("DIVIDE", part, tuple(half)))
        separate = self.node("ShaderNodeSeparateXYZ")
        self.connect(part, separate.inputs[0])
        x, y, z = separate.outputs
        return self.math("LESS_THAN", self.math("MAXIMUM", self.math("MAXIMUM", x, y), z), 1.0)

    def seen(self):
        """How much of the surface is seen, 0..1: a socket, or None where that is all of it."""
        factors = []
        if self._view.is_translucent:
            opacity = self.node("ShaderNodeValue")
            opacity.name = OPACITY
            factors.append(opacity.outputs[0])
        if self._hides_back:
            factors.append(self.math("SUBTRACT", 1.0, self.backfacing()))
        if self._view.cut is not None:
            inside = self.inside(self._view.cut)
            keeps = self._view.cut.keeps_inside
            factors.append(inside if keeps else self.math("SUBTRACT", 1.0, inside))
        if not factors:
            return None
        seen = factors[0]
        for factor in factors[1:]:
            seen = self.math("MULTIPLY", seen, factor)
        return seen

    def finish(self, shader):
        if self._view.is_glossy:
            shader = self.coated(shader)
        # For Eevee, whose nearest layer it shall not be.
        self._material.use_backface_culling = self._hides_back
        seen = self.seen()
        if seen is not None:
            nothing = self.node("ShaderNodeBsdfTransparent").outputs[0]
            shader = self.mix_shaders(seen, nothing, shader)
        output = self.node("ShaderNodeOutputMaterial")
        self.tree.links.new(shader, output.inputs[0])
