# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks lamps whose strength changes after the bake: the display follows at once."""

import bpy
import numpy as np
import pytest
from blends import reopened
from leaflight_addon.show import display, lamps
from leaflight_addon.store import cache
from leaflight_addon.ui import bake_panel
from passes import drawn
from tools import add_light, change, close, colors_of, error_of, render_exr, vertices_of

EXACT = "Lamps have changed since the bake: their light is scaled, which is exact"
SCALED = "Lamps have changed since the bake: direct light is exact, indirect light is scaled"


@pytest.fixture
def lit(passes):
    """Bakes a volume with its walls in passes; vertex attributes show the light."""
    passes.leaflight.error = 20.0
    passes.leaflight.light_walls = True
    bpy.ops.leaflight.bake()
    return passes


def lamp():
    return bpy.data.objects["lamp"].data


def walls():
    found = [obj for obj in bpy.context.scene.objects if display.is_display(obj, "wall")]
    assert len(found) > 3
    return found


def colors(obj):
    """Returns the colors of the isosurface and the colors of all walls."""
    return colors_of(obj), np.concatenate([colors_of(wall) for wall in walls()])


def assert_scaled(obj, before, factor, tolerance=1e-4):
    for now, then in zip(colors(obj), before):
        assert then.max() > 0.05
        close(now, np.multiply(then, factor), tolerance * then.max() * max(1.0, np.max(factor)))


def check_what_is_shown_follows_one_lamp(uncut, lit):
    before, vertices = colors(lit), vertices_of(lit)
    mode = drawn(bake_panel.LEAFLIGHT_PT_bake_details)
    assert EXACT not in mode and SCALED not in mode
    lamp().energy *= 3.0
    bpy.context.view_layer.update()
    assert_scaled(lit, before, 3.0)
    close(vertices_of(lit), vertices, 0)
    assert change(lit) == "" and EXACT in drawn(bake_panel.LEAFLIGHT_PT_bake_details)
    energy = lamp().energy
    lamp().color = (1.0, 0.5, 0.25)
    bpy.context.view_layer.update()
    assert_scaled(lit, before, (3.0, 1.5, 0.75))
    assert "volume texture" in " ".join(drawn(bake_panel.LEAFLIGHT_PT_bake_details))
    # Change the isovalue and restore it.
    lit.leaflight.isovalue = 45.0
    points = vertices_of(lit)
    close(
        colors_of(lit), lamps.light_of(lit).grid.lookup(cache.volume_of(lit).field(), points), 1e-4
    )
    lit.leaflight.isovalue = 50.0
    assert_scaled(lit, before, (3.0, 1.5, 0.75))
    # Switch the lamp off and on again.
    bpy.data.objects["lamp"].hide_render = True
    bpy.context.view_layer.update()
    assert_scaled(lit, before, 0.0)
    assert change(lit) == ""
    bpy.data.objects["lamp"].hide_render = False
    lamp().color, lamp().energy = (1.0, 1.0, 1.0), energy / 3.0
    bpy.context.view_layer.update()
    assert_scaled(lit, before, 1.0)
    assert lamps.light_of(lit) is cache.bake_of(lit)
    assert change(lit) == "" and EXACT not in drawn(bake_panel.LEAFLIGHT_PT_bake_details)


def check_a_lamp_that_is_moved_or_of_another_shape_needs_a_bake(lit):
    before = colors(lit)
    lamp().energy *= 2.0
    size = lamp().size
    lamp().size = 1.5 * size
    bpy.context.view_layer.update()
    assert "scene has changed" in change(lit)
    assert_scaled(lit, before, 1.0)
    lamp().size = size
    bpy.data.objects["lamp"].location.z -= 1.0
    bpy.context.view_layer.update()
    assert "scene has changed" in change(lit)
    assert_scaled(lit, before, 1.0)
    bpy.data.objects["lamp"].location.z += 1.0
    bpy.context.view_layer.update()
    assert change(lit) == ""
    assert_scaled(lit, before, 2.0)


def check_of_two_lamps_each_follows_by_itself(passes):
    lamp_object = bpy.data.objects["lamp"]
    middle = np.array(lamp_object.location) - (0, 0, 2)
    side = add_light("POINT", tuple(middle - (8, 8, 0)), energy=4000.0, color=(1.0, 0.5, 0.0))
    passes.leaflight.error = 20.0
    bpy.ops.leaflight.bake()
    before = colors_of(passes)
    side.data.energy *= 0.5
    bpy.context.view_layer.update()
    assert SCALED in drawn(bake_panel.LEAFLIGHT_PT_bake_details) and change(passes) == ""
    bake = cache.bake_of(passes).relit({side.name: 0.5})
    points = vertices_of(passes)
    expected = bake.grid.lookup(cache.volume_of(passes).field(), points)
    close(colors_of(passes), expected, 1e-4 * expected.max())
    assert np.abs(colors_of(passes) - before).max() > 0.01 * before.max()
    # A channel that was black in the bake cannot be scaled.
    side.data.color = (1.0, 0.5, 1.0)
    bpy.context.view_layer.update()
    assert "scene has changed" in change(passes)


def check_undo_files_frames_and_renders(lit, tmp_path):
    before = colors(lit)
    lamp().energy *= 2.0
    bpy.context.view_layer.update()
    obj = reopened(tmp_path / "scene.blend")
    assert_scaled(obj, before, 2.0)
    assert change(obj) == ""
    energy = lamp().energy
    lamp().energy = 0.5 * energy
    bpy.context.view_layer.update()
    # The file stores half precision.
    assert_scaled(obj, before, 1.0, 1e-3)
    # Keyframes.
    for frame, factor in ((1, 0.5), (11, 1.5)):
        lamp().energy = factor * energy
        lamp().keyframe_insert("energy", frame=frame)
    bpy.context.scene.frame_set(11)
    assert_scaled(obj, before, 3.0, 1e-3)
    bpy.context.scene.frame_set(1)
    assert_scaled(obj, before, 1.0, 1e-3)
    bpy.context.scene.frame_set(1)
    dim = render_exr(tmp_path / "dim.exr")[..., :3]
    bpy.context.scene.frame_set(11)
    bright = render_exr(tmp_path / "bright.exr")[..., :3]
    lit_pixels = dim.max(axis=-1) > 0.02
    assert lit_pixels.sum() > 100
    ratio = bright[lit_pixels].sum(axis=-1) / dim[lit_pixels].sum(axis=-1)
    # Edges pass through pixels, and brighter light splits the mesh once more at edges of shadows.
    assert np.quantile(np.abs(ratio - 3.0), 0.98) < 0.005
    off = (bright - 3 * dim)[lit_pixels]
    assert np.sqrt((off**2).mean()) < 0.002 * bright.max()


def check_exports_show_it_and_continue_does_not_go_on(uncut, lit, tmp_path):
    bpy.ops.leaflight.export(filepath=str(tmp_path / "dim.glb"))
    lamp().energy *= 2.0
    bpy.context.view_layer.update()
    bpy.ops.leaflight.export(filepath=str(tmp_path / "bright.glb"))
    dim, bright = (tmp_path / f"{name}.glb" for name in ("dim", "bright"))
    assert dim.read_bytes() != bright.read_bytes()
    assert "Lamps have changed" in error_of(bpy.ops.leaflight.continue_bake)
    # A new bake uses the current strengths.
    before = colors_of(lit)
    bpy.ops.leaflight.bake()
    assert lamps.factors_of(lit.leaflight) == ()
    assert abs(colors_of(lit).mean() / before.mean() - 1) < 0.1
