# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Flattened Illumination: all volumes of the scene, and what the objects keep of it."""

import time

import bpy
import leaflight
from leaflight.io.output import check_writable

from ..operators import background, checks
from ..stage import scene_export
from ..store import atlases, bake_files, cache, source_files
from . import lighting

LeaflightError = leaflight.LeaflightError


class BakeJob:
    """One bake: all it needs, read from the scene; the work; and lighting the volumes by it."""

    def __init__(self, context, obj):
        """Of all volumes that render, with the settings of `obj`.

        Raises LeaflightError when the scene or the settings cannot be baked.
        """
        settings = obj.leaflight
        scene, volumes, self.warnings = scene_export.export_scene(context, obj)
        for volume in volumes:
            _check_own(volume)
        self.folder = bake_files.folder_for(obj)
        bake_files.make_folder(self.folder)
        check_writable(self.folder / "bake.vdb", ".vdb")
        scene_export.check_light(scene)
        self.scene_name = context.scene.name
        self.leader = volumes.index(obj)
        self.names = [volume.name for volume in volumes]
        self.matrices = [[x for row in obj.matrix_world for x in row] for obj in volumes]
        self.stamps = [source_files.stamp(volume.leaflight) for volume in volumes]
        self.fingerprint = scene_export.fingerprint(volumes, scene)
        self.bake = None
        self._arguments = {
            "volumes": [cache.volume_to_bake(volume) for volume in volumes],
            "scene": scene,
            "isovalues": (settings.low, settings.high) if len(volumes) == 1 else None,
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
        self.path = bake_files.path_for(self.folder, self.names[self.leader], bake.id)
        self.columns = _write(bake, self.path)
        self.seconds = time.perf_counter() - start
        self.bake = bake

    def apply(self):
        """Lights the volumes by the bake and returns a sentence about it.

        Raises LeaflightError when one has gone meanwhile.
        """
        volumes = [bpy.data.objects.get((name, None)) for name in self.names]
        for name, obj in zip(self.names, volumes):
            if obj is None or not obj.leaflight.is_volume:
                raise LeaflightError(
                    f'"{name}" is gone or has another name, so the bake lights nothing: select '
                    f"the volume and load the bake from {self.path}."
                )
        cache.keep_bake(self.bake)
        for index, obj in enumerate(volumes):
            lighting.light(
                obj,
                self.bake,
                index,
                self.path,
                self.matrices[index],
                self.columns[index],
                fingerprint=self.fingerprint,
                seconds=self.seconds,
                source_stamp=self.stamps[index],
            )
        scene = bpy.data.scenes.get(self.scene_name)
        lighting.show(volumes, volumes[self.leader], scene)
        texels = sum(grid.texels for grid in self.bake.grids)
        return f"Baked {texels} texels in {self.seconds:.1f} s"


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


def _check_own(obj):
    if obj.library is not None:
        raise LeaflightError(
            f'"{obj.name}" is linked from {bpy.path.basename(obj.library.filepath)} and cannot '
            "keep a bake here: make a library override of it, or disable it in renders."
        )


def _write(bake, path):
    """Writes the bake with its atlases: all of them, or nothing that was not there before.

    Returns the columns of each volume's atlas. Raises LeaflightError.
    """
    before = {path, *atlases.beside(path)} if path.exists() else set()
    try:
        bake.save(path)
        return [atlases.write(grid, path, bake.id, index) for index, grid in enumerate(bake.grids)]
    except LeaflightError:
        for file in {path, *atlases.beside(path)} - before:
            file.unlink(missing_ok=True)
        raise


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_bake)
