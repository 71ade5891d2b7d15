# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens all panels of Leaflight in the sidebar of the viewport, and records when they are drawn."""

import bpy
import hand
from leaflight_addon import PANELS, registration, versions
from leaflight_addon.operators import jobs

# Times at which the panels were drawn.
_drawn = []


def show_all_panels():
    """Removes all other tabs, except Blender's innermost one, and opens all panels."""
    registration.unregister(PANELS)
    for cls in list(bpy.types.Panel.__subclasses__()):
        place = [getattr(cls, name, None) for name in ("bl_space_type", "bl_region_type")]
        if cls.__name__.startswith("LEAFLIGHT"):
            cls.bl_options = set(getattr(cls, "bl_options", ())) - {"DEFAULT_CLOSED"}
        elif place == ["VIEW_3D", "UI"]:
            try:
                bpy.utils.unregister_class(cls)
            except RuntimeError:
                pass
    registration.register(PANELS)
    bpy.types.LEAFLIGHT_PT_volume.append(lambda *_: _drawn.append(True))


def is_drawn():
    """Opens the tab of Leaflight if another one is open; returns whether it was drawn."""
    hand.view().spaces.active.show_region_ui = True
    versions.choose_sidebar_tab(hand.view(), "Leaflight")
    _drawn.clear()
    jobs.redraw_panels()
    yield from hand.steps(3)
    region = next(region for region in hand.view().regions if region.type == "UI")
    x, top = region.x + region.width - 14, region.y + region.height
    # Blender's own tab is above ours.
    for y in range(top - 20, top - 200, -12):
        if _drawn:
            break
        hand.window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        for value in ("PRESS", "RELEASE"):
            hand.window().event_simulate(type="LEFTMOUSE", value=value, x=x, y=y)
        yield from hand.steps(3)
    return bool(_drawn)
