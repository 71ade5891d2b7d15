# SPDX-License-Identifier: GPL-3.0-or-later
"""The material of an isosurface: baked radiance of a bake or pass, or the unlit surface.

Each material is built once and then keeps its nodes. A new isovalue, opacity, color or pass only
changes values in it. Blender compiles new nodes and meanwhile shows a material without baked light.

Blender compiles the nodes of a material when it first draws them. Until then it draws the material
gray, lit by lamps alone, so the first light of a bake would look worse than none. Blender compiles
equal nodes only once. Triangles without area therefore have the materials before the first pass.
"""

import bpy

from .. import versions
from ..store import atlases, bake_files, cache, source_files
from . import display, exploded, isosurfaces, lamps, look, preview, shader, shader_graph, texture
from .isosurface import RADIANCE, RADIANCE_BACK

# Property of a material: the label for which it was built.
_BUILT = "leaflight_built"
# Property of a material: the shader_graph.View for which it was built.
_VIEW = "leaflight_view"
# Properties that refer to the materials of an isosurface.
_SLOTS = ("isosurface_material", "baked_material")


def material_of(obj, isovalue):
    """Returns the material for the state of an isosurface's mesh. Raises LeaflightError."""
    if RADIANCE not in obj.data.attributes:
        return isosurface_material(obj, isovalue)
    return _baked_material(obj, isovalue)


def may_replace(obj, material):
    """True if an object's material is None or from here, and not chosen by the user."""
    return material in (None, obj.leaflight.isosurface_material, obj.leaflight.baked_material)


def is_own(changed):
    """True if a data-block is a material that was built here, or its node tree."""
    if isinstance(changed, bpy.types.Material):
        return _BUILT in changed
    return isinstance(changed, bpy.types.ShaderNodeTree) and any(
        material.node_tree == changed and _BUILT in material for material in bpy.data.materials
    )


def show_opacity(obj, opacity):
    """Shows an opacity, which may be an animated value that the object does not have yet."""
    material = obj.data.materials[0] if obj.data.materials else None
    if material is not None and _BUILT in material and material.library is None:
        shader.set_opacity(material, opacity)


def is_recolored(obj):
    """True if an isosurface is lit by a bake but shows another color than was baked."""
    # A slot may be empty.
    materials = filter(None, obj.data.materials)
    return RADIANCE in obj.data.attributes and any(map(shader.is_recolored, materials))


def shows_its_view(obj):
    """True if the material of an isosurface was built for its present View."""
    materials = obj.data.materials
    view = materials[0].get(_VIEW) if materials and materials[0] is not None else None
    return view is None or view == repr(look.view_of(obj))


def take_off(obj):
    """Removes its own materials from an isosurface.

    Returns {property, or None for the mesh: name of the material}.
    """
    names = {}
    for slot in _SLOTS:
        material = getattr(obj.leaflight, slot)
        if material is None or material.library is not None:
            continue
        names[slot] = material.name
        if obj.data.materials and obj.data.materials[0] == material:
            names[None] = material.name
            obj.data.materials[0] = None
        setattr(obj.leaflight, slot, None)
    return names


def put_on(obj, names):
    """Restores the result of take_off(), if the materials exist and no others took their place."""
    for slot, name in names.items():
        material = bpy.data.materials.get((name, None))
        if slot is None:
            if obj.data.materials and obj.data.materials[0] is None:
                obj.data.materials[0] = material
        elif getattr(obj.leaflight, slot) is None:
            setattr(obj.leaflight, slot, material)


def remove_baked(obj):
    """Removes the material of passes without a bake, unless the mesh still has it."""
    material = obj.leaflight.baked_material
    if material is not None and material not in obj.data.materials[:]:
        bpy.data.materials.remove(material)


def isosurface_material(obj, isovalue):
    """Returns the unlit material of an isosurface, as the bake models it."""
    volume = display.volume_object(obj)
    scattering, ior = volume.leaflight.isosurface_scattering, volume.leaflight.isosurface_ior
    emission, view = isosurfaces.emission_of(volume), look.view_of(obj)

    def build(material):
        shader.build_isosurface(material, scattering, ior, emission, view)

    label = f"{scattering} {ior} {emission} {view!r}"
    material = _material(obj, "isosurface_material", label, build)
    shader.set_albedo(material, look.albedo_at(obj, isovalue))
    return material


def shading_in_use(settings):
    """Returns (shading mode, reason if it is not the chosen one, or an empty text)."""
    if settings.shading != "ATLAS" or not settings.bake_id:
        return settings.shading, ""
    if settings.frames > 1:
        return "ATTRIBUTE", "Vertex attribute: a volume texture would hold only one frame"
    if source_files.values_changed(settings):
        return "ATTRIBUTE", "Vertex attribute: a volume texture holds the data as they were baked"
    if lamps.factors_of(settings):
        return "ATTRIBUTE", "Vertex attribute: a volume texture holds the lamps as they were baked"
    if exploded.axis_of(settings.id_data) is not None:
        return "ATTRIBUTE", "Vertex attribute: a volume texture does not move with parts"
    if texture.is_colored(settings.id_data):
        return "ATTRIBUTE", "Vertex attribute: a volume texture would blur the colors"
    if settings.atlas_columns > 0:
        return "ATLAS", ""
    size = atlases.LARGEST_ATLAS
    return "ATTRIBUTE", f"Vertex attribute: a volume texture would exceed {size} x {size} pixels"


def look_after_images(obj, bake_path):
    """Finds the atlases of an isosurface's material beside their bake.

    Raises LeaflightError.
    """
    volume, material = display.volume_object(obj), obj.leaflight.baked_material
    if material is None or material.library is not None:
        return
    settings = volume.leaflight
    for image in shader.images_of(material):
        back = bool(image.get(shader.BACK))
        if image.get(shader.ATLAS) == atlases.label(settings.bake_id, settings.bake_index, back):
            _atlas_image(volume, bake_path, back)


def _baked_material(obj, isovalue):
    volume = display.volume_object(obj)
    settings, view = volume.leaflight, look.view_of(obj)
    # Passes use attributes, because an atlas needs a file.
    in_passes = preview.of(volume) is not None
    mode = "ATTRIBUTE" if in_passes else shading_in_use(settings)[0]
    back = RADIANCE_BACK in obj.data.attributes

    def build(material):
        versions.do_not_sample_as_light(material)
        if mode == "ATTRIBUTE":
            shader.build_attribute(material, RADIANCE, RADIANCE_BACK if back else None, view)
            return
        grid, path = cache.grid_of(volume), bake_files.locate(volume)
        sides = [_atlas_image(volume, path, s) for s in ((False, True) if back else (False,))]
        matrix = shader.texel_from_object(cache.volume_of(volume), grid.resolution)
        columns = settings.atlas_columns
        shader.build_atlas(material, sides, grid.resolution, columns, matrix, view)

    # The label rebuilds materials of old files, whose nodes cannot change colors. Nodes that read
    # an attribute are the same for every bake.
    light = f"{settings.bake_id} {settings.bake_index}" if mode == "ATLAS" else ""
    label = f"{mode} {light} {back} recolored {view!r}"
    material = _material(obj, "baked_material", label, build)
    shader.set_albedo(material, look.albedo_at(obj, isovalue))
    shader.set_recoloring(material, *look.recoloring(obj, isovalue))
    return material


def _atlas_image(volume, bake_path, back):
    """Returns the image of an atlas. Its file is written again unless it holds this bake."""
    identifier, index = volume.leaflight.bake_id, volume.leaflight.bake_index
    path, written = atlases.require(
        lambda: cache.grid_of(volume), bake_path, identifier, index, back
    )
    return shader.atlas_image(path, atlases.label(identifier, index, back), back, written)


def _material(obj, slot, label, build):
    """Returns the material in a slot of the settings, built again only for a new label.

    A duplicate of the object gets a separate material.
    """
    settings = obj.leaflight
    material = getattr(settings, slot)
    others = (other.leaflight for other in bpy.data.objects if other != obj)
    taken = any(getattr(other, slot) == material for other in others)
    if material is None or taken or (material.library is not None and obj.library is None):
        material = bpy.data.materials.new(f"{obj.name} {slot.partition('_')[0].title()}")
        setattr(settings, slot, material)
    # Materials of an earlier Leaflight have no view.
    if material.get(_BUILT) != label or _VIEW not in material:
        build(material)
        material[_BUILT], material[_VIEW] = label, repr(look.view_of(obj))
    look_of = obj.leaflight_look
    shader.set_opacity(material, look_of.opacity)
    shader.set_coat(material, look_of.gloss, look_of.roughness)
    return material


_FIRST_LIGHT, _FIRST_NAME = "first light", "Leaflight Materials"


def prepare_first_light(volumes, both_sides, walls):
    """Makes Blender compile the materials that a bake will give to unlit isosurfaces.

    volumes: the objects to bake. walls: True if their walls will be lit.
    """
    isosurfaces = [obj for volume in volumes for obj in display.surfaces_of(volume)]
    unlit = [obj for obj in isosurfaces if RADIANCE not in obj.data.attributes]
    if not unlit or any(map(_is_first_light, bpy.data.objects)):
        return
    kinds = [(both_sides, look.view_of(obj)) for obj in unlit]
    if walls:
        kinds.append((True, shader_graph.View()))
    mesh = bpy.data.meshes.new(_FIRST_NAME)
    corners = range(3 * len(kinds))
    mesh.from_pydata([(0, 0, 0) for _ in corners], [], [corners[i : i + 3] for i in corners[::3]])
    for index, (back, view) in enumerate(kinds):
        material = bpy.data.materials.new(_FIRST_NAME)
        shader.build_attribute(material, RADIANCE, RADIANCE_BACK if back else None, view)
        mesh.materials.append(material)
        mesh.polygons[index].material_index = index
    obj = display.new_display(unlit[0], _FIRST_LIGHT, _FIRST_NAME, mesh)
    obj.hide_select = obj.hide_render = True
    obj.location = unlit[0].matrix_world.translation


def forget_first_light():
    """Removes the objects of prepare_first_light(), even if undo or a file restored them."""
    for obj in list(filter(_is_first_light, bpy.data.objects)):
        _remove_first_light(obj)


def _remove_first_light(obj):
    bpy.data.batch_remove((*obj.data.materials, obj.data, obj))


def _is_first_light(obj):
    return obj.library is None and display.is_display(obj, _FIRST_LIGHT)
