# SPDX-License-Identifier: GPL-3.0-or-later
"""The differences between Blender versions. No other module of the add-on depends on them.

Functions that the package needs as well are in leaflight.measure.blender_versions.
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

# Options of a property whose path may be relative to the .blend. Blender 4.5 needs a new one.
RELATIVE_PATH = {"ANIMATABLE"}
if bpy.app.version >= (4, 5, 0):
    RELATIVE_PATH |= {"PATH_SUPPORTS_BLEND_RELATIVE"}

# Types of objects that a bake ignores. Grease pencil is GPENCIL before 4.3.
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
    """Returns the LightUnits of this Blender. Raises LeaflightError."""
    units = blender_versions.light_units(bpy.app.version)
    if units is None:
        raise LeaflightError("Leaflight needs Blender 3.4 or later.")
    return units


def lights_are_checked():
    return bpy.app.version[:2] in blender_versions.CHECKED


def casts_shadow(light):
    """True if a light casts shadows. Up to 4.1 Cycles has a separate property for it."""
    return getattr(light.cycles, "cast_shadow", light.use_shadow)


def temperature_color(light):
    """Returns the color (r, g, b) of a light's temperature, which exists since 4.4."""
    return tuple(light.temperature_color) if getattr(light, "use_temperature", False) else (1, 1, 1)


def exposure(light):
    """Returns a light's exposure in stops, which exists since 4.4."""
    return getattr(light, "exposure", 0.0)


def is_normalized(light):
    """True if a light's power is the total. Since 4.4 it may be the power per area."""
    return getattr(light, "normalize", True)


def falls_off_softly(light):
    """True if E = I / (d^2 + r^2) at the distance d from a point light of radius r."""
    always = light_units().soft_points
    return light.use_soft_falloff if always is None else always


def harden_falloff(light):
    """Sets E = I / d^2 at the distance d from a point light, if Blender offers the choice."""
    if light_units().soft_points is None:
        light.use_soft_falloff = False


def links_light(obj):
    """True if light linking, which exists since 4.0, limits an object to lighting some others."""
    linking = getattr(obj, "light_linking", None)
    return linking is not None and (
        linking.receiver_collection is not None or linking.blocker_collection is not None
    )


def working_space():
    """Returns the working color space of renders. Since 5.0 each file has a choice."""
    space = getattr(bpy.data, "colorspace", None)
    return "Linear Rec.709" if space is None else space.working_space


def do_not_sample_as_light(material):
    """Excludes a material from light sampling, because paths hit it and samples would add noise."""
    if hasattr(material.cycles, "emission_sampling"):  # from 3.5 on
        material.cycles.emission_sampling = "NONE"
    else:
        material.cycles.sample_as_light = False


def let_through(material, translucent, among, cut):
    """Makes a material transparent in Eevee: everywhere, or only where it is cut away.

    A single translucent surface shows only its nearest layer, without noise. Several surfaces
    within each other (among) show all layers with noise, because Eevee sorts objects by origin.
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
    """Returns the color of one pass through Principled glass.

    Since 4.0 two passes give the base color.
    """
    if bpy.app.version < (4, 0, 0):
        return base
    return tuple(min(x, 1.0) ** 0.5 for x in base)


def principled_is_lambertian(shader):
    """True if the diffuse part of a Principled BSDF is Lambertian, to 2 %.

    Up to 3.6 that depends on its Roughness.
    """
    roughness = shader.inputs["Roughness"]
    lambertian = not roughness.is_linked and abs(roughness.default_value - 0.5) < 0.1
    return bpy.app.version >= (4, 0, 0) or lambertian


def principled_metal_edges(shader, base):
    """True if a Principled metal has another color at grazing angles.

    Up to 3.6 that depends on its Specular.
    """
    if bpy.app.version < (4, 0, 0):
        return min(base) < 1 and shader.inputs["Specular"].default_value > 0
    tint = shader.inputs["Specular Tint"]
    return min(base) < 1 or tint.is_linked or min(tint.default_value[:3]) < 1


def mesh_storage():
    """Returns how Blender stores meshes: "STRUCTS" in 3.4, "ATTRIBUTES" since 4.2, else None."""
    if bpy.app.version[:2] == (3, 4):
        return "STRUCTS"
    return "ATTRIBUTES" if bpy.app.version >= (4, 2, 0) else None


def is_animated(owner, path):
    """True if keyframes or a driver animate the property of a data-block at this path."""
    data = owner.animation_data
    curves = [*(data.drivers if data else ()), *fcurves(owner)]
    return any(curve.data_path == path for curve in curves)


def keyed_value(owner, path, frame):
    """Returns the value of the keyframes of a property at a frame, None without keyframes."""
    curves = (curve for curve in fcurves(owner) if curve.data_path == path)
    return next((curve.evaluate(frame) for curve in curves), None)


def image_format(**values):
    """Returns the settings of an image file. Since 5.0 a media type must precede the format."""
    medium = {"media_type": "IMAGE"}
    known = bpy.types.ImageFormatSettings.bl_rna.properties
    return {**(medium if "media_type" in known else {}), **values}


def new_geometry_tree(name):
    """Returns geometry nodes with one input geometry and one output geometry."""
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
    """Returns the name of the builtin shader for one color. Up to 3.6 there were two."""
    return f"{dimensions}D_UNIFORM_COLOR" if bpy.app.version < (4, 0, 0) else "UNIFORM_COLOR"


def text_size(font, size):
    """Sets the size of text in pixels. Up to 3.6 Blender also needs a resolution."""
    # At 72 pixels per inch a point is a pixel.
    resolution = (72,) if bpy.app.version < (4, 0, 0) else ()
    blf.size(font, size, *resolution)


def has_denoiser():
    """True if Cycles was built with OpenImageDenoise, which Debian's builds lack."""
    try:
        import _cycles
    except ImportError:
        return False
    return getattr(_cycles, "with_openimagedenoise", False)


def show_photographically(view):
    """Sets a view that keeps bright colors distinct instead of clipping them to white."""
    _choose(view, "view_transform", ("Filmic", "AgX"))
    # Since 4.0 the name of a look includes its view transform if it does not fit all.
    _choose(view, "look", ("Medium High Contrast", "Filmic - Medium High Contrast", "None"))
    view.gamma, view.use_curve_mapping = 1.0, False


def _choose(owner, name, values):
    """Sets a property to the first of these values that it accepts."""
    for value in values:
        try:
            setattr(owner, name, value)
            return
        except TypeError:
            continue


def choose_sidebar_tab(area, category):
    """Opens the sidebar of a viewport at a tab. Before 4.2 only users can choose one."""
    region = _sidebar(area)
    if region is None or not hasattr(region, "active_panel_category"):
        return
    area.spaces.active.show_region_ui = True
    if _choose_tab(area, category) or bpy.app.background:
        return
    tries = iter(range(50))

    def try_again():
        """Chooses the tab, which a closed sidebar has only after its first draw."""
        shown = any(area in window.screen.areas[:] for window in bpy.context.window_manager.windows)
        done = not shown or _choose_tab(area, category) or next(tries, None) is None
        return None if done else 0.1

    bpy.app.timers.register(try_again, first_interval=0.1)


def _sidebar(area):
    return next((region for region in area.regions if region.type == "UI"), None)


def _choose_tab(area, category):
    """Chooses a tab. Returns True if the sidebar shows it."""
    region = _sidebar(area)
    try:
        region.active_panel_category = category
    except (AttributeError, TypeError):
        return False
    return region.active_panel_category == category


def draw_progress(layout, fraction, text):
    """Draws the progress of work: a bar since 4.0, a line of text before."""
    if hasattr(layout, "progress"):
        layout.progress(factor=fraction, text=text)
    else:
        layout.label(text=text, icon="TIME")
