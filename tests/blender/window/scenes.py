# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for pressing operators: each is made once, saved, and opened for each row.

Each scene and each row has a folder with a .blend and its bakes.
"""

import math
import shutil
from contextlib import suppress
from dataclasses import replace

import bpy
import hand
import leaflight
import seen
from leaflight import blender
from leaflight_addon.bake import bake
from leaflight_addon.show import display, isovalues
from leaflight_addon.store import cache

# Target errors of small volumes: one that the first passes reach, and one out of reach.
_EASY, _UNREACHED = 20.0, 0.01


class Scenes:
    """The saved scenes. folder: the files to import, and the place of the folders of scenes."""

    def __init__(self, folder):
        self._folder = folder

    def file(self, name):
        """Returns the path of the file that the file browser must choose."""
        if name != "a bake":
            return self._folder / name
        return next(self._made("baked").glob("leaflight/*.vdb"))

    def open(self, name, row):
        """Opens a scene, as a .blend in a folder of this row."""
        folder = self._folder / "rows" / row
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self._made(name), folder)
        _open(folder)
        seen.set_folder(folder)

    def _made(self, name):
        """Returns the folder of a scene."""
        folder = self._folder / "scenes" / name
        if folder.exists():
            return folder
        parent, change = _SCENES[name]
        if parent:
            shutil.copytree(self._made(parent), folder)
            _open(folder)
        else:
            # Start from Blender's first scene, which is open.
            folder.mkdir(parents=True)
        with hand.in_view():
            change(self)
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
        if name in _WITH_FILES:
            _WITH_FILES[name](self, folder)
        return folder


def _open(folder):
    """Opens a scene, and waits for its files."""
    bpy.ops.wm.open_mainfile(filepath=str(folder / "scene.blend"))
    with cache.waiting():
        for obj in seen.volumes():
            cache.volume_of(obj)


def _nothing(_scenes):
    """Changes nothing."""


def _import(scenes, name="head.nii.gz", **options):
    obj = blender.import_volume(scenes.file(name), **options)
    settings = obj.leaflight
    settings.error, settings.use_resolution, settings.resolution = _EASY, True, 16


def _stage(_scenes):
    blender.stage(seen.volume())
    seen.volume().leaflight.light_walls = False


def _light_walls(_scenes):
    seen.volume().leaflight.light_walls = True
    _limit_time(seen.volume())


def _limit_time(obj):
    """Limits the time of bakes, which makes their light coarse."""
    obj.leaflight.use_time_limit, obj.leaflight.time_limit = True, 1.0


def _two(scenes):
    _import(scenes, "other.nii.gz")
    _stage(scenes)
    for obj in seen.volumes():
        _limit_time(obj)


def _color(scenes):
    """Imports a second volume in the place of the first, whose isosurfaces it colors."""
    obj = seen.volume()
    _import(scenes, "other.nii.gz", size_from="SAME", partner=obj.name)
    (other,) = (one for one in seen.volumes() if one != obj)
    display.select(bpy.context, [obj], obj)
    obj.leaflight.texture_volume = other
    _stage(scenes)


def _parts(scenes):
    """Imports a volume with two parts."""
    _import(scenes, "parts.nii.gz")


def _explode(_scenes):
    seen.volume().leaflight_look.explode_axis = "Z"


def _aim(_scenes):
    """Puts the 3D cursor into the volume."""
    bpy.context.scene.cursor.location = seen.volume().matrix_world.translation


def _clean(_scenes):
    bpy.ops.leaflight.clean_data(kind="largest_part")


def _add_clip_box(_scenes):
    bpy.ops.leaflight.add_clip_box()


def _labels(scenes):
    _import(scenes, "regions.nii.gz")


def _frames(scenes):
    _import(scenes, "beating.nii.gz", frame=0)
    _stage(scenes)


def _move_isovalue(_scenes):
    obj = seen.volume()
    blender.show(obj, isovalues.isovalue_at(obj.leaflight, 0.9))


def _bake(_scenes):
    blender.bake(seen.volume())


def _ask_for_more(_scenes):
    """Sets a target error that a bake does not reach soon."""
    seen.volume().leaflight.error = _UNREACHED
    _limit_time(seen.volume())


def _light_the_ceiling(_scenes):
    """Lights only the ceiling, so that all light of isosurfaces is indirect and needs several
    passes.
    """
    obj = seen.volume()
    blender.stage(obj, preset="CORNELL")
    (lamp,) = (o for o in bpy.context.scene.objects if o.type == "LIGHT" and not o.hide_render)
    lamp.data.type, lamp.data.spot_size = "SPOT", 0.8
    lamp.data.energy *= 20.0
    lamp.rotation_euler, lamp.location.z = (math.pi, 0.0, 0.0), lamp.location.z - 0.5
    settings = obj.leaflight
    settings.light_walls, settings.resolution, settings.error = False, 12, 0.5
    settings.low, settings.high = 40.0, 60.0
    settings.isovalue = 50.0


def _add_stop(_scenes):
    bpy.ops.leaflight.add_stop()


def _add_isosurface(_scenes):
    obj = seen.volume()
    blender.add_isosurface(obj, isovalues.isovalue_at(obj.leaflight, 0.8))


def _go_live(_scenes):
    bpy.context.scene.leaflight_live = True


def _bring_bake(scenes, folder):
    shutil.copytree(scenes._made("baked") / "leaflight", folder / "leaflight")


def _lose_bake(_scenes, folder):
    shutil.rmtree(folder / "leaflight")


def _interrupt(_scenes, folder):
    """Leaves the checkpoint of a bake, as if Blender had ended after its first pass."""
    _open(folder)
    with hand.in_view():
        job = bake.BakeJob(bpy.context, seen.volume())
    checkpoint = replace(job.checkpoint, seconds=0.0)
    progress = leaflight.Progress()
    how = {"on_pass": lambda _: progress.cancel(), "progress": progress}
    with suppress(leaflight.Cancelled):
        leaflight.bake(**job._arguments, checkpoint=checkpoint, **how)
    assert job.checkpoint.path.is_file()


# Scenes by name: (the scene to start from, the function that changes it).
_SCENES = {
    "home": ("", _nothing),
    "imported": ("home", _import),
    "staged": ("imported", _stage),
    "walled": ("staged", _light_walls),
    "moved on": ("staged", _move_isovalue),
    "baked": ("staged", _bake),
    "unreached": ("baked", _ask_for_more),
    "moved": ("baked", _nothing),
    "living": ("baked", _go_live),
    "stops": ("baked", _add_stop),
    "several": ("baked", _add_isosurface),
    "unused": ("staged", _nothing),
    "interrupted": ("imported", _light_the_ceiling),
    "baking": ("staged", _nothing),
    "stopped": ("staged", _nothing),
    "two": ("imported", _two),
    "colored": ("imported", _color),
    "parts": ("home", _parts),
    "aimed": ("parts", _aim),
    "exploded": ("parts", _explode),
    "cleaned": ("parts", _clean),
    "clipped": ("imported", _add_clip_box),
    "labeled": ("home", _labels),
    "frames": ("home", _frames),
}
_WITH_FILES = {"moved": _lose_bake, "unused": _bring_bake, "interrupted": _interrupt}
