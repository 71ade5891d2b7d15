# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers of the checks: read meshes, render exact pixels, read reports."""

import os
import sys
import time
from dataclasses import replace

import addon_utils
import bpy
import leaflight
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from leaflight.scene.scene import Isosurfaces, core_scene
from leaflight_addon import versions
from leaflight_addon.operators import jobs
from leaflight_addon.show import whole_detail
from leaflight_addon.stage import camera, staleness
from leaflight_addon.store import cache
from mathutils import Vector


# Seconds after which another program hangs, whatever the machine.
HANG = 1800

# Name of the add-on's module in Blender.
ADDON = sys.modules["leaflight_addon"].__name__

_engines = bpy.types.RenderSettings.bl_rna.properties["engine"].enum_items
EEVEE = next((e for e in ("BLENDER_EEVEE", "BLENDER_EEVEE_NEXT") if e in _engines), None)

# Sockets of the Principled BSDF that have other names from 4.0 on.
_RENAMED = {
    "Specular": "Specular IOR Level",
    "Transmission": "Transmission Weight",
    "Subsurface": "Subsurface Weight",
    "Emission": "Emission Color",
}


def close(a, b, tolerance):
    np.testing.assert_allclose(np.asarray(a), np.asarray(b), rtol=0, atol=tolerance)


def mesh_arrays(obj):
    """Returns vertices (n, 3), triangles (m, 3) and radiance (n, 3) or None of an object's mesh."""
    mesh = obj.data
    vertices = vertices_of(obj)
    triangles = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", triangles)
    radiance = None
    if "radiance" in mesh.attributes:
        radiance = colors_of(obj)
    return vertices, triangles.reshape(-1, 3), radiance


def vertices_of(obj):
    """Returns the vertices (n, 3) of the mesh of an object."""
    vertices = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", vertices)
    return vertices.reshape(-1, 3)


def colors_of(obj, name="radiance"):
    """Returns linear RGB (n, 3) of a color attribute of the mesh of an object."""
    colors = np.empty(4 * len(obj.data.vertices), np.float32)
    obj.data.attributes[name].data.foreach_get("color", colors)
    return colors.reshape(-1, 4)[:, :3]


def expected_surface(obj, isovalue):
    """Returns the same three, computed by the core for the volume and the bake of an object."""
    field, bake = cache.volume_of(obj).field(), cache.bake_of(obj)
    if bake is None:
        vertices, _, triangles = leaflight._core.contour(field, isovalue)
        return vertices, triangles, None
    vertices, triangles = lit_mesh(obj, isovalue)
    return vertices, triangles, bake.radiance(to_world(obj, vertices))


def lit_mesh(obj, isovalue):
    """Returns (vertices, triangles) of the isosurface as the bake of an object lights it."""
    field, bake, grid = cache.volume_of(obj).field(), cache.bake_of(obj), cache.grid_of(obj)
    vertices, _, triangles, *_ = grid.lit_contour(
        field, isovalue, back=grid.has_back, largest_step=bake.largest_step
    )
    return vertices, triangles


def to_world(obj, points):
    """Returns points (n, 3) in the coordinates of an object, in world space."""
    matrix = np.array(obj.matrix_world, np.float64)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def in_frame(obj):
    """Returns positions of an isosurface's large parts in the camera's frame, and their
    distances.
    """
    scene = bpy.context.scene
    points = camera.shown_points([obj])
    return np.array([world_to_camera_view(scene, scene.camera, Vector(p)) for p in points])


def assert_shows(obj, isovalue):
    """Checks that the mesh is the core's isosurface with the core's radiance."""
    vertices, triangles, radiance = mesh_arrays(obj)
    expected_vertices, expected_triangles, expected_radiance = expected_surface(obj, isovalue)
    assert len(vertices) > 100
    np.testing.assert_array_equal(triangles, expected_triangles)
    close(vertices, expected_vertices, 1e-6)
    if expected_radiance is None:
        assert radiance is None
    else:
        close(radiance, expected_radiance, 1e-4 * expected_radiance.max())


def change(obj):
    """Returns why the bake of an object no longer fits the scene, without the cache."""
    staleness.forget()
    return staleness.change_since_bake(bpy.context, obj)


def edit_as_the_slider_does(obj, isovalue):
    """Changes the isovalue like a slider: sets the ID property and tags the object, without
    our Python.
    """
    obj.leaflight["isovalue"] = isovalue
    obj.update_tag()
    bpy.context.view_layer.update()


class Clock:
    """A replacement of the module time, whose seconds pass only when a check adds to them."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    perf_counter = monotonic


def tick():
    """Calls the timer of whole_detail as Blender's event loop would, by a Clock."""
    whole_detail.time.now += whole_detail.POLL
    return whole_detail._tick()


def rest():
    """Calls tick() until the work ends."""
    while tick() is not None:
        # Give the worker thread time.
        time.sleep(0.005)


# Work that start() has started in the current check.
_started = []


def start(job):
    """Starts a Job in a thread; returns the work, which ends with the check."""
    work = jobs.BackgroundWork(job)
    _started.append(work)
    return work


def end_all():
    """Cancels all work that was started, and waits for its end."""
    for work in _started:
        work.cancel()
        work.wait(None)
    _started.clear()


def wait_while(work, condition):
    """Waits while a condition holds; fails if the work ends before."""
    while condition():
        work.wait(0.01)
        if not work.is_alive() and condition():
            work.result()
            pytest.fail("The work has ended before what the check waits for.")


def error_of(operator, **arguments):
    """Returns the message of an operator that is cancelled or cannot run."""
    with pytest.raises(RuntimeError) as caught:
        operator(**arguments)
    return str(caught.value).strip().removeprefix("Error: ")


def imported_gltf(path, monkeypatch):
    """Returns the mesh object that Blender's own importer makes of a .glb, its linear colors
    (n, 3), and the vertex of each color.
    """
    if addon_utils.enable("io_scene_gltf2") is None:
        pytest.skip("this Blender has no importer of glTF")
    # Debian's importer needs an older NumPy.
    monkeypatch.setattr(np, "bool", bool, raising=False)
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=False)
    (obj,) = [obj for obj in set(bpy.data.objects) - before if obj.type == "MESH"]
    bpy.context.view_layer.update()
    colors = obj.data.color_attributes[0]
    values = np.empty(4 * len(colors.data), np.float32)
    colors.data.foreach_get("color", values)
    vertices = np.arange(len(colors.data))
    if colors.domain == "CORNER":
        obj.data.loops.foreach_get("vertex_index", vertices := np.empty(len(vertices), np.int32))
    return obj, values.reshape(-1, 4)[:, :3], vertices


def duplicate(obj, linked=False):
    """Duplicates an object alone, and returns the copy."""
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.duplicate(linked=linked)
    bpy.context.view_layer.update()
    return bpy.context.object


def add_camera(location, rotation, orthographic=None):
    """Adds a camera and looks through it; orthographic: width of its view."""
    data = bpy.data.cameras.new("Camera")
    if orthographic is not None:
        data.type = "ORTHO"
        data.ortho_scale = orthographic
    camera = bpy.data.objects.new("Camera", data)
    camera.location = location
    camera.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def require_eevee():
    """Returns the name of Eevee; skips the check if Eevee has no OpenGL."""
    if sys.platform == "win32" and "DISPLAY" not in os.environ:
        pytest.skip("Wine has OpenGL on a screen alone: run it by xvfb-run.")
    return EEVEE


def render_exr(path, engine="CYCLES", samples=1, size=48):
    """Returns linear pixels (size, size, 4), top row first; each pixel is sampled at its center."""
    scene = bpy.context.scene
    scene.render.engine = require_eevee() if engine == "EEVEE" else engine
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.filter_size = 0.0
    for name, value in versions.image_format(file_format="OPEN_EXR").items():
        setattr(scene.render.image_settings, name, value)
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Standard"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.light_sampling_threshold = 0.0
    scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.blur_glossy = 0.0
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        setattr(scene.cycles, name, 64)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.eevee.taa_render_samples = samples
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return leaflight._core.read_exr(str(path))


def build_probe(albedo):
    """Adds a tiny Lambertian square at the origin that faces up, in a black world, and a camera
    just above it.

    Put lights beside the camera, not above.
    """
    scene = bpy.context.scene
    scene.world = one_colored_world((0, 0, 0))
    bpy.ops.mesh.primitive_plane_add(size=0.002)
    probe = bpy.context.object
    probe.data.materials.append(constant_material("ShaderNodeBsdfDiffuse", Color=(*albedo, 1.0)))
    add_camera((0, 0, 0.1), (0, 0, 0), orthographic=0.001)
    return probe


def traced_probe(description, samples=1 << 19):
    """Returns the radiance (3,) of the probe, the first mesh, by the core's path tracer, and its
    standard error.
    """
    # A scene needs a volume, so put a black one far below the probe.
    values = np.zeros((4, 4, 4), np.float32)
    values[1:3, 1:3, 1:3] = 1.0
    matrix = np.diag([0.01, 0.01, 0.01, 1.0])
    matrix[2, 3] = -5.0
    description = replace(description, isosurfaces=[Isosurfaces("far", (0.0, 0.0, 0.0))])
    scene = core_scene(description, [leaflight._core.Field(values, matrix)], (0.1, 0.9))
    radiance, error = leaflight._core.reference_walls(
        scene, 0, [0], np.full((1, 2), 1 / 3), 0.5, samples
    )
    return radiance[0], error[0]


def rendered_probe(path, samples, seed=0):
    """Returns the radiance (3,) of the probe by Cycles."""
    bpy.context.view_layer.update()
    bpy.context.scene.cycles.seed = seed
    return render_exr(path, samples=samples, size=16)[..., :3].mean(axis=(0, 1))


def add_light(kind, location=(0, 0, 0), rotation=(0, 0, 0), **settings):
    """Returns a light object of the scene; settings: attributes of the light."""
    light = bpy.data.lights.new("Lamp", kind)
    for name, value in settings.items():
        setattr(light, name, value)
    obj = bpy.data.objects.new("Lamp", light)
    obj.location, obj.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(obj)
    return obj


def plain_material(name, color):
    """Returns a new diffuse material, without nodes if this Blender still supports that."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*color, 1.0)
    tree = versions.node_tree(material)
    for node in tree.nodes if tree else ():
        if node.type == "BSDF_PRINCIPLED":
            node.inputs["Base Color"].default_value = (*color, 1.0)
            node.inputs["Specular IOR Level"].default_value = 0.0
    return material


def one_colored_world(color, name="World"):
    """Returns a new world of one color, without nodes if this Blender still supports that."""
    world = bpy.data.worlds.new(name)
    world.color = color
    tree = versions.node_tree(world)
    for node in tree.nodes if tree else ():
        if node.type == "BACKGROUND":
            node.inputs["Color"].default_value = (*color, 1.0)
    return world


def constant_material(kind, **inputs):
    """Returns a material of one shader node of this type, with its inputs by name."""
    material = bpy.data.materials.new("Material")
    nodes = versions.give_nodes(material).nodes
    nodes.clear()
    shader, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    for name, value in inputs.items():
        name = name if name in shader.inputs else _RENAMED[name]
        shader.inputs[name].default_value = value
    material.node_tree.links.new(shader.outputs[0], output.inputs[0])
    return material


def noise_image(width, height):
    """Returns a float image of random colors, always the same."""
    return _image(np.random.default_rng(0).random((height, width, 3)), True)


def smooth_image(width, height):
    """Returns an 8-bit image that is smooth, also across its border.

    Cycles interpolates 8-bit colors before it decodes them.
    """
    y, x = np.mgrid[:height, :width] / np.array([height, width]).reshape(2, 1, 1)
    waves = [
        np.cos(2 * np.pi * (k * x - k * y + phase)) for k, phase in ((1, 0), (1, 0.4), (2, 0.7))
    ]
    return _image(0.5 + 0.4 * np.stack(waves, axis=-1), False)


def _image(colors, is_float):
    height, width, _ = colors.shape
    image = bpy.data.images.new("Picture", width, height, float_buffer=is_float)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = colors
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def camera_rays_down(width, size):
    """Returns world x and y of the pixels of an orthographic camera above, top row first."""
    center = (np.arange(size) + 0.5) / size - 0.5
    return np.meshgrid(width * center, -width * center)


def look_down(height, width):
    return add_camera((0.0, 0.0, height), (0.0, 0.0, 0.0), orthographic=width)


def displayed_gray(shares):
    """Returns the linear gray, interpolated between nine samples, of displayed gray levels 0..1."""
    shown = np.linspace(0.0, 1.0, 9)
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return np.interp(shares, shown, linear)


def texels_at(bake, points, name="radiance"):
    """Returns the positions at which the shader blends eight active texels, and the blended
    values.
    """
    texels = np.array(bake.grid.resolution)
    nodes = np.array(bake.volume.values.shape[::-1])
    inverse = np.linalg.inv(bake.volume.index_to_world)
    index = points @ inverse[:3, :3].T + inverse[:3, 3]
    position = index * (texels - 1) / (nodes - 1)
    low = np.floor(position).astype(int)
    inside = np.all((low >= 0) & (low <= texels - 2), axis=1)
    low = np.clip(low, 0, texels - 2)
    share = position - low
    active, dense = bake.grid.mask().astype(bool), bake.grid.dense(name)
    radiance = np.zeros((len(points), 3))
    for corner in range(8):
        bits = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        i, j, k = (low + bits).T
        # Next to a texel, closest lookups may be rounded to either side.
        inside &= active[k, j, i]
        weight = np.where(bits, share, 1 - share).prod(axis=1)
        radiance += weight[:, None] * dense[k, j, i]
    return inside, radiance
