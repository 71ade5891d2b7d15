# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport of a stage: lit, without overlays, and through the scene's camera."""

import bpy

from .. import versions
from ..operators import jobs


def show_stage(context):
    """Lights the viewport in use, or the largest viewport, and looks through the camera.

    Material Preview with the scene's lights and world shows baked colors as renders do. It uses the
    scene's exposure with any render engine.
    """
    _, area = _viewport(context)
    if area is None:
        return
    space = area.spaces.active
    _show_materials(space.shading)
    space.overlay.show_overlays = False
    versions.choose_sidebar_tab(area, "Leaflight")
    look_through_camera(context)


def show_light(context):
    """Switches the viewport in use to Material Preview if its shading shows no baked colors."""
    _, area = _viewport(context)
    if area is not None and area.spaces.active.shading.type in {"SOLID", "WIREFRAME"}:
        _show_materials(area.spaces.active.shading)


def _show_materials(shading):
    shading.type = "MATERIAL"
    shading.use_scene_lights = True
    shading.use_scene_world = True


def look_through_camera(context):
    """Shows the frame of the scene's camera in the same viewport."""
    window, area = _viewport(context)
    view = area.spaces.active.region_3d if area is not None else None
    if view is None or bpy.app.background:
        return
    view.view_perspective = "CAMERA"
    region = next(region for region in area.regions if region.type == "WINDOW")
    with context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.view_center_camera()


def _viewport(context):
    """Returns (window, area) of the viewport in use or the largest one, or (None, None)."""
    if context.area is not None and context.area.type == "VIEW_3D":
        return context.window, context.area
    return max(
        jobs.viewports(), key=lambda pair: pair[1].width * pair[1].height, default=(None, None)
    )


# Samples per pixel of Cycles, whose lamps are noisy before the bake, and of Eevee.
_CYCLES, _EEVEE = 64, 32


def suit_baked_light(scene):
    cycles = getattr(scene, "cycles", None)
    if cycles is not None:
        cycles.samples = min(cycles.samples, _CYCLES)
        cycles.use_denoising = versions.has_denoiser()
    eevee = scene.eevee
    eevee.taa_render_samples = min(eevee.taa_render_samples, _EEVEE)
