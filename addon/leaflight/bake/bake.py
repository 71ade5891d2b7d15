# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Flattened Illumination: all volumes of the scene, and what the objects keep of it."""

import re
import time
import uuid
from pathlib import Path

import bpy
import leaflight
from leaflight.io.output import check_writable

from ..operators import background, checks
from ..show import isovalues, shader, surface_object, walls
from ..stage import scene_export
from ..store import cache

LeaflightError = leaflight.LeaflightError


class BakeJob:
    """One bake: all it needs, read from the scene; the work; and lighting the volumes by it."""

    def __init__(self, context, obj):
        """Of all volumes that render, with the settings of `obj`.

        Raises LeaflightError when the scene or the settings cannot be baked.
        """
        settings = obj.leaflight
        self.output = settings.output
        self.path = bpy.path.abspath(settings.output)
        scene, volumes, self.warnings = scene_export.export_scene(context, obj)
        _check_not_in_use(self.path, volumes)
        _make_folder(self.path)
        for volume in volumes:
            check_writable(self.path, ".vdb", volume.leaflight.source)
        scene_export.check_light(scene)
        self.scene_name = context.scene.name
        self.leader = obj.name
        self.names = [volume.name for volume in volumes]
        self.matrices = [[x for row in obj.matrix_world for x in row] for obj in volumes]
        self.windows = [(obj.leaflight.low, obj.leaflight.high) for obj in volumes]
        self.fingerprint = scene_export.fingerprint(volumes, scene)
        self.bake = None
        self._arguments = {
            "volumes": [cache.world_volume(volume) for volume in volumes],
            "scene": scene,
            "isovalues": self.windows[0] if len(volumes) == 1 else None,
            "resolution": settings.resolution or None,
            "samples": settings.samples,
            "photons": settings.photons,
            "refine": settings.refine,
            "estimator": settings.estimator,
            "seed": settings.seed,
            "both_sides": settings.both_sides,
            "surroundings": settings.light_surroundings,
        }

    def run(self, progress):
        """Bakes and writes the files, in any thread: touches no Blender data."""
        start = time.perf_counter()
        bake = leaflight.bake(**self._arguments, progress=progress)
        if progress.cancelled:
            raise leaflight.Cancelled
        bake.save(self.path)
        self.atlas_columns = [
            _write_atlases(grid, self.path, index) for index, grid in enumerate(bake.grids)
        ]
        self.seconds = time.perf_counter() - start
        self.bake = bake

    def apply(self):
        """Lights the volumes by the bake and returns a sentence about it.

        Raises LeaflightError when one has gone meanwhile.
        """
        volumes = [bpy.data.objects.get(name) for name in self.names]
        for name, obj in zip(self.names, volumes):
            if obj is None or not obj.leaflight.is_volume:
                raise LeaflightError(
                    f'"{name}" is gone, so the bake lights nothing: import it again. The bake is '
                    f"kept in {self.path}."
                )
        identifier = uuid.uuid4().hex
        cache.keep_bake(self.path, self.bake)
        for index, obj in enumerate(volumes):
            self._light(obj, index, identifier)
        cache.forget_unused()
        for obj in volumes:
            settings = obj.leaflight
            volume = cache.volume_of(obj)
            window = self.windows[settings.bake_index]
            settings.limit_isovalue(volume.data_range(), window, settings.isovalue)
            surface_object.update(obj, settings.isovalue)
        leader = bpy.data.objects[self.leader]
        isovalues.set_isovalue(leader, leader.leaflight.isovalue)
        scene = bpy.data.scenes.get(self.scene_name)
        if scene is not None:
            walls.refresh(scene)
        texels = sum(grid.texels for grid in self.bake.grids)
        return f"Baked {texels} texels in {self.seconds:.1f} s"

    def _light(self, obj, index, identifier):
        settings = obj.leaflight
        settings.bake_path = self.output
        settings.bake_index = index
        settings.bake_matrix = self.matrices[index]
        settings.bake_low, settings.bake_high = self.windows[index]
        settings.bake_surroundings = self.bake.surroundings is not None
        settings.bake_fingerprint = self.fingerprint
        settings.bake_refined = self.bake.grids[index].levels > 1
        settings.bake_seconds = self.seconds
        settings.atlas_columns = self.atlas_columns[index]
        settings.bake_id = identifier
        for back in (False, True):
            shader.reload_image(shader.atlas_path(self.path, index, back))


class LEAFLIGHT_OT_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.bake"
    bl_label = "Bake Flattened Illumination"
    bl_description = (
        "Compute the light on every isosurface of the window at once, in the surroundings of the "
        "scene. Esc cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return cls.is_free() and checks.has_volume(cls, context)

    def start(self, context):
        return BakeJob(context, context.object)


def default_output(obj):
    """Beside a saved .blend, otherwise among the user's Blender files under a name of its own."""
    name = re.sub(r"[^\w.-]+", "_", obj.name)
    if bpy.data.filepath:
        return f"//leaflight/{name}.vdb"
    folder = bpy.utils.user_resource("DATAFILES", path="leaflight")
    return str(Path(folder) / f"{name}_{time.strftime('%Y%m%d_%H%M%S')}.vdb")


def _check_not_in_use(path, volumes):
    for other in bpy.data.objects:
        theirs = other.leaflight.bake_path
        if other not in volumes and theirs and bpy.path.abspath(theirs) == path:
            raise LeaflightError(f'{path}: this bake lights "{other.name}"; choose another output.')


def _write_atlases(grid, path, index):
    """Writes the atlas of each side that was baked. Returns their columns, 0 if there is none."""
    columns = shader.write_atlas(grid, shader.atlas_path(path, index))
    if columns and grid.has_back:
        shader.write_atlas(grid, shader.atlas_path(path, index, back=True), back=True)
    return columns


def _make_folder(path):
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(
            f"{path}: cannot make its folder: {error.strerror}; choose another output."
        ) from None


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_bake)
