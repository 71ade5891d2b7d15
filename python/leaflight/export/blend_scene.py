# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the scene of a .blend in a background Blender from 5.0 on, and saves it.

blend.py starts it: `blender -b --python blend_scene.py -- FOLDER`. It reads FOLDER/scene.npz, where
"settings" is JSON. If the Blender is too old, it writes its version to FOLDER/version.

The modifier of a Volume object makes the isosurface by Geometry Nodes: Grid to Mesh, with the light
of Sample Grid at its vertices. Light sampled in front of the isosurface is worse
(docs/decisions/export.md).
"""

import json
import math
import os
import runpy
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

# Load the file by its path, because this Blender may not have the package.
cycles = SimpleNamespace(
    **runpy.run_path(str(Path(__file__).parents[1] / "measure" / "cycles_scene.py"))
)

# Attributes of vertices. Walls read the isovalue there.
FRONT, BACK, ISOVALUE = "radiance", "radiance_back", "isovalue"
_MODIFIER = "Leaflight"
# Width of the border of the voxels, in voxels, where the vertices of caps lie.
_RIM = 0.01


class Nodes:
    """Adds nodes to a tree of Geometry Nodes."""

    def __init__(self, name: str) -> None:
        self.tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        self.tree.is_modifier = True
        for way in ("OUTPUT", "INPUT"):
            self.socket("Geometry", way, "NodeSocketGeometry")

    def socket(self, name: str, way: str, kind: str) -> Any:
        """Returns a new input or output of the whole tree."""
        return self.tree.interface.new_socket(name, in_out=way, socket_type=kind)

    def __call__(
        self, kind: str, *sockets: Any, named: Mapping[str, Any] = {}, **properties: Any
    ) -> Any:
        """Returns the outputs of a new node. sockets: values or outputs for its first inputs."""
        node = self.tree.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for where, value in (*enumerate(sockets), *named.items()):
            socket = node.inputs[where]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node.outputs

    def math(self, operation: str, *values: Any) -> Any:
        return self("ShaderNodeMath", *values, operation=operation)[0]

    def mixed(self, **named: Any) -> Any:
        """Returns a mix of two vectors. named: inputs of the node Mix by identifier."""
        outputs = self("ShaderNodeMix", data_type="VECTOR")
        node = outputs[0].node
        for socket in node.inputs:
            if socket.identifier in named:
                self.tree.links.new(named[socket.identifier], socket)
        return next(socket for socket in outputs if socket.identifier == "Result_Vector")

    def stored(self, geometry: Any, name: str, value: Any, kind: str = "FLOAT_VECTOR") -> Any:
        """Returns the geometry with a value at each vertex."""
        return self(
            "GeometryNodeStoreNamedAttribute",
            geometry,
            named={"Name": name, "Value": value},
            data_type=kind,
            domain="POINT",
        )[0]

    def finish(self, geometry: Any) -> None:
        self("NodeGroupOutput", geometry)
        for place, node in enumerate(self.tree.nodes):
            node.location = (220 * (place % 6), -260 * (place // 6))


def main(folder: Path) -> None:
    if bpy.app.version < (5, 0, 0):
        (folder / "version").write_text(bpy.app.version_string)
        sys.exit("This Blender is too old.")
    with np.load(folder / "scene.npz") as file:
        arrays = dict(file)
    settings = json.loads(str(arrays.pop("settings")))
    bpy.data.batch_remove(bpy.data.objects[:])
    scene = bpy.context.scene
    shown = _isosurface(scene, settings)
    _walls(scene, settings, arrays, shown)
    for light in settings["lights"]:
        cycles._light(scene, light)
    cycles._world(scene, settings["environment"], arrays.get("environment"))
    _show(scene, settings)
    shown.select_set(True)
    bpy.context.view_layer.objects.active = shown
    bpy.ops.wm.save_as_mainfile(filepath=settings["out"], compress=True, relative_remap=False)
    if not bpy.app.binary_path:
        # The normal end of the module bpy may crash.
        sys.stdout.flush()
        os._exit(0)


def _isosurface(scene: bpy.types.Scene, settings: Mapping[str, Any]) -> bpy.types.Object:
    """Adds the Volume object whose modifier makes the lit isosurface."""
    volume = bpy.data.volumes.new(settings["name"])
    volume.filepath = f"//{settings['grids']}"
    obj = bpy.data.objects.new(settings["name"], volume)
    scene.collection.objects.link(obj)
    nodes = Nodes("Leaflight Isosurface")
    slider = nodes.socket("Isovalue", "INPUT", "NodeSocketFloat")
    slider.subtype = "FACTOR"  # drawn as a slider over the whole range
    slider.min_value, slider.max_value = settings["range"]
    slider.default_value = settings["isovalue"]
    geometry, isovalue = nodes("NodeGroupInput")[:2]

    def grid(name: str, kind: str) -> Any:
        named = {"Name": settings[name], "Remove": False}
        return nodes("GeometryNodeGetNamedGrid", geometry, named=named, data_type=kind)["Grid"]

    values = grid("values", "FLOAT")
    mesh = nodes("GeometryNodeGridToMesh", values, isovalue)[0]
    place = nodes("GeometryNodeInputPosition")[0]
    mesh = _without_caps(nodes, values, mesh, place, settings["voxels"])
    for attribute, name in ((FRONT, "radiance"), (BACK, "back")):
        if settings[name]:
            light = nodes(
                "GeometryNodeSampleGrid", grid(name, "VECTOR"), place, data_type="VECTOR"
            )[0]
            mesh = nodes.stored(mesh, attribute, light)
    mesh = nodes.stored(mesh, ISOVALUE, isovalue, "FLOAT")
    smooth = nodes("GeometryNodeSetShadeSmooth", mesh)[0]
    material = _emitting(settings["name"], bool(settings["back"]), settings["albedo"])
    nodes.finish(nodes("GeometryNodeSetMaterial", smooth, named={"Material": material})[0])
    obj.modifiers.new(_MODIFIER, "NODES").node_group = nodes.tree
    return obj


def _without_caps(nodes: Nodes, values: Any, mesh: Any, place: Any, voxels: Sequence[int]) -> Any:
    """Returns the mesh without the caps that Grid to Mesh puts at the border of the voxels."""
    inverse = nodes("FunctionNodeInvertMatrix", nodes("GeometryNodeGridInfo", values)["Transform"])
    index = nodes("FunctionNodeTransformPoint", place, inverse[0])[0]
    first, last = (_RIM,) * 3, [each - 1.0 - _RIM for each in voxels]
    above = nodes("ShaderNodeVectorMath", index, first, operation="MAXIMUM")[0]
    inside = nodes("ShaderNodeVectorMath", above, last, operation="MINIMUM")[0]
    outside = nodes("ShaderNodeVectorMath", index, inside, operation="DISTANCE")["Value"]
    far = nodes.math("GREATER_THAN", outside, 0.0)
    return nodes("GeometryNodeDeleteGeometry", mesh, far, domain="POINT")[0]


def _walls(
    scene: bpy.types.Scene,
    settings: Mapping[str, Any],
    arrays: Mapping[str, Array],
    shown: bpy.types.Object,
) -> None:
    """Adds the walls: with baked light by isovalue, or as reflecting objects."""
    tree = None
    for number, item in enumerate(settings["objects"]):
        wall = cycles._object(scene, item, cycles._arrays_of(arrays, f"object{number}."))
        light = arrays.get(f"light{number}")
        if light is None:
            continue
        for name, levels in zip((FRONT, BACK), light):
            for level, radiance in enumerate(levels):
                attribute = wall.data.attributes.new(f"{name} {level}", "FLOAT_VECTOR", "POINT")
                attribute.data.foreach_set("vector", radiance.ravel())
        wall.data.materials[0] = _emitting(item["name"], True, item["albedo"])
        tree = tree or _wall_nodes(settings, light.shape[1], shown)
        wall.modifiers.new(_MODIFIER, "NODES").node_group = tree


def _wall_nodes(
    settings: Mapping[str, Any], levels: int, shown: bpy.types.Object
) -> bpy.types.NodeTree:
    """Returns nodes that mix the light of the two levels nearest to the isovalue.

    They read it from the isosurface, because a driver from its modifier would lag by a frame.
    """
    nodes = Nodes("Leaflight Wall")
    info = nodes("GeometryNodeObjectInfo", shown)["Geometry"]
    each = nodes("GeometryNodeInputNamedAttribute", ISOVALUE, data_type="FLOAT")[0]
    isovalue = nodes("GeometryNodeSampleIndex", info, each, data_type="FLOAT", domain="POINT")[0]
    low, high = settings["range"]
    scale = (levels - 1) / (high - low)
    level = nodes.math("MULTIPLY_ADD", isovalue, scale, -low * scale)
    level = nodes.math("MINIMUM", nodes.math("MAXIMUM", level, 0.0), levels - 1.0)
    below = nodes.math("MINIMUM", nodes.math("FLOOR", level), levels - 2.0)
    share = nodes.math("SUBTRACT", level, below)
    geometry = nodes("NodeGroupInput")[0]
    for name in (FRONT, BACK):
        lights = []
        for number in (below, nodes.math("ADD", below, 1.0)):
            text = nodes("FunctionNodeValueToString", number)[0]
            label = nodes("FunctionNodeReplaceString", f"{name} #", "#", text)[0]
            lights.append(
                nodes("GeometryNodeInputNamedAttribute", label, data_type="FLOAT_VECTOR")[0]
            )
        named = {"Factor_Float": share, "A_Vector": lights[0], "B_Vector": lights[1]}
        geometry = nodes.stored(geometry, name, nodes.mixed(**named))
    nodes.finish(geometry)
    return nodes.tree


def _emitting(name: str, back: bool, albedo: Sequence[float]) -> bpy.types.Material:
    """Returns a material that emits the light at the vertices. back: whether its back has some."""
    material = bpy.data.materials.new(name)
    tree = cycles.versions.give_nodes(material)
    tree.nodes.clear()
    new, link = tree.nodes.new, tree.links.new

    def emission(attribute: str) -> Any:
        source, node = new("ShaderNodeAttribute"), new("ShaderNodeEmission")
        source.attribute_name = attribute
        link(source.outputs["Color"], node.inputs["Color"])
        return node

    if back:
        behind = emission(BACK)
    else:
        behind = new("ShaderNodeBsdfDiffuse")
        behind.inputs["Color"].default_value = (*albedo, 1.0)
    mix, side = new("ShaderNodeMixShader"), new("ShaderNodeNewGeometry")
    link(side.outputs["Backfacing"], mix.inputs[0])
    link(emission(FRONT).outputs[0], mix.inputs[1])
    link(behind.outputs[0], mix.inputs[2])
    link(mix.outputs[0], new("ShaderNodeOutputMaterial").inputs["Surface"])
    for place, node in enumerate(tree.nodes):
        node.location = (220 * place, 0)
    return material


def _show(scene: bpy.types.Scene, settings: Mapping[str, Any]) -> None:
    """Adds the camera, and shows its view in all viewports as a render."""
    right, up, forward, position, target, angle = settings["camera"]
    data = bpy.data.cameras.new("Camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(angle)
    distance = math.dist(position, target)
    data.clip_start, data.clip_end = 0.01 * distance, 100.0 * distance
    camera = bpy.data.objects.new("Camera", data)
    axes = mathutils.Matrix(np.array([right, up, np.negative(forward)]).T.tolist()).to_4x4()
    camera.matrix_world = mathutils.Matrix.Translation(position) @ axes
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = settings["size"]
    # Colors are those of leaflight still.
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = math.log2(settings["exposure"])
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                space = area.spaces.active
                space.shading.type = "RENDERED"
                space.region_3d.view_perspective = "CAMERA"
                space.clip_start, space.clip_end = data.clip_start, data.clip_end


if __name__ == "__main__":
    main(Path(sys.argv[-1]))
