# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: walls, lights and a camera around the volumes, and a lit viewport."""

import math

import bpy
import mathutils
import numpy as np
from leaflight import LeaflightError

from .. import versions
from ..operators import checks, failures
from ..operators.checks import active_volume
from ..props import BoolProperty, EnumProperty, StringProperty
from ..show import display, isovalues, shader, surface_object, walls
from ..store import frame_bakes, source_files
from ..store.reading import StillReading
from ..translations import iface_
from . import camera, facing, hidden, presets, scene_export, scene_objects, viewport

# Property of data-blocks that Stage has made, with their name at that time. Copies and renamed ones
# therefore belong to the user.
_STAGED = "leaflight_stage"
# Property of the collection of a stage: its preset. The panel may show another one.
_PRESET = "leaflight_preset"


class LEAFLIGHT_OT_stage(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Stage"
    bl_description = (
        "Add walls, lights and a camera around the volumes, as objects that you can edit. "
        "Replaces the previous stage and hides other objects"
    )

    preset: EnumProperty("Stage", "Objects to add around the volumes", presets.ITEMS)
    collection: StringProperty(
        "Collection",
        "Collection of your objects and lights around the volumes",
        options={"SKIP_SAVE"},
    )
    hide_others: BoolProperty(
        "Hide Others",
        "Hide all other objects in viewports and renders, so that they are not baked. "
        "Nothing is deleted, and Show Hidden shows them again",
        True,
    )

    def invoke(self, context, event):
        remembered = context.scene.leaflight_stage
        if not self.properties.is_property_set("preset"):
            self.preset = remembered.preset
        if not self.collection and remembered.collection is not None:
            self.collection = remembered.collection.name
        if self.preset == presets.MY_SCENE and not self.collection:
            return context.window_manager.invoke_props_dialog(self)
        return self.execute(context)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "preset")
        if self.preset == presets.MY_SCENE:
            layout.prop_search(self, "collection", bpy.data, "collections")
        layout.prop(self, "hide_others")
        others = hidden.all_hidden(context.scene)
        if others:
            layout.label(text=iface_("Hidden: %s") % hidden.names(others), icon="HIDE_ON")

    def run(self, context):
        scene = context.scene
        isosurface = active_volume(context)
        volumes = scene_export.volume_objects(context, isosurface)
        own = self._own_collection()
        was_lit = build(context, isosurface, volumes, self.preset, own, self.hide_others)
        scene.leaflight_stage.preset = self.preset
        versions.show_photographically(scene.view_settings)
        viewport.suit_baked_light(scene)
        viewport.show_stage(context)
        self._warn(context, isosurface)
        if was_lit:
            self.report({"INFO"}, "The light of the previous stage was removed: bake again")

    def _own_collection(self):
        """Returns the collection of My Scene, None for another preset. Raises LeaflightError."""
        if self.preset != presets.MY_SCENE:
            return None
        collection = bpy.data.collections.get((self.collection, None))
        if collection is None:
            raise LeaflightError(
                "My Scene has no collection of objects and lights: choose one beside Stage."
            )
        return collection

    def _warn(self, context, isosurface):
        """Reports problems that a bake would have, and the hidden objects."""
        try:
            description, _, warnings = scene_export.export_scene(context, isosurface)
            scene_export.check_light(description)
        except StillReading:
            # The bake reports its problems itself.
            warnings = []
        except LeaflightError as error:
            warnings = [f"Before the bake: {error}"]
        context.scene.leaflight_stage.warnings = "\n".join(warnings)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        others = hidden.all_hidden(context.scene)
        if others:
            self.report({"INFO"}, f"Hidden, not deleted: {hidden.names(others)}")


class LEAFLIGHT_OT_frame_isosurface(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Frame Isosurface"
    bl_description = (
        "Move the camera so that the shown isosurfaces fill its frame. Without the light of a "
        "bake, and after changes of the data, they also stand on the floor of the stage again"
    )

    def run(self, context):
        scene, isosurface = context.scene, active_volume(context)
        volumes = scene_export.volume_objects(context, isosurface)
        if any(map(_is_lit, volumes)) or not is_built(scene):
            _use_camera(scene, isosurface, camera.shown_points(volumes))
        else:
            follow(context, isosurface)
        viewport.look_through_camera(context)


def _is_lit(obj):
    """True if a volume shows the light of a bake, or another of its frames has a bake."""
    settings = obj.leaflight
    if settings.frame_regions or not settings.bake_id:
        return bool(frame_bakes.bakes_of(settings))
    return not source_files.values_changed(settings)


def build(context, isosurface, volumes, preset, collection=None, hide_others=None):
    """Builds a stage around the isosurfaces of volume objects, with the front of `isosurface`.

    collection: The collection of My Scene, or None.
    hide_others: None leaves other objects as they are.
    Returns True if a bake had lit the volumes, which lose its light. Raises LeaflightError before
    anything changes.
    """
    scene = context.scene
    context.view_layer.update()
    points = camera.shown_points(volumes)
    turn = mathutils.Matrix.Rotation(facing.direction(isosurface), 4, "Z")
    seen = points @ np.array(turn.to_3x3())
    description = None if collection else presets.fitted(preset, seen, scene.leaflight_stage.height)
    was_lit = _drop_baked_light(scene, volumes)
    failures.forget()
    _remember(scene, collection)
    # Keep the camera of the previous stage, because viewports may look through it.
    kept = scene.camera if is_staged(scene.camera) and collection is None else None
    _remove_stage(scene, kept)
    if hide_others is not None:
        hidden.show(scene, hidden.all_hidden(scene))
    if hide_others:
        hidden.hide(
            scene, hidden.would_render(scene, set(collection.all_objects) if collection else ())
        )
    if description is None:
        _use(scene, collection)
    else:
        _build(scene, preset, description, turn, volumes, kept)
    if scene.camera is None or is_staged(scene.camera):
        _use_camera(scene, isosurface, points)
    for obj in volumes:
        obj.leaflight.light_walls = True
    context.view_layer.update()
    return was_lit


def follow(context, isosurface):
    """Builds the stage of the scene again, if it has one, around its present volumes."""
    scene = context.scene
    built = next(filter(is_staged, scene.collection.children), None)
    if built is not None and isosurface.name in scene.objects:
        volumes = scene_export.volume_objects(context, isosurface)
        # Files of an earlier Leaflight store the preset of the panel alone.
        preset = built.get(_PRESET, scene.leaflight_stage.preset)
        build(context, isosurface, volumes, preset)


def is_built(scene):
    """True if the scene has a collection that Stage has made."""
    return any(is_staged(collection) for collection in scene.collection.children)


def is_staged(thing):
    """True if Stage has made a data-block, and the user has not renamed it."""
    return thing is not None and thing.get(_STAGED) == thing.name


def _remember(scene, collection):
    """Stores the collection of My Scene, and the world and camera that the user had before."""
    remembered = scene.leaflight_stage
    if collection is not None:
        remembered.collection = collection
    if not is_staged(scene.world):
        remembered.own_world = scene.world
    if not is_staged(scene.camera):
        remembered.own_camera = scene.camera


def _remove_stage(scene, kept):
    """Removes the previous stage. Objects that the user put into its collection stay.

    kept: an object of the stage that stays, or None.
    """
    for obj in [obj for obj in scene.objects if is_staged(obj) and obj != kept]:
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


def _drop_baked_light(scene, volumes):
    """Shows the volumes and the walls without baked light. The file of the bake stays.

    Returns True if a bake had lit the volumes.
    """
    was_lit = any(obj.leaflight.bake_id for obj in volumes)
    for obj in isovalues.volumes(scene):
        obj.leaflight.bake_walls = False
    walls.refresh(scene)
    for obj in volumes:
        frame_bakes.forget(obj.leaflight)
        surface_object.update_all(obj)
        for surface in display.surfaces_of(obj):
            surface.leaflight.limit_softly(isovalues.isovalue_range(obj.leaflight))
    return was_lit


def _build(scene, preset, description, turn, volumes, kept):
    """Builds the objects, world and exposure of a preset. turn: matrix about the origin.

    kept: the camera of the previous stage, or None.
    """
    collection = bpy.data.collections.new(description.name)
    collection[_STAGED], collection[_PRESET] = collection.name, preset
    scene.collection.children.link(collection)
    made = [scene_objects.mesh_object(mesh) for mesh in description.meshes]
    made += [scene_objects.light_object(light) for light in description.lights]
    for obj in made:
        obj.matrix_world = turn @ obj.matrix_basis
        collection.objects.link(obj)
        obj[_STAGED] = obj.name
    if kept is not None and kept.name in scene.collection.objects:
        scene.collection.objects.unlink(kept)
        collection.objects.link(kept)
    scene.camera = kept
    scene_objects.surround(scene, description.environment)
    if scene.world != scene.leaflight_stage.own_world:
        scene.world[_STAGED] = scene.world.name
    scene.view_settings.exposure = math.log2(description.exposure)
    _color(scene, volumes, description.isosurfaces[0].albedo)


def _color(scene, volumes, albedo):
    """Gives volumes the color of a stage unless the user has chosen another."""
    remembered = scene.leaflight_stage
    for obj in volumes:
        settings = obj.leaflight
        default = settings.bl_rna.properties["isosurface_albedo"].default_array
        if any(
            np.allclose(settings.isosurface_albedo, known) for known in (default, remembered.albedo)
        ):
            settings.isosurface_albedo = albedo
    remembered.albedo = albedo


def _use(scene, collection):
    """Links a collection of the user to the scene, and uses its camera."""
    if collection.name not in {child.name for child in scene.collection.children_recursive}:
        scene.collection.children.link(collection)
    found = next((obj for obj in collection.all_objects if obj.type == "CAMERA"), None)
    scene.camera = found or scene.leaflight_stage.own_camera


def _use_camera(scene, isosurface, points):
    """Frames points with the scene's camera, or with a new one."""
    if scene.camera is None:
        scene.camera = camera.new(scene)
        staged = filter(is_staged, scene.collection.children)
        next(staged, scene.collection).objects.link(scene.camera)
        scene.camera[_STAGED] = scene.camera.name
    camera.frame(scene.camera, scene, points, facing.direction(isosurface), facing.ELEVATION)


# Name of the backdrop in scene files.
_BACKDROP = "backdrop"


def paint_backdrop(scene, color):
    """Gives a linear color (r, g, b) to the backdrop of the stage, if it has one."""
    for obj in scene.objects:
        if is_staged(obj) and obj.name.partition(".")[0] == _BACKDROP:
            for material in obj.data.materials:
                shader.set_albedo(material, color)
                material.diffuse_color = (*color, 1.0)
