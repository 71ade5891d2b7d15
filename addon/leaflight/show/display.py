# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that only show results and that the next bake ignores.

Among them are the added isosurfaces of a volume, each at another isovalue. An added isosurface is a
child of the volume's object, with the same coordinates, volume and bake. It cannot be selected; the
volume's panel lists it.
"""

import uuid

import bpy
from leaflight import LeaflightError

from .. import session

# Largest number of isosurfaces that a volume shows, including the first.
MOST = 3

# Kinds of the labels of a volume, which go with it.
COLOR_BAR, SCALE_BAR, LETTER = "color bar", "scale bar", "letter"
# Property of a label: its volume. A user may give a label another parent.
VOLUME = "leaflight_volume"

_DISPLAY = "leaflight_display"
_ISOSURFACE = "isosurface"
# Property of a volume with added isosurfaces, which identifies its duplicates (isovalues.py).
_MARK = "leaflight_isosurfaces"

# Names of the volumes and displays of this file that were seen last.
_noted = session.cache(set)


def mark(obj, kind):
    obj[_DISPLAY] = kind


def is_display(obj, kind=None):
    """True if an object only shows results, of this kind or, if kind is None, of any kind."""
    return _DISPLAY in obj and kind in (None, obj[_DISPLAY])


def is_label(obj):
    """True if an object is a color bar, a scale bar, a letter, or a part of them."""
    return obj.get(_DISPLAY) in (COLOR_BAR, SCALE_BAR, LETTER)


def is_left_behind(obj):
    """True if the volume of a display is gone, or for a part of another display its parent.

    A deleted object is in no scene, but lives on while a property refers to it.
    """
    owner = obj[VOLUME] if VOLUME in obj else obj.parent
    return owner is None or (_is_in_a_scene(obj) and not _is_in_a_scene(owner))


def _is_in_a_scene(obj):
    # users_scene compares with every object of each scene.
    return any(scene.objects.get(obj.name) == obj for scene in bpy.data.scenes)


def note(objects):
    """Adds the objects of this file to those that noted() returns."""
    _noted.update(obj.name for obj in objects if obj.library is None)


def noted():
    found = (bpy.data.objects.get((name, None)) for name in _noted)
    return [obj for obj in found if obj is not None]


def select(context, objects, active):
    """Selects only these objects."""
    for obj in context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = active


def hide(scene, obj, mark):
    """Hides an object in viewports and renders. `mark` stores its state for show()."""
    layers = [layer for layer in scene.view_layers if obj.name in layer.objects]
    obj[mark] = "\n".join(layer.name for layer in layers if obj.hide_get(view_layer=layer))
    obj.hide_render = True
    for layer in layers:
        obj.hide_set(True, view_layer=layer)


def show(scene, obj, mark):
    # Files of an earlier Leaflight store one number for all layers.
    before = obj.pop(mark)
    obj.hide_render = False
    for layer in scene.view_layers:
        if obj.name in layer.objects:
            is_text = isinstance(before, str)
            was_hidden = layer.name in before.split("\n") if is_text else bool(before)
            obj.hide_set(was_hidden, view_layer=layer)


def is_isosurface(obj):
    """True if an object shows an isosurface: a volume or an added isosurface."""
    return obj.leaflight.is_volume or (is_added(obj) and obj.parent is not None)


def on_volume(call):
    """Returns an update function of properties, which calls a function with their volume object."""

    def changed(settings, _context):
        if settings.id_data.leaflight.is_volume:
            call(settings.id_data)

    return changed


def is_added(obj):
    return is_display(obj, _ISOSURFACE)


def volume_object(obj):
    """Returns the volume object of an isosurface: its parent if it was added, or itself."""
    return obj.parent if is_added(obj) and obj.parent is not None else obj


def added_to(volume):
    """Returns the isosurfaces that were added to a volume object, in the order of their names."""
    return sorted(filter(is_added, volume.children), key=lambda obj: obj.name)


def surfaces_of(volume):
    """Returns a volume object, which shows an isosurface, and its added isosurfaces."""
    return (volume, *added_to(volume))


def add(volume, isovalue, opacity):
    """Adds an isosurface without geometry to a volume object. Raises LeaflightError."""
    if len(added_to(volume)) + 1 >= MOST:
        raise LeaflightError(f'"{volume.name}" already shows {MOST} isosurfaces: remove one first.')
    obj = bpy.data.objects.new(name_for(volume), bpy.data.meshes.new(volume.name))
    mark(obj, _ISOSURFACE)
    obj.parent = volume
    obj.hide_select = True
    link_beside(obj, volume)
    obj.leaflight["isovalue"] = float(isovalue)
    obj.leaflight_look.opacity = opacity
    if mark_of(volume) is None:
        mark_anew(volume)
    return obj


def name_for(volume):
    return f"{volume.name} Isosurface"


def link_beside(obj, volume):
    """Links an object to the collections of its volume."""
    for collection in volume.users_collection:
        collection.objects.link(obj)


def new_display(volume, kind, name, data):
    """Returns a new display beside a volume, which neither lights nor shades other objects.

    It has no parent yet.
    """
    obj = bpy.data.objects.new(name, data)
    mark(obj, kind)
    obj.visible_diffuse = obj.visible_glossy = obj.visible_shadow = False
    link_beside(obj, volume)
    return obj


def remove(obj):
    data, volume = obj.data, obj.parent
    bpy.data.objects.remove(obj)
    if not data.users:
        bpy.data.batch_remove((data,))
    if volume is not None and not added_to(volume):
        volume.pop(_MARK, None)


def mark_of(volume):
    """Returns the mark that a volume shares only with its duplicates.

    Returns None for a volume without added isosurfaces.
    """
    return volume.get(_MARK)


def mark_anew(volume):
    volume[_MARK] = uuid.uuid4().hex
