# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulated user input: keys and the mouse over the viewport, the file browser, dialogs.

Each function is a generator for stepwise.run(). Waits are counted in steps, in which Blender
handles all events and draws. Their duration does not matter.
"""

import bpy
import mathutils
from bpy_extras import view3d_utils
import stepwise
from leaflight_addon.stage import viewport

# Keys without a function in Blender, for operators that users press as buttons.
PRESS, DELETE, NEW = "F19", "F20", "F21"

_STEP = 0.02


def steps(number):
    for _ in range(number):
        yield _STEP


# Number of the Blender window under the pointer.
_window = 0


def use_window(number):
    global _window
    _window = number


def window():
    return bpy.context.window_manager.windows[_window]


def areas(kind):
    return [area for area in window().screen.areas if area.type == kind]


def view():
    return areas("VIEW_3D")[0]


def region(kind="WINDOW"):
    return next(region for region in view().regions if region.type == kind)


def in_view():
    """Returns a context of the viewport, like that of a button in it."""
    return bpy.context.temp_override(window=window(), area=view(), region=region())


def volume():
    """Returns the first volume of the scene, or None."""
    return next((obj for obj in bpy.context.scene.objects if obj.leaflight.is_volume), None)


def lamp():
    """Returns a lamp that lights the scene."""
    objects = bpy.context.scene.objects
    return next(obj for obj in objects if obj.type == "LIGHT" and not obj.hide_render)


def press(operator):
    """Calls an operator like a button in the viewport."""
    with in_view():
        operator("INVOKE_DEFAULT")


def draw_quickly():
    """Switches off effects that take seconds per picture without a graphics card."""
    bpy.context.preferences.system.viewport_aa = "OFF"
    viewport._show_materials = lambda _shading: None


def stage_file(path, low, high, isovalue):
    """Imports and stages a file, for a bake with few texels and coarsely lit walls."""
    with in_view():
        bpy.ops.leaflight.import_volume(filepath=str(path))
        settings = volume().leaflight
        settings.use_resolution, settings.resolution, settings.error = True, 9, 50.0
        settings.low, settings.high, settings.isovalue = low, high, isovalue
        bpy.ops.leaflight.stage()
        settings.use_time_limit, settings.time_limit = True, 1.0


def select_volume():
    """Selects only the volume, and binds the key DELETE to deletion."""
    bind(DELETE, "object.delete", {"confirm": False})
    with in_view():
        bpy.ops.object.select_all(action="DESELECT")
        volume().select_set(True)
        bpy.ops.ed.undo_push(message="Selected")


def render():
    """Presses Render Image, for a small picture by Cycles."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 16
    press(bpy.ops.render.render)


def clear_scene():
    """Removes the first objects."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


def bind(key, operator, options):
    """Binds a key to an operator with these options, and to no other operator."""
    keymap = bpy.context.window_manager.keyconfigs.addon.keymaps.new("Window", space_type="EMPTY")
    for item in [item for item in keymap.keymap_items if item.type == key]:
        keymap.keymap_items.remove(item)
    item = keymap.keymap_items.new(operator, key, "PRESS")
    for name, value in options.items():
        setattr(item.properties, name, value)


def event(kind, value, x=0.5, y=0.5, **modifiers):
    """Sends an event at shares of the width and height of the viewport, or of the area that
    covers it.
    """
    area = max(window().screen.areas, key=lambda area: area.width * area.height)
    area = next(iter(areas("FILE_BROWSER")), next(iter(areas("VIEW_3D")), area))
    event_at(kind, value, area.x + x * area.width, area.y + y * area.height, **modifiers)


def event_at(kind, value, x, y, **modifiers):
    """Sends an event at a pixel of the window."""
    window().event_simulate(type=kind, value=value, x=int(x), y=int(y), **modifiers)


def tap(key, x, y):
    """Presses and releases a key at a pixel of the window."""
    event_at(key, "PRESS", x, y)
    event_at(key, "RELEASE", x, y)


def key(name, **modifiers):
    event("MOUSEMOVE", "NOTHING")
    yield from steps(1)
    event(name, "PRESS", **modifiers)
    event(name, "RELEASE", **modifiers)
    yield from steps(3)


def drag(start, end, height):
    """Drags with the left button between two shares of the viewport's width."""
    event("MOUSEMOVE", "NOTHING", start, height)
    yield from steps(2)
    event("LEFTMOUSE", "PRESS", start, height)
    yield from steps(2)
    event("MOUSEMOVE", "NOTHING", end, height)
    yield from steps(2)
    event("LEFTMOUSE", "RELEASE", end, height)
    yield from steps(2)


def place_of(obj):
    """Returns the middle of an object, as shares of the viewport's width and height."""
    area = areas("VIEW_3D")[0]
    region = next(part for part in area.regions if part.type == "WINDOW")
    corners = [obj.matrix_world @ mathutils.Vector(corner) for corner in obj.bound_box]
    middle = sum(corners, mathutils.Vector()) / len(corners)
    space = area.spaces.active.region_3d
    at = view3d_utils.location_3d_to_region_2d(region, space, middle)
    return (
        (region.x - area.x + at[0]) / area.width,
        (region.y - area.y + at[1]) / area.height,
    )


def choose(path):
    """Chooses a file, or a folder and the proposed name, in the file browser."""
    parameters = areas("FILE_BROWSER")[0].spaces.active.params
    parameters.directory = f"{path if path.is_dir() else path.parent}/".encode()
    if not path.is_dir():
        parameters.filename = path.name
    yield from steps(3)
    yield from key("RET")


def browser_is_open():
    found = areas("FILE_BROWSER")
    return bool(found) and found[0].spaces.active.active_operator is not None


def press_browser():
    """Presses the button of the file browser once it is open."""
    yield from stepwise.until(browser_is_open)
    yield from stepwise.wait(2.0)
    with bpy.context.temp_override(window=window(), area=areas("FILE_BROWSER")[0]):
        bpy.ops.file.execute()
