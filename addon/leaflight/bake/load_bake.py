# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of bakes: Load Bake, Relocate Bake, and Remove Unused Bakes."""

import os
from dataclasses import replace
from pathlib import Path

import bpy
import leaflight
import numpy as np
from bpy_extras.io_utils import ImportHelper
from leaflight import LeaflightError
from leaflight.bake.provenance import values_sha256
from mathutils import Matrix

from ..operators import checks, jobs
from ..operators.checks import active_volume
from ..props import BoolProperty, StringProperty
from ..show import display, isosurfaces, isovalues, lamps, surface_object
from ..stage import scene_export, scene_objects, staleness
from ..store import atlases, bake_files, cache, frame_bakes
from ..store.reading import StillReading
from ..translations import iface_
from . import lighting


class LEAFLIGHT_OT_load_bake(checks.LeaflightOperator, bpy.types.Operator, ImportHelper):
    bl_label = "Load Bake"
    bl_description = (
        "Light the selected volume by a bake of it, from Blender or the command line. "
        "Without a matching volume, import the baked volumes and their scene"
    )
    conditions = (jobs.is_free, checks.in_object_mode)

    filter_glob: StringProperty(default="*.vdb", options={"HIDDEN"})
    walls: BoolProperty("Scene", "Import the objects and lights of the baked scene, too", True)

    def run(self, context):
        path = Path(os.path.normpath(bpy.path.abspath(self.filepath)))
        bake = leaflight.load_bake(path)
        columns = [atlases.write(g, path, bake.id, i) for i, g in enumerate(bake.grids)]
        volumes = _matching(context, bake)
        cache.keep_bake(bake)
        seconds = bake.statistics.seconds
        created = None in volumes
        for index, obj in enumerate(volumes):
            place = {}
            if obj is None:
                volumes[index] = obj = _create(context, bake, index)
            else:
                place = {"matrix": _transform(obj, bake, index)}
                obj.leaflight.capped = bake.scene.isosurfaces[index].capped
            obj.leaflight.smooth_normals = bake.volumes[index].smooth_normals
            state = replace(lighting.StateAtBake.of(obj), **place)
            about = staleness.OTHER_SCENE, seconds
            lighting.light(obj, bake, index, path, columns[index], state, *about)
            obj.leaflight.low, obj.leaflight.high = lighting.isovalue_range(bake, index)
        if created and self.walls:
            for warning in scene_objects.build(context, bake.scene):
                self.report({"WARNING"}, warning)
        context.view_layer.update()
        active = active_volume(context)
        leader = active if active in volumes else volumes[0]
        _compare(context, bake, volumes, leader)
        lighting.show(volumes, leader, context.scene)
        isovalues.lock_interface(context.scene)
        display.select(context, volumes, leader)
        staleness.forget()
        names = ", ".join(f'"{obj.name}"' for obj in volumes)
        self.report({"INFO"}, f"{path.name} lights {names}")


class LEAFLIGHT_OT_relocate_bake(checks.LeaflightOperator, bpy.types.Operator, ImportHelper):
    bl_label = "Relocate Bake"
    bl_description = "Choose the new location of the file of this volume's bake"
    conditions = (
        *checks.BAKE,
        checks.volume_needs(
            lambda volume: volume.library is None,
            "The volume is linked from another file: relocate its bake there",
        ),
    )

    filter_glob: StringProperty(default="*.vdb", options={"HIDDEN"})

    def run(self, context):
        path = Path(os.path.normpath(bpy.path.abspath(self.filepath)))
        obj = active_volume(context)
        if obj is None:
            raise LeaflightError("The volume was deleted: undo that, or import it again.")
        identifier = obj.leaflight.bake_id
        if bake_files.id_in(path) != identifier:
            raise LeaflightError(
                f'{path}: this is not the bake of "{obj.name}": choose that one, or use Load Bake.'
            )
        surface_object.forget()
        for each in lighting.objects_lit_by(identifier):
            bake_files.remember(each, path)
            surface_object.update_all(each)
        staleness.forget()


def _matching(context, bake):
    """Returns for each volume of a bake the object that shows it, or None.

    All are None if the active object is no volume of the bake. Raises LeaflightError.
    """
    found = [None] * len(bake.volumes)
    active = active_volume(context)
    if active is None:
        return found
    others = [obj for obj in isovalues.volumes(context.scene) if obj != active]
    for obj in [active, *others]:
        for index, shown in enumerate(found):
            if shown is None and obj.library is None and _is_volume_of(obj, bake, index):
                found[index] = obj
                break
        if active not in found:
            return [None] * len(bake.volumes)
    return found


def _is_volume_of(obj, bake, index):
    """True if an object's volume has the values of a volume of a bake, capped or not."""
    try:
        volume = cache.volume_of(obj)
    except StillReading:
        raise
    except LeaflightError:
        return False
    capped = bake.scene.isosurfaces[index].capped
    if capped != obj.leaflight.capped:
        plain = leaflight.Volume(volume.data(), np.eye(4), volume.name)
        volume = plain.capped() if capped else plain
    return values_sha256(volume) == cache.values_sha256(bake, index)


def _transform(obj, bake, index):
    """Returns the transform that moves an object to where its volume was baked, row by row."""
    index_to_local = cache.volume_of(obj).index_to_world
    if bake.scene.isosurfaces[index].capped != obj.leaflight.capped:
        # The layer of a capped volume moves the first node by one voxel.
        step = 1.0 if bake.scene.isosurfaces[index].capped else -1.0
        index_to_local = index_to_local @ _shifted(-step)
    matrix = bake.volumes[index].index_to_world @ np.linalg.inv(index_to_local)
    return matrix.ravel().tolist()


def _shifted(step):
    matrix = np.eye(4)
    matrix[:3, 3] = step
    return matrix


def _create(context, bake, index):
    """Adds an object for a volume of a bake, with its place and material at the bake.

    Its origin is the middle of the volume.
    """
    baked = bake.volumes[index]
    obj = surface_object.new(context, baked.name)
    middle = np.asarray(baked.field().bounds, np.float64).mean(axis=0)
    obj.matrix_world = Matrix.Translation(middle.tolist())
    settings = obj.leaflight
    isosurfaces.import_isosurfaces(settings, bake.scene.isosurfaces[index])
    low, high = lighting.isovalue_range(bake, index)
    isovalue = leaflight.default_isovalue(baked)
    settings["isovalue"] = isovalue if low < isovalue < high else 0.5 * (low + high)
    settings.is_volume = True
    return obj


def _compare(context, bake, volumes, leader):
    """Marks the volumes as lit in their own scene if the present scene equals that of the bake."""
    try:
        description, exported, _ = scene_export.export_scene(context, leader)
        same = set(exported) == set(volumes) and staleness.is_same(description, bake.scene)
        for index, obj in enumerate(volumes):
            place = cache.world_volume(obj).index_to_world
            same = same and staleness.is_same(place, bake.volumes[index].index_to_world)
        fingerprint = scene_export.fingerprint(exported, description)
        lights = staleness.in_order(description.lights, bake.scene.lights) if same else []
    except LeaflightError:
        same = False
    for obj in volumes:
        if same:
            obj.leaflight.bake_fingerprint = fingerprint
            obj.leaflight.bake_lamps = lamps.record(bake, lights)
        else:
            obj.leaflight.bake_lamps = ""
            # The walls of the bake are not those of this scene.
            obj.leaflight.bake_walls = False


def _draw_menu(menu, _context):
    menu.layout.operator(LEAFLIGHT_OT_load_bake.bl_idname, text="Bake of Leaflight (.vdb)")


# Largest number of rows in the list.
_MOST_ROWS = 12


class LEAFLIGHT_OT_remove_unused_bakes(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Remove Unused Bakes"
    bl_description = (
        "Delete the bake files of this .blend that light none of its volumes. Undo steps "
        "and other .blend files that use them lose their light"
    )
    bl_options = set()
    conditions = (
        checks.needs(lambda _: unused(), "Each bake in the folders of this .blend lights a volume"),
    )

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self, width=500)

    def draw(self, _context):
        column = self.layout.column(align=True)
        column.label(text="Undo steps and other .blend files that use them lose their light:")
        found = unused()
        for path in found[:_MOST_ROWS]:
            column.label(text=f"{path.name}, {megabytes([path])}", icon="FILE")
        if len(found) > _MOST_ROWS:
            column.label(text=iface_("and %d more") % (len(found) - _MOST_ROWS), icon="BLANK1")

    def run(self, _context):
        found = unused()
        size = megabytes(found)
        for path in found:
            try:
                for file in (path, *atlases.beside(path)):
                    file.unlink()
                bake_files.remove_if_empty(path.parent)
            except OSError as error:
                raise LeaflightError(f"{path}: cannot delete it: {error.strerror}.") from None
        self.report({"INFO"}, f"Removed {len(found)} bakes, {size}")


def bakes_of_this_file():
    """Returns the paths of the bakes in the folders of this .blend and of unsaved files."""
    volumes = [obj for obj in bpy.data.objects if obj.leaflight.is_volume and obj.library is None]
    folders = [bake_files.folder_for(obj) for obj in volumes] + bake_files.folders_of_unsaved()
    return [path for folder in dict.fromkeys(folders) for path in bake_files.bakes_in(folder)]


def unused():
    """Returns the paths of bakes_of_this_file() that light no object of this .blend."""
    return unused_among(bakes_of_this_file())


def unused_among(bakes):
    """Returns those of the bakes, given as paths, that light no object of this .blend."""
    used = set().union(*(frame_bakes.bakes_of(obj.leaflight) for obj in bpy.data.objects))
    return [path for path in bakes if bake_files.id_in(path) not in used]


def megabytes(paths):
    """Returns the size of bakes with their atlases, as text."""
    files = [file for path in paths for file in (path, *atlases.beside(path))]
    return f"{sum(file.stat().st_size for file in files) / 1e6:.1f} MB"


MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
