# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a scene in a background Blender and measures light on one of its meshes by Cycles.

cycles.py starts it: `blender -b --factory-startup --python cycles_scene.py -- FOLDER`. It reads
FOLDER/scene.npz, where "settings" is JSON (see cycles.py). It writes FOLDER/radiance.npy, float32
[pass, probe, RGB] in W/(m^2 sr). It also writes FOLDER/costs.npy, float64 [pass, 3]: wall-clock
seconds, processor seconds, and peak memory in bytes.

Cycles bakes COMBINED into an image, one pixel for each probe. Baking into a color attribute gives
the same values at every corner of every triangle, about six times per vertex. That is the way of
users, so the report compares with it; its probes are the vertices.
"""

import json
import math
import runpy
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import bpy
import mathutils
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from leaflight.measure.blender_versions import LightUnits

Array = NDArray[Any]

# Load the file by its path, because this Blender may not have the package.
versions = SimpleNamespace(**runpy.run_path(str(Path(__file__).with_name("blender_versions.py"))))

# Disable limits on paths and all options that trade noise for bias.
UNBIASED = {
    "max_bounces": 1024,
    "diffuse_bounces": 1024,
    "glossy_bounces": 1024,
    "transmission_bounces": 1024,
    "transparent_max_bounces": 1024,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "light_sampling_threshold": 0.0,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "blur_glossy": 0.0,
    "use_fast_gi": False,
    "use_denoising": False,
    "use_adaptive_sampling": False,
}
PASSES = {"DIRECT", "INDIRECT", "DIFFUSE", "GLOSSY", "TRANSMISSION", "EMIT"}


def main(folder: Path) -> None:
    with np.load(folder / "scene.npz") as file:
        arrays = dict(file)
    settings = json.loads(str(arrays.pop("settings")))
    scene = _empty_scene(settings["threads"])
    objects = [
        _object(scene, item, _arrays_of(arrays, f"object{i}."))
        for i, item in enumerate(settings["objects"])
    ]
    for light in settings["lights"]:
        _light(scene, light)
    _world(scene, settings["environment"], arrays.get("environment"))
    if settings["image_size"] is None:
        # Disable tiles. A row of all corners of a mesh would be cut into thousands of them, and
        # each is written to a file by one thread.
        scene.cycles.use_auto_tile = False
    target = _Target(objects[settings["target"]], settings["image_size"], arrays.get("pixels"))
    radiance, costs = [], []
    for samples, seed in settings["passes"]:
        scene.cycles.seed = seed
        scene.cycles.samples = samples
        start = np.array([time.perf_counter(), time.process_time()])
        target.bake()
        seconds = np.array([time.perf_counter(), time.process_time()]) - start
        radiance.append(target.read())
        costs.append((*seconds, _peak_memory()))
        print(f"leaflight pass {len(radiance)}", flush=True)
    np.save(folder / "costs.npy", np.array(costs))
    np.save(folder / "radiance.npy", np.array(radiance))


def _peak_memory() -> float:
    """Returns the peak memory of this process in bytes; NaN on Windows."""
    try:
        import resource
    except ImportError:
        return math.nan
    # Linux counts in KiB.
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def _arrays_of(arrays: Mapping[str, Array], prefix: str) -> dict[str, Array]:
    return {key[len(prefix) :]: value for key, value in arrays.items() if key.startswith(prefix)}


def _empty_scene(threads: int) -> bpy.types.Scene:
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "FIXED" if threads else "AUTO"
    if threads:
        scene.render.threads = threads
    for name, value in UNBIASED.items():
        setattr(scene.cycles, name, value)
    return scene


def _object(
    scene: bpy.types.Scene, item: dict[str, Any], arrays: Mapping[str, Array]
) -> bpy.types.Object:
    """Creates an object of a mesh: smooth if it has normals, else flat."""
    mesh = _filled_mesh(item["name"], arrays["vertices"], arrays["triangles"])
    smooth = "normals" in arrays and len(mesh.polygons) > 0
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), smooth))
    if smooth:
        versions.set_normals(mesh, arrays["normals"].tolist())
    for name in ("uv", "target_uv"):
        if name in arrays:
            mesh.uv_layers.new(name=name).data.foreach_set("uv", arrays[name].ravel())
    if "colors" in arrays:
        rgba = np.ones((len(mesh.vertices), 4), np.float32)
        rgba[:, :3] = arrays["colors"]
        mesh.attributes.new("colors", "FLOAT_COLOR", "POINT").data.foreach_set(
            "color", rgba.ravel()
        )
    mesh.materials.append(_material(item, arrays.get("texture"), "colors" in arrays))
    obj = bpy.data.objects.new(item["name"], mesh)
    scene.collection.objects.link(obj)
    # Cast shadows from the triangles, without a shift towards the smooth surface.
    obj.cycles.shadow_terminator_geometry_offset = 0.0
    obj.cycles.shadow_terminator_offset = 0.0
    return obj


def _filled_mesh(name: str, vertices: Array, triangles: Array) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    if len(triangles):
        versions.set_loop_starts(mesh, np.arange(0, triangles.size, 3), 3)
    mesh.update(calc_edges=True)
    return mesh


def _material(item: dict[str, Any], texture: Array | None, has_colors: bool) -> bpy.types.Material:
    material = bpy.data.materials.new(item["name"])
    tree = versions.give_nodes(material)
    tree.nodes.clear()
    bsdf = tree.nodes.new(
        {
            "diffuse": "ShaderNodeBsdfDiffuse",
            "mirror": "ShaderNodeBsdfGlossy",
            "glass": "ShaderNodeBsdfGlass",
        }[item["scattering"]]
    )
    if item["scattering"] == "diffuse":
        bsdf.inputs["Roughness"].default_value = 0.0
    else:
        versions.polish(bsdf)
    if item["scattering"] == "glass":
        bsdf.inputs["IOR"].default_value = item["ior"]
    bsdf.inputs["Color"].default_value = (*item["albedo"], 1.0)
    if texture is not None:
        _texture(tree, bsdf.inputs["Color"], texture * np.float32(item["albedo"]))
    if has_colors:
        colors = tree.nodes.new("ShaderNodeAttribute")
        colors.attribute_name = "colors"
        tree.links.new(colors.outputs["Color"], bsdf.inputs["Color"])
    shader = bsdf.outputs[0]
    if max(item["emission"]) > 0:
        emission = tree.nodes.new("ShaderNodeEmission")
        _set_light(emission, item["emission"])
        both = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(shader, both.inputs[0])
        tree.links.new(emission.outputs[0], both.inputs[1])
        shader = both.outputs[0]
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader, output.inputs["Surface"])
    return material


def _texture(tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket, pixels: Array) -> None:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = _image("texture", pixels)
    node.interpolation = "Linear"
    node.extension = "REPEAT"
    uv = tree.nodes.new("ShaderNodeUVMap")
    uv.uv_map = "uv"
    tree.links.new(uv.outputs["UV"], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], socket)


def _image(name: str, pixels: Array) -> bpy.types.Image:
    """Creates an image of linear colors, float32 [row, column, RGB], bottom row first."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
    image.use_half_precision = False
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.pack()
    return image


def _set_light(node: bpy.types.Node, radiance: Sequence[float]) -> None:
    """Sets color and strength of an Emission or a Background node."""
    strongest = max(radiance)
    node.inputs["Color"].default_value = (*(x / strongest for x in radiance), 1.0)
    node.inputs["Strength"].default_value = strongest


def _units() -> "LightUnits":
    units: LightUnits = versions.light_units(bpy.app.version)
    return units


def _light(scene: bpy.types.Scene, item: dict[str, Any]) -> None:
    maker = {"AreaLight": _area_light, "PointLight": _point_light, "SunLight": _sun_light}
    obj = maker[item["type"]](item)
    obj.data.cycles.use_multiple_importance_sampling = True
    scene.collection.objects.link(obj)


def _area_light(item: dict[str, Any]) -> bpy.types.Object:
    u, v = np.array(item["edge_u"]), np.array(item["edge_v"])
    light = bpy.data.lights.new(item["name"], "AREA")
    light.shape = "ELLIPSE" if item["ellipse"] else "RECTANGLE"
    light.size, light.size_y = np.linalg.norm(u), np.linalg.norm(v)
    area = light.size * light.size_y * (0.25 * math.pi if item["ellipse"] else 1.0)
    _set_energy(light, item["radiance"], area / _units().area)
    # The local axes are u, -v and -(u x v), because an area light shines along its local -Z.
    return _placed(light, np.array(item["corner"]) + 0.5 * (u + v), u, -v)


def _point_light(item: dict[str, Any]) -> bpy.types.Object:
    cone = item["cone"]
    light = bpy.data.lights.new(item["name"], "SPOT" if cone else "POINT")
    light.shadow_soft_size = item["radius"]
    _set_energy(light, item["intensity"], 4.0 * math.pi)
    if not cone:
        return _placed(light, item["position"], (1, 0, 0), (0, 1, 0))
    light.spot_size, light.spot_blend = cone["angle"], cone["blend"]
    fades = _units().spot_cosine
    if cone["cosine_falloff"] != fades:
        _correct_fading(light, cone["axis"], fades)
    axis = np.array(cone["axis"])
    beside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return _placed(light, item["position"], beside, np.cross(beside, axis))


def _correct_fading(light: bpy.types.Light, axis: Sequence[float], fades: bool) -> None:
    """Adds or removes the fading of a spot by the cosine to its axis.

    Versions of Blender differ in it.
    """
    tree = versions.give_nodes(light)
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    cosine = tree.nodes.new("ShaderNodeVectorMath")
    cosine.operation = "DOT_PRODUCT"
    cosine.inputs[1].default_value = axis
    tree.links.new(geometry.outputs["Incoming"], cosine.inputs[0])
    strength = tree.nodes.new("ShaderNodeMath")
    strength.operation = "POWER"
    strength.inputs[1].default_value = -1.0 if fades else 1.0
    absolute = tree.nodes.new("ShaderNodeMath")
    absolute.operation = "ABSOLUTE"
    tree.links.new(cosine.outputs["Value"], absolute.inputs[0])
    tree.links.new(absolute.outputs[0], strength.inputs[0])
    tree.links.new(strength.outputs[0], emission.inputs["Strength"])


def _sun_light(item: dict[str, Any]) -> bpy.types.Object:
    light = bpy.data.lights.new(item["name"], "SUN")
    light.angle = item["angle"]
    _set_energy(light, item["irradiance"], 1.0 / _units().sun(item["angle"]))
    direction = np.array(item["direction"])
    beside = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    return _placed(light, (0, 0, 0), beside, np.cross(beside, direction))


def _set_energy(light: bpy.types.Light, amount: Sequence[float], factor: float) -> None:
    strongest = max(amount)
    light.color = [x / strongest if strongest else 0.0 for x in amount]
    light.energy = strongest * factor


def _placed(
    light: bpy.types.Light, position: ArrayLike, x: ArrayLike, y: ArrayLike
) -> bpy.types.Object:
    """Creates an object with local X and Y along two perpendicular vectors."""
    u, v = np.array(x) / np.linalg.norm(x), np.array(y) / np.linalg.norm(y)
    obj = bpy.data.objects.new(light.name, light)
    rotation = mathutils.Matrix(np.array([u, v, np.cross(u, v)]).T.tolist()).to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(position) @ rotation
    return obj


def _world(scene: bpy.types.Scene, item: dict[str, Any] | None, pixels: Array | None) -> None:
    scene.world = bpy.data.worlds.new("world")
    tree = versions.give_nodes(scene.world)
    tree.nodes.clear()
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    if item is None or not max(item["radiance"]) > 0:
        return
    if pixels is None:
        _set_light(background, item["radiance"])
        return
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = _image("environment", pixels * np.float32(item["radiance"]))
    node.interpolation = "Linear"
    tree.links.new(_turned(tree, item["world_to_image"]), node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], background.inputs["Color"])


def _turned(tree: bpy.types.NodeTree, matrix: Sequence[Sequence[float]]) -> bpy.types.NodeSocket:
    """Returns the socket of the view direction, rotated by a matrix (3 x 3)."""
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    combined = tree.nodes.new("ShaderNodeCombineXYZ")
    for row, socket in zip(matrix, combined.inputs):
        dot = tree.nodes.new("ShaderNodeVectorMath")
        dot.operation = "DOT_PRODUCT"
        dot.inputs[1].default_value = row
        tree.links.new(direction, dot.inputs[0])
        tree.links.new(dot.outputs["Value"], socket)
    return combined.outputs[0]


class _Target:
    """The target of baking: pixels of an image, or the object's vertices.

    The UV map target_uv of the object's mesh gives the pixels.
    """

    def __init__(
        self, obj: bpy.types.Object, size: tuple[int, int] | None, pixels: Array | None
    ) -> None:
        self._mesh, self._pixels = obj.data, pixels
        self._image = None if size is None else _target_image(obj, size)
        if self._image is None:
            self._mesh.color_attributes.new("target", "FLOAT_COLOR", "POINT")
            self._mesh.attributes.active_color = self._mesh.color_attributes["target"]
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj

    def bake(self) -> None:
        kind = "VERTEX_COLORS" if self._image is None else "IMAGE_TEXTURES"
        bpy.ops.object.bake(
            type="COMBINED", pass_filter=PASSES, target=kind, margin=0, use_clear=True
        )

    def read(self) -> Array:
        """Returns radiance, float32 [probe, RGB]."""
        if self._image is None:
            colors = np.empty(4 * len(self._mesh.vertices), np.float32)
            self._mesh.color_attributes["target"].data.foreach_get("color", colors)
            return colors.reshape(-1, 4)[:, :3]
        baked = np.empty(4 * self._image.size[0] * self._image.size[1], np.float32)
        self._image.pixels.foreach_get(baked)
        return baked.reshape(-1, 4)[self._pixels, :3]


def _target_image(obj: bpy.types.Object, size: tuple[int, int]) -> bpy.types.Image:
    """Creates an image that the object's material names as the target of baking."""
    image = bpy.data.images.new("target", *size, float_buffer=True, is_data=True)
    obj.data.uv_layers.active = obj.data.uv_layers["target_uv"]
    nodes = obj.data.materials[0].node_tree.nodes
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    nodes.active = node
    return image


if __name__ == "__main__":
    main(Path(sys.argv[-1]))
