# SPDX-License-Identifier: GPL-3.0-or-later
"""Show Photon Map: the photons on all isosurfaces as a point cloud."""

import bpy
import numpy as np
from leaflight import LeaflightError
from leaflight.bake.photons import trace_photons

from .. import versions
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..props import EnumProperty, FloatProperty, IntProperty
from ..show import display, fill, isovalues, shader
from ..stage import nodes, scene_export
from ..store import cache

# Attributes of the points: color, common isovalue, and True if a photon came straight from a light.
FLUX, COMMON_ISOVALUE, DIRECT = "flux", "common_isovalue", "direct"

_KIND, _PHOTONS = "photons", "leaflight_photons"


class LEAFLIGHT_OT_photon_cloud(background.AskingOperator, bpy.types.Operator):
    bl_label = "Show Photon Map"
    bl_description = (
        "Trace photons and show their hits on isosurfaces as colored points, which are "
        "not rendered by default"
    )
    conditions = (jobs.is_free, *checks.VOLUME)

    count: IntProperty(
        "Photons",
        "Number of emitted photons; each may hit several isosurfaces, or none",
        500_000,
        min=1,
        soft_max=10_000_000,
    )
    kind: EnumProperty(
        "Kind",
        items=[
            ("ALL", "All", "Direct and indirect photons"),
            ("DIRECT", "Direct", "Photons straight from a light"),
            ("INDIRECT", "Indirect", "Photons that were reflected or refracted"),
        ],
    )
    band: FloatProperty(
        "Band",
        "Share of the isovalue range, around the shown isovalue, with photons",
        1.0,
        min=1e-4,
        max=1.0,
        subtype="FACTOR",
    )
    radius: FloatProperty(
        "Radius", "Radius of a point in Blender units", 0.004, min=1e-6, soft_max=0.1
    )
    seed: IntProperty("Seed", "Seed of the random numbers", min=0)

    def start(self, context):
        return PhotonJob(context, active_volume(context), self)


class PhotonJob(jobs.Job):
    """Photons of the present scene: their inputs, their paths, and the cloud of points."""

    def __init__(self, context, obj, options):
        """Exports the scene. options: the operator's properties. Raises LeaflightError."""
        settings = obj.leaflight
        description, volumes, self.warnings = scene_export.export_scene(context, obj)
        scene_export.check_light(description)
        isovalue_range, c = (settings.low, settings.high), settings.isovalue
        if len(volumes) > 1:
            isovalue_range, c = (0.0, 1.0), isovalues.common_isovalue(settings, c)
        self._arguments = {
            "volumes": [cache.world_volume(volume) for volume in volumes],
            "scene": description,
            "isovalues": isovalue_range,
            "count": options.count,
            "seed": options.seed,
        }
        self._kind, self._radius = options.kind, options.radius
        reach = 0.5 * options.band * (isovalue_range[1] - isovalue_range[0])
        self._band = (c - reach, c + reach) if options.band < 1 else isovalue_range
        self._collection, self._object_name = context.collection.name, obj.name
        self._scene_name = context.scene.name

    def run(self, progress):
        """Traces the photons, in any thread. Touches no Blender data."""
        found = trace_photons(**self._arguments, progress=progress)
        c, direct = found.common_isovalue, found.direct
        chosen = (c >= self._band[0]) & (c <= self._band[1])
        if self._kind != "ALL":
            chosen &= direct == (self._kind == "DIRECT")
        self.positions, self.flux = found.positions[chosen], found.flux_height[chosen]
        self.c, self.direct = c[chosen], direct[chosen]

    def apply(self):
        scene = bpy.data.scenes.get(self._scene_name)
        if scene is None or not len(self.positions):
            raise LeaflightError(
                "No photon hit an isosurface within the band: widen it, or emit more photons."
            )
        name = f"{self._object_name} Photons"
        for old in [obj for obj in scene.objects if obj.get(_PHOTONS) == self._object_name]:
            bpy.data.meshes.remove(old.data)
        mesh = bpy.data.meshes.new(name)
        _fill(mesh, self.positions, self.flux, self.c, self.direct)
        obj = bpy.data.objects.new(name, mesh)
        display.mark(obj, _KIND)
        obj[_PHOTONS] = self._object_name
        obj.hide_render = True
        collection = bpy.data.collections.get(self._collection) or scene.collection
        collection.objects.link(obj)
        material = shader.shared_material(_PHOTONS, "Leaflight Photons", FLUX)
        mesh.materials.append(material)
        modifier = obj.modifiers.new("Points", "NODES")
        modifier.node_group = _points(name, self._radius, material)
        return f"{len(self.positions)} photons on isosurfaces"


def _fill(mesh, positions, flux, c, direct):
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    # Scale the mean flux to 1, because absolute flux is no useful color.
    fill.color(mesh, FLUX, flux / max(float(flux.mean()), 1e-30))
    attribute = mesh.attributes.new(COMMON_ISOVALUE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(c, np.float32))
    attribute = mesh.attributes.new(DIRECT, "BOOLEAN", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(direct, bool))
    mesh.update()


def _points(name, radius, material):
    """Returns geometry nodes with a small sphere on every vertex, because Eevee needs faces."""
    tree = versions.new_geometry_tree(name)
    chain = [
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "GeometryNodeInstanceOnPoints",
            "GeometryNodeRealizeInstances",
            "GeometryNodeSetMaterial",
            "NodeGroupOutput",
        )
    ]
    for index, (a, b) in enumerate(zip(chain, chain[1:])):
        a.location.x, b.location.x = 200 * index, 200 * (index + 1)
        tree.links.new(a.outputs[0], b.inputs[0])
    sphere = tree.nodes.new("GeometryNodeMeshIcoSphere")
    sphere.location.y = -200
    tree.links.new(sphere.outputs[0], nodes.socket(chain[1], "Instance"))
    nodes.socket(sphere, "Radius").default_value = radius
    nodes.socket(chain[3], "Material").default_value = material
    return tree
