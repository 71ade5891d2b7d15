# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh object that shows one isosurface of its volume, lit by its bake.

The mesh remembers which surface it holds, so that a stale one is noticed after undo, redo and
loading a file: they bring back mesh and memory together.
"""

import bpy
import leaflight
import leaflight._core as _core
import numpy as np

from .. import versions
from ..store import atlases, bake_files, cache
from . import leaves, preview, shader

LeaflightError = leaflight.LeaflightError

# Colour attributes: what leaves the outer side of the surface, and the inner one where it is baked.
RADIANCE = "radiance"
RADIANCE_BACK = "radiance_back"
_SHOWN = "leaflight_shown"
_ISOVALUE = "leaflight_isovalue"
_BUILT = "leaflight_built"
_SETTLED = "leaflight_settled"
# Ends the label of a mesh that goes on settling.
_SO_FAR = " so far"

# Marks the materials of rounds of a bake, by the number of sides that they light.
_ROUND = {1: "leaflight_round", 2: "leaflight_round_sides"}

# Ends the label of a mesh that could not show what it should.
_FAILED = " failed"

# Full name of an object -> why its surface could not be shown, for the panel.
problems = {}

# Full name of an object -> the state in which the files of its bake were all right.
_looked_after = {}


def create(context, volume, size):
    """A mesh object in the active collection for the volume, its longest side `size` units long.

    The object's transform alone scales and places it: centred on the grid floor.
    """
    obj = new(context, volume.name)
    low, high = np.asarray(volume.field().bounds, np.float64)
    scale = size / float((high - low).max())
    centre = 0.5 * (low + high)
    obj.scale = (scale, scale, scale)
    obj.location = (-scale * centre[0], -scale * centre[1], -scale * low[2])
    return obj


def new(context, name):
    """An empty mesh object in the active collection."""
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    context.collection.objects.link(obj)
    return obj


def update(obj, isovalue):
    """Shows the isosurface, unless the mesh holds it already. A failure goes to `problems`."""
    _look_after_files(obj)
    label = _label(obj, isovalue)
    shown = obj.data.get(_SHOWN)
    # What failed is tried again once its problem may be gone: after loading, undo or relocating.
    if shown == label or (shown == label + _FAILED and obj.name_full in problems):
        return
    if obj.library is not None:
        problems[obj.name_full] = (
            f'"{obj.name}" is linked from another file and shows the isovalue that was saved '
            "there: make a library override of it to change or animate it."
        )
        return
    _own_mesh(obj)
    problems.pop(obj.name_full, None)
    vertices, triangles, radiance = np.empty((0, 3)), np.empty((0, 3)), {}
    try:
        vertices, _, triangles = contour(obj, isovalue)
        if is_lit(obj, isovalue):
            radiance = radiance_at(obj, vertices)
    except LeaflightError as error:
        problems[obj.name_full] = str(error)
        label += _FAILED
    fill(obj.data, vertices, triangles, radiance)
    if _SETTLED in obj.data:
        del obj.data[_SETTLED]
    obj.data[_SHOWN] = label
    obj.data[_ISOVALUE] = isovalue
    shade(obj)


def forget():
    """After loading a file, undo or saving: looks after the files of all bakes again."""
    _looked_after.clear()


def _look_after_files(obj):
    """Finds the bake of an object and its atlases where they are now, once for each state."""
    settings = obj.leaflight
    state = (settings.bake_id, settings.bake_index, settings.bake_path, bpy.data.filepath)
    if not settings.bake_id or _looked_after.get(obj.name_full) == state:
        return
    problems.pop(obj.name_full, None)
    try:
        path = bake_files.locate(obj)
        bake_files.remember(obj, path)
        material = settings.baked_material
        if material is not None and material.library is None:
            for image in shader.images_of(material):
                back = bool(image.get(shader.BACK))
                label = atlases.label(settings.bake_id, settings.bake_index, back)
                if image.get(shader.ATLAS) == label:
                    _atlas_image(obj, path, back)
    except LeaflightError as error:
        problems[obj.name_full] = str(error)
        return
    _looked_after[obj.name_full] = (*state[:2], settings.bake_path, state[3])


def _own_mesh(obj):
    """Gives a linked duplicate or a library override a mesh of its own before it is changed.

    They share one for as long as they show the same.
    """
    mesh = obj.data
    if mesh.library is None and mesh.users < 2:
        return
    others = (other for other in bpy.data.objects if other != obj and other.data == mesh)
    if mesh.library is not None or any(other.leaflight.is_volume for other in others):
        obj.data = mesh.copy()


def shown_isovalue(obj):
    """The isovalue of the surface that the mesh holds, by its object if it holds none yet."""
    return obj.data.get(_ISOVALUE, obj.leaflight.isovalue)


def contour(obj, isovalue):
    """(vertices, normals, triangles) in local coordinates. Raises LeaflightError.

    Where a bake has finer texels the mesh is finer, too.
    """
    volume = _volume(obj)
    low, high = volume.data_range()
    if not low < isovalue <= high:
        raise LeaflightError(
            f"Isovalue {isovalue:g} lies outside the data, whose values are {low:g} to {high:g}: "
            "choose one inside."
        )
    try:
        lit = is_lit(obj, isovalue)
    except LeaflightError:
        # A bake that cannot be read lights nothing; update() says why.
        lit = False
    if lit:
        return _grid(obj).contour(volume.field(), isovalue)
    return _core.contour(volume.field(), isovalue)


def radiance_at(obj, points):
    """Baked radiance at points (n, 3) in local coordinates, by the name of its attribute.

    Raises LeaflightError.
    """
    # The texels belong to the volume's index space, wherever the object has moved since.
    grid, field = _grid(obj), _volume(obj).field()
    radiance = {RADIANCE: grid.lookup(field, points)}
    if grid.has_back:
        radiance[RADIANCE_BACK] = grid.lookup(field, points, back=True)
    return radiance


def is_lit(obj, isovalue):
    """Whether the bake holds the radiance of this isosurface. Raises LeaflightError."""
    settings = obj.leaflight
    bake, index = _lit_by(obj)
    if bake is None:
        return False
    baked = bake.scene.leaves[index]
    # What a mirror or glass shows depends on where it is seen from.
    if baked.scattering != "diffuse" or baked.capped != settings.capped:
        return False
    low, high = (bake.isovalue_of(index, c) for c in bake.isovalues)
    rounding = 1e-6 * (high - low)
    return low - rounding <= isovalue <= high + rounding


def _lit_by(obj):
    """(bake, which of its volumes the object is): a round of one in progress, or the last one.

    The bake is None before the first. Raises LeaflightError.
    """
    shown = preview.of(obj)
    if shown is not None:
        return shown.bake, shown.index
    return cache.bake_of(obj), obj.leaflight.bake_index


def _grid(obj):
    bake, index = _lit_by(obj)
    return bake.grids[index]


def _volume(obj):
    shown = preview.of(obj)
    return cache.volume_of(obj) if shown is None else shown.volume


def fill(mesh, vertices, faces, colours):
    """Replaces the geometry: vertices (n, 3), faces (m, 3) or (m, 4), smooth.

    colours: by the name of its attribute, linear RGB (n, 3).
    """
    mesh.clear_geometry()
    count = len(faces)
    if count:
        corners = faces.shape[1]
        loops = np.ascontiguousarray(faces, np.int32).ravel()
        starts = np.arange(0, corners * count, corners, dtype=np.int32)
        mesh.vertices.add(len(vertices))
        mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
        mesh.loops.add(len(loops))
        mesh.loops.foreach_set("vertex_index", loops)
        mesh.polygons.add(count)
        versions.set_loop_starts(mesh, starts, corners)
        mesh.polygons.foreach_set("use_smooth", np.ones(count, bool))
    mesh.update(calc_edges=True)
    if len(vertices):
        for name, values in colours.items():
            colour(mesh, name, values)


def colour(mesh, name, values):
    """Writes linear RGB (n, 3) to the vertices' colour attribute of this name."""
    colours = np.ones((len(values), 4), np.float32)
    colours[:, :3] = values
    attribute = mesh.attributes.get(name)
    if attribute is None:
        attribute = mesh.attributes.new(name, "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colours.ravel())


def label_of(mesh):
    """Tells apart what meshes show: None before the first surface."""
    return mesh.get(_SHOWN)


def settled_state(mesh):
    """Whether the mesh holds settled light in place of the bake's, and whether all of it."""
    state = mesh.get(_SETTLED, "")
    label = label_of(mesh)
    return label is not None and state.removesuffix(_SO_FAR) == label, state == label


def settle(obj, colours, whole):
    """Gives the mesh the light of its vertices at rest.

    colours: by the name of its attribute, linear RGB (n, 3). whole: whether nothing is to follow.
    """
    for name, values in colours.items():
        colour(obj.data, name, values)
    obj.data[_SETTLED] = obj.data[_SHOWN] + ("" if whole else _SO_FAR)
    obj.data.update()
    shade(obj)


def unsettle(obj):
    """Brings back the bake's light where the mesh holds settled light."""
    if _SETTLED not in obj.data:
        return
    holds, _ = settled_state(obj.data)
    del obj.data[_SETTLED]
    if holds:
        for name, values in radiance_at(obj, vertices_of(obj.data)).items():
            colour(obj.data, name, values)
        obj.data.update()
    shade(obj)


def vertices_of(mesh):
    """float32 (n, 3), local."""
    vertices = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", vertices.ravel())
    return vertices


def mark_shown(mesh, other):
    """Marks a mesh as showing what the other shows, so that it is left alone."""
    mesh[_SHOWN], mesh[_ISOVALUE] = other[_SHOWN], other[_ISOVALUE]


def shade(obj):
    """Gives the object the material of its state: baked radiance, or plain and unlit by the bake.

    A material that the user put there instead stays. A failure goes to `problems`.
    """
    try:
        _assign_material(obj)
    except LeaflightError as error:
        problems[obj.name_full] = str(error)


def _assign_material(obj):
    settings = obj.leaflight
    current = obj.data.materials[0] if obj.data.materials else None
    own = (None, settings.leaf_material, settings.baked_material)
    if current not in own and not any(mark in current for mark in _ROUND.values()):
        return
    if RADIANCE in obj.data.attributes and preview.of(obj) is not None:
        material = _round_material(obj)
    elif RADIANCE in obj.data.attributes:
        material = _baked_material(obj)
        shader.set_settled(material, settled_state(obj.data)[0])
    else:
        material = leaf_material(obj)
    set_material(obj, material)


def _round_material(obj):
    """By vertex attribute: an atlas is a file, which a round is not worth."""
    sides = [name for name in (RADIANCE, RADIANCE_BACK) if name in obj.data.attributes]
    return shader.shared_material(_ROUND[len(sides)], "Leaflight Round", *sides)


def forget_rounds():
    """Shows what lit the objects before the rounds of a bake did."""
    for name in preview.forget():
        obj = next((obj for obj in bpy.data.objects if obj.name_full == name), None)
        if obj is not None and obj.leaflight.is_volume:
            update(obj, shown_isovalue(obj))
    remove_round_materials()


def remove_round_materials():
    for material in [m for m in bpy.data.materials if any(mark in m for mark in _ROUND.values())]:
        if not material.users:
            bpy.data.materials.remove(material)


def set_material(obj, material):
    if not obj.data.materials:
        obj.data.materials.append(material)
    elif obj.data.materials[0] != material:
        _own_mesh(obj)
        obj.data.materials[0] = material


def leaf_material(obj):
    """The material of the leaf itself, as the bake assumes it."""
    settings = obj.leaflight
    scattering, ior = settings.leaf_scattering, settings.leaf_ior
    emission = leaves.emission_of(obj)

    def build(material):
        shader.build_leaf(material, scattering, ior, emission)

    return _material(obj, "leaf_material", f"{scattering} {ior} {emission}", build)


def shading_in_use(settings):
    """(the shading mode, the reason when it is not the one chosen or an empty text)."""
    if settings.shading != "ATLAS" or not settings.bake_id or settings.atlas_columns > 0:
        return settings.shading, ""
    if settings.bake_refined:
        return "ATTRIBUTE", "Vertex attribute: a volume texture holds no finer texels"
    size = atlases.LARGEST_ATLAS
    return "ATTRIBUTE", f"Vertex attribute: a volume texture would exceed {size} x {size} pixels"


def _baked_material(obj):
    settings = obj.leaflight
    mode, _ = shading_in_use(settings)
    back = RADIANCE_BACK in obj.data.attributes

    def build(material):
        versions.do_not_sample_as_light(material)
        if mode == "ATTRIBUTE":
            shader.build_attribute(material, RADIANCE, RADIANCE_BACK if back else None)
            return
        grid, path = cache.grid_of(obj), bake_files.locate(obj)
        sides = [_atlas_image(obj, path, side) for side in ((False, True) if back else (False,))]
        matrix = shader.texel_from_object(cache.volume_of(obj), grid.resolution)
        attributes = (RADIANCE, RADIANCE_BACK)
        columns = settings.atlas_columns
        shader.build_atlas(material, sides, attributes, grid.resolution, columns, matrix)

    # Materials of files from before surfaces settled have another label, and are built anew.
    label = f"{mode} {settings.bake_id} {settings.bake_index} {back} settles"
    return _material(obj, "baked_material", label, build)


def _atlas_image(obj, bake_path, back):
    """The image of an atlas, whose file is written anew unless it holds this bake."""
    identifier, index = obj.leaflight.bake_id, obj.leaflight.bake_index
    path, written = atlases.require(lambda: cache.grid_of(obj), bake_path, identifier, index, back)
    return shader.atlas_image(path, atlases.label(identifier, index, back), back, written)


def _material(obj, slot, label, build):
    """The material in a slot of the settings, built only when it is not yet what the label says.

    Each build compiles the shader anew; the albedo of the isovalue is put into what was built. A
    duplicate of the object gets a material of its own.
    """
    settings = obj.leaflight
    material = getattr(settings, slot)
    others = (other.leaflight for other in bpy.data.objects if other != obj)
    taken = any(getattr(other, slot) == material for other in others)
    if material is None or taken or (material.library is not None and obj.library is None):
        material = bpy.data.materials.new(f"{obj.name} {slot.partition('_')[0].title()}")
        setattr(settings, slot, material)
    if material.get(_BUILT) != label:
        build(material)
        material[_BUILT] = label
    shader.set_albedo(material, leaves.albedo_at(obj, shown_isovalue(obj)))
    return material


def _label(obj, isovalue):
    settings = obj.leaflight
    volume = f"{settings.source} {settings.frame} {settings.capped}"
    shown = preview.of(obj)
    if shown is not None:
        return f"{isovalue!r} of {volume} lit by round {shown.bake.id} {shown.index}"
    return f"{isovalue!r} of {volume} lit by {settings.bake_id} {settings.bake_index}"
