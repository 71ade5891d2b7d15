# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""Stage: walls, lights and a camera around the volumes, as ordinary objects, and a lit viewport."""

import math

import bpy
import leaflight
import mathutils
from bpy.props import BoolProperty, EnumProperty, StringProperty

from .. import versions
from ..operators import background, checks
from ..show import walls
from ..store.cache import world_volume
from ..translations import iface_
from . import aside, camera, facing, presets, scene_export, scene_objects, viewport

# Marks what Stage has made, with its name then: a copy, or what the user has renamed, is theirs.
_STAGED = "leaflight_stage"


class LEAFLIGHT_OT_stage(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.stage"
    bl_label = "Stage"
    bl_description = (
        "Put walls, lights and a camera around the volumes, as objects that you may edit, set "
        "other objects aside, and light the viewport. Another stage replaces the one before"
    )
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Stage", description="What to put around the volumes", items=presets.ITEMS
    )
    collection: StringProperty(
        name="Collection",
        description="Collection of your own objects and lights that shall surround the volumes",
    )
    set_aside: BoolProperty(
        name="Set Others Aside",
        description="Hide all other objects from view and from renders, so that they are not baked "
        "with the stage. Nothing is deleted, and Bring Back shows them again",
        default=True,
    )

    def invoke(self, context, _event):
        remembered = context.scene.leaflight_stage
        if not self.properties.is_property_set("preset"):
            self.preset = remembered.preset
        if not self.collection and remembered.collection is not None:
            self.collection = remembered.collection.name
        return self.execute(context)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "preset")
        if self.preset == presets.MY_SCENE:
            layout.prop_search(self, "collection", bpy.data, "collections")
        layout.prop(self, "set_aside")
        hidden = aside.all_aside(context.scene)
        if hidden:
            layout.label(text=iface_("Set aside: %s") % aside.names(hidden), icon="HIDE_ON")

    def execute(self, context):
        scene = context.scene
        leaf = context.object
        try:
            volumes = scene_export.volume_objects(context, leaf)
            shapes = [world_volume(obj) for obj in volumes]
            own = self._own_collection()
            lowest = [obj.leaflight.low for obj in volumes]
            description = None if own else presets.fitted(self.preset, shapes, lowest)
        except leaflight.LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        # The light of the last bake on what surrounded the volumes then.
        for obj in scene.objects:
            if obj.leaflight.bake_surroundings:
                obj.leaflight.bake_surroundings = False
        walls.refresh(scene)
        background.forget_failure()
        _remember(scene, self.preset, own)
        _remove_stage(scene)
        aside.bring_back(scene, aside.all_aside(scene))
        if self.set_aside:
            aside.set_aside(scene, aside.would_render(scene, set(own.all_objects) if own else ()))
        if description is None:
            self._use(scene, own, leaf, shapes)
        else:
            self._build(scene, description, leaf, volumes, shapes)
        for obj in volumes:
            obj.leaflight.light_surroundings = True
        versions.show_photographically(scene.view_settings)
        context.view_layer.update()
        viewport.show_stage(context)
        self._warn(context, leaf)
        return {"FINISHED"}

    def _own_collection(self):
        """The collection of My Scene, None for another preset. Raises LeaflightError."""
        if self.preset != presets.MY_SCENE:
            return None
        collection = bpy.data.collections.get((self.collection, None))
        if collection is None:
            raise leaflight.LeaflightError(
                "My Scene needs a collection of your own objects and lights: choose one beside "
                "Stage."
            )
        return collection

    def _build(self, scene, description, leaf, volumes, shapes):
        """The objects of a description, turned so that they face the volumes' front."""
        collection = bpy.data.collections.new(description.name)
        collection[_STAGED] = collection.name
        scene.collection.children.link(collection)
        made = [scene_objects.mesh_object(mesh) for mesh in description.meshes]
        made += [scene_objects.light_object(light) for light in description.lights]
        scene.camera = self._camera(scene, shapes)
        made.append(scene.camera)
        _turn(made, shapes, facing.quarter_turns(leaf))
        for obj in made:
            collection.objects.link(obj)
            obj[_STAGED] = obj.name
        scene_objects.surround(scene, description.environment)
        if scene.world != scene.leaflight_stage.own_world:
            scene.world[_STAGED] = scene.world.name
        scene.view_settings.exposure = math.log2(description.exposure)
        for obj in volumes:
            obj.leaflight.leaf_albedo = description.leaves[0].albedo

    def _use(self, scene, own, leaf, shapes):
        """A camera for a collection of the user's that has none."""
        if own.name not in {child.name for child in scene.collection.children_recursive}:
            scene.collection.children.link(own)
        found = next((obj for obj in own.all_objects if obj.type == "CAMERA"), None)
        scene.camera = found or scene.leaflight_stage.own_camera
        if scene.camera is None:
            scene.camera = self._camera(scene, shapes)
            _turn([scene.camera], shapes, facing.quarter_turns(leaf))
            scene.collection.objects.link(scene.camera)
            scene.camera[_STAGED] = scene.camera.name

    def _camera(self, scene, shapes):
        preset = presets.PRESETS[self.preset]
        low, high = presets.bounds(shapes)
        is_wide = scene.render.resolution_x >= scene.render.resolution_y
        return camera.around(low, high, preset.elevation, preset.filled, is_wide)

    def _warn(self, context, leaf):
        """Says now what would stop or spoil the bake later, and what was set aside."""
        try:
            description, _, warnings = scene_export.export_scene(context, leaf)
            scene_export.check_light(description)
        except leaflight.LeaflightError as error:
            warnings = [f"Before the bake: {error}"]
        context.scene.leaflight_stage.warnings = "\n".join(warnings)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        hidden = aside.all_aside(context.scene)
        if hidden:
            self.report({"INFO"}, f"Set aside, not deleted: {aside.names(hidden)}")


def is_staged(thing):
    """Whether an object, a collection or a world is of the stage, and not the user's."""
    return thing is not None and thing.get(_STAGED) == thing.name


def _remember(scene, preset, collection):
    """Notes the choice, and what the scene had of its own before."""
    remembered = scene.leaflight_stage
    remembered.preset = preset
    if collection is not None:
        remembered.collection = collection
    if not is_staged(scene.world):
        remembered.own_world = scene.world
    if not is_staged(scene.camera):
        remembered.own_camera = scene.camera


def _remove_stage(scene):
    """Removes the stage before; what the user has put into its collection stays in the scene."""
    for obj in [obj for obj in scene.objects if is_staged(obj)]:
        data = obj.data
        materials = [] if data is None or obj.type != "MESH" else list(data.materials)
        bpy.data.objects.remove(obj)
        bpy.data.batch_remove([one for one in (data, *materials) if one and not one.users])
    for collection in [c for c in scene.collection.children if is_staged(c)]:
        for obj in collection.objects:
            if not set(obj.users_collection) - {collection}:
                scene.collection.objects.link(obj)
        for child in collection.children:
            scene.collection.children.link(child)
        bpy.data.collections.remove(collection)
    if is_staged(scene.world):
        bpy.data.worlds.remove(scene.world)
    scene.world = scene.leaflight_stage.own_world
    if scene.camera is None:
        scene.camera = scene.leaflight_stage.own_camera


def _turn(objects, shapes, quarters):
    """Turns new objects by quarters of a turn about the vertical through the middle of volumes."""
    there = mathutils.Matrix.Translation(sum(presets.bounds(shapes)) / 2)
    rotation = mathutils.Matrix.Rotation(math.radians(90 * quarters), 4, "Z")
    for obj in objects if quarters else ():
        obj.matrix_world = there @ rotation @ there.inverted() @ obj.matrix_basis


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_stage)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_stage)
