# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that panels and operators use the scene's volume, whatever else is selected."""

import bpy
from blends import save
from leaflight_addon.operators import background, jobs
from leaflight_addon.operators.checks import active_volume
from leaflight_addon.ui import bake_panel
from tools import error_of


def _activate(obj):
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()


def check_a_click_on_a_wall_leaves_the_volume(boxed):
    _activate(boxed)
    for obj in (bpy.data.objects["floor"], bpy.context.scene.camera, None):
        _activate(obj)
        assert active_volume(bpy.context) == boxed
        assert bake_panel.LEAFLIGHT_PT_bake.poll(bpy.context)
    _activate(bpy.data.objects["floor"])
    bpy.ops.leaflight.bake()
    assert boxed.leaflight.bake_id


def check_of_two_volumes_the_last_active_one_counts(boxed, tmp_path):
    second = boxed.copy()
    second.data = boxed.data.copy()
    bpy.context.scene.collection.objects.link(second)
    wall = bpy.data.objects["floor"]
    for volume in (second, boxed, second):
        _activate(volume)
        _activate(wall)
        assert active_volume(bpy.context) == volume
    name = second.name
    save(tmp_path / "scene.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    _activate(bpy.data.objects["floor"])
    assert active_volume(bpy.context).name == name
    bpy.data.objects.remove(bpy.data.objects[name])
    assert active_volume(bpy.context).leaflight.is_volume
    for obj in [obj for obj in bpy.data.objects if obj.leaflight.is_volume]:
        bpy.data.objects.remove(obj)
    assert active_volume(bpy.context) is None
    assert "import a volume first" in error_of(bpy.ops.leaflight.bake)


def check_a_dialog_ends_with_its_file():
    """Checks that Blender calls cancel() of an open dialog when another file is opened."""
    background.BackgroundOperator().cancel(bpy.context)
    assert jobs.running() is None
