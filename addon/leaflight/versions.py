# SPDX-License-Identifier: GPL-3.0-or-later
"""The differences between the versions of Blender, for the add-on: no other module looks at them.

What the add-on shares with the package's own scenes for Cycles is in
leaflight.measure.blender_versions.
"""

import blf
import bpy
from leaflight import LeaflightError
from leaflight.measure import blender_versions

fcurves = blender_versions.fcurves
give_nodes = blender_versions.give_nodes
node_tree = blender_versions.node_tree
set_loop_starts = blender_versions.set_loop_starts
set_normals = blender_versions.set_normals

# Of a path property whose paths may be relative to the .blend; 4.5 and later need this option.
RELATIVE_PATH = {"ANIMATABLE"}
if bpy.app.version >= (4, 5, 0):
    RELATIVE_PATH |= {"PATH_SUPPORTS_BLEND_RELATIVE"}

# Grease pencil is GPENCIL before 4.3.
UNSEEN_TYPES = {
    "EMPTY",
    "CAMERA",
    "ARMATURE",
    "LATTICE",
    "SPEAKER",
    "GPENCIL",
    "GREASEPENCIL",
    "LIGHT_PROBE",
}


def light_units():
    """The LightUnits of this Blender. Raises LeaflightError."""
    units = blender_versions.light_units(bpy.app.version)
    if units is None:
        raise LeaflightError("Leaflight needs Blender 3.4 or later.")
    return units


def lights_are_checked():
    return bpy.app.version[:2] in blender_versions.CHECKED


def casts_shadow(light):
    """Until 4.1 Cycles has a switch of its own, and ignores the light's."""
    return getattr(light.cycles, "cast_shadow", light.use_shadow)


def temperature_color(light):
    """The color (r, g, b) that a temperature gives a light, from 4.4 on."""
    return tuple(light.temperature_color) if getattr(light, "use_temperature", False) else (1, 1, 1)


def exposure(light):
    """In stops, from 4.4 on."""
    return getattr(light, "exposure", 0.0)


def is_normalized(light):
    """Whether a light's power is that of all of it; from 4.4 on it may be that of a unit area."""
    return getattr(light, "normalize", True)


def falls_off_softly(light):
    """Whether E = I / (d^2 + r^2) at the distance d from a point light of radius r."""
    always = light_units().soft_points
    return light.use_soft_falloff if always is None else always


def harden_falloff(light):
    """Lets E = I / d^2 at the distance d from a point light, where Blender offers that."""
    if light_units().soft_points is None:
        light.use_soft_falloff = False


def links_light(obj):
    """Whether a light or mesh lights or shades only some objects, from 4.0 on."""
    linking = getattr(obj, "light_linking", None)
    return linking is not None and (
        linking.receiver_collection is not None or linking.blocker_collection is not None
    )


def working_space():
    """The linear colors that renders compute in; a choice of the file's from 5.0 on."""
    space = getattr(bpy.data, "colorspace", None)
    return "Linear Rec.709" if space is None else space.working_space


def do_not_sample_as_light(material):
    """Paths find what emits by themselves; as a light of many triangles it would add noise."""
    if hasattr(material.cycles, "emission_sampling"):  # from 3.5 on
        material.cycles.emission_sampling = "NONE"
    else:
        material.cycles.sample_as_light = False


def let_through(material, translucent, among, cut):
    """Lets Eevee show what lies behind a material: through all of it, or where it is cut away.

    Of a translucent surface its nearest layer alone is drawn, without grain; of several, which
    lie within each other (among), all layers, with grain, since Eevee sorts objects by their
    origins alone.
    """
    blended = translucent and not among
    if hasattr(material, "surface_render_method"):  # from 4.2 on
        material.surface_render_method = "BLENDED" if blended else "DITHERED"
        material.use_transparency_overlap = False
        return
    grained = "HASHED" if translucent else "CLIP" if cut else "OPAQUE"
    material.blend_method = "BLEND" if blended else grained
    material.shadow_method = grained
    material.show_transparent_back = False


def principled_glass_color(base):
    """What of each color passes a surface of Principled glass: from 4.0 on two make the base."""
    if bpy.app.version < (4, 0, 0):
        return base
    return tuple(min(x, 1.0) ** 0.5 for x in base)


def principled_is_lambertian(shader):
    """Whether its diffuse part is so, to 2 %; until 3.6 that depends on its Roughness."""
    roughness = shader.inputs["Roughness"]
    lambertian = not roughness.is_linked and abs(roughness.default_value - 0.5) < 0.1
    return bpy.app.version >= (4, 0, 0) or lambertian


def principled_metal_edges(shader, base):
    """Whether a Principled metal has another color at grazing angles; until 3.6 by its Specular."""
    if bpy.app.version < (4, 0, 0):
        return min(base) < 1 and shader.inputs["Specular"].default_value > 0
    tint = shader.inputs["Specular Tint"]
    return min(base) < 1 or tint.is_linked or min(tint.default_value[:3]) < 1


def mesh_storage():
    """How a mesh lies in memory: "STRUCTS" in 3.4, "ATTRIBUTES" from 4.2 on, None in between."""
    if bpy.app.version[:2] == (3, 4):
        return "STRUCTS"
    return "ATTRIBUTES" if bpy.app.version >= (4, 2, 0) else None


def is_animated(owner, path):
    """Whether a keyframe or a driver moves the property of a data-block at this path."""
    data = owner.animation_data
    curves = [*(data.drivers if data else ()), *fcurves(owner)]
    return any(curve.data_path == path for curve in curves)


def image_format(**values):
    """Settings of an image to write; from 5.0 on a medium comes first, and decides the formats."""
    medium = {"media_type": "IMAGE"}
    known = bpy.types.ImageFormatSettings.bl_rna.properties
    return {**(medium if "media_type" in known else {}), **values}


def plain_view():
    """Settings of a view that shows linear colors through the sRGB curve, and nothing else."""
    view = {"view_transform": "Standard", "look": "None", "gamma": 1.0, "use_curve_mapping": False}
    known = bpy.types.ColorManagedViewSettings.bl_rna.properties
    return {**view, **({"use_white_balance": False} if "use_white_balance" in known else {})}


def new_geometry_tree(name):
    """Geometry nodes with one geometry going in and one coming out."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    if hasattr(tree, "interface"):  # from 4.0 on
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket(
                "Geometry", in_out=direction, socket_type="NodeSocketGeometry"
            )
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    return tree


def flat_shader(dimensions=2):
    """The name of the builtin shader that draws in one color; there were two until 3.6."""
    return f"{dimensions}D_UNIFORM_COLOR" if bpy.app.version < (4, 0, 0) else "UNIFORM_COLOR"


def text_size(font, size):
    """The size of text in pixels; until 3.6 a resolution goes with it."""
    # 72 pixels an inch are as many as points.
    resolution = (72,) if bpy.app.version < (4, 0, 0) else ()
    blf.size(font, size, *resolution)


def has_denoiser():
    """Whether Cycles was built with OpenImageDenoise; those of Debian are not."""
    try:
        import _cycles
    except ImportError:
        return False
    return getattr(_cycles, "with_openimagedenoise", False)


def show_photographically(view):
    """Settings of a view that keep bright colors distinct instead of clipping them to white."""
    _choose(view, "view_transform", ("Filmic", "AgX"))
    # 4.0 and later name the view that a look belongs to where it does not suit all.
    _choose(view, "look", ("Medium High Contrast", "Filmic - Medium High Contrast", "None"))
    view.gamma, view.use_curve_mapping = 1.0, False


def _choose(owner, name, values):
    """Gives a property the first of these values that it accepts."""
    for value in values:
        try:
            setattr(owner, name, value)
            return
        except TypeError:
            continue


def choose_sidebar_tab(area, category):
    """Opens the sidebar of a viewport at a tab; before 4.2 only users can choose one."""
    region = _sidebar(area)
    if region is None or not hasattr(region, "active_panel_category"):
        return
    area.spaces.active.show_region_ui = True
    if _choose_tab(area, category) or bpy.app.background:
        return
    tries = iter(range(50))

    def try_again():
        """A sidebar that was closed until now has its tabs once it has been drawn."""
        shown = any(area in window.screen.areas[:] for window in bpy.context.window_manager.windows)
        done = not shown or _choose_tab(area, category) or next(tries, None) is None
        return None if done else 0.1

    bpy.app.timers.register(try_again, first_interval=0.1)


def _sidebar(area):
    return next((region for region in area.regions if region.type == "UI"), None)


def _choose_tab(area, category):
    """Whether the sidebar shows the tab now."""
    region = _sidebar(area)
    try:
        region.active_panel_category = category
    except (AttributeError, TypeError):
        return False
    return region.active_panel_category == category


def draw_progress(layout, fraction, text):
    """How far work is: a bar from 4.0 on, a line of text before."""
    if hasattr(layout, "progress"):
        layout.progress(factor=fraction, text=text)
    else:
        layout.label(text=text, icon="TIME")
