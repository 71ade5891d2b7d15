# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators for more isosurfaces of a volume, and for a box that cuts them."""

import bpy
import mathutils
import numpy as np
from leaflight import LeaflightError
from leaflight.volume.first_isovalue import inner_isovalue

from ..operators import checks
from ..operators.checks import active_volume
from ..props import EnumProperty, FloatProperty, StringProperty
from ..show import display, distribution, isovalues, surface_object, whole_detail
from ..store import cache
from ..translations import iface_

_PROPOSED = "PROPOSED"
# Isovalues of tissues in Hounsfield units.
TISSUES = {"SKIN": -300.0, "MUSCLE": 50.0, "BONE": 300.0}
TISSUE_ITEMS = [
    (_PROPOSED, "Next Inside", "Chooses the isovalue that best separates the next inner material"),
    ("SKIN", "Skin", "Border between body and air, -300 HU"),
    ("MUSCLE", "Muscle", "Muscles and organs, 50 HU"),
    ("BONE", "Bone", "300 HU"),
]
# Range of the lowest value of a CT scan: air, -1000 HU, or the padding around the scanned circle.
_AIR = (-3100.0, -900.0)


def is_hounsfield(obj):
    """True if the values of an object's volume seem to be Hounsfield units.

    False until the Distribution is known.
    """
    found = distribution.of(obj)
    low, high = (found.low, found.high) if found is not None else (0.0, 0.0)
    return _AIR[0] <= low <= _AIR[1] and high > TISSUES["BONE"]


def next_isovalue(volume, tissue=_PROPOSED):
    """Returns the isovalue of the next isosurface of a volume object. Raises LeaflightError."""
    if tissue != _PROPOSED:
        return TISSUES[tissue]
    low, high = isovalues.isovalue_range(volume.leaflight)
    shown = [obj.leaflight.isovalue for obj in display.surfaces_of(volume)]
    inner = inner_isovalue(cache.volume_of(volume), max(shown))
    if inner is not None and max(shown) < inner < high:
        return inner
    # Without an inner material, halve the larger free part of the range.
    if min(shown) - low > 0.1 * (high - low):
        return 0.5 * (low + min(shown))
    return 0.5 * (max(shown) + high)


def shown_outside(volume, isovalue):
    """Returns the isosurfaces of a volume object below an isovalue, which lie around it."""
    surfaces = display.surfaces_of(volume)
    return [obj for obj in surfaces if obj.leaflight.isovalue < isovalue]


# Opacity of an isosurface around others, which show through it.
_OPACITY = 0.3
# Largest number of transparent layers on a ray, for surfaces that are cut away.
_LAYERS = 128


def _has_room(operator, context):
    if len(display.added_to(active_volume(context))) + 1 < display.MOST:
        return True
    operator.poll_message_set(
        iface_("%d isosurfaces are already shown: remove one first") % display.MOST
    )
    return False


class LEAFLIGHT_OT_add_isosurface(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Add Isosurface"
    bl_description = (
        "Show another isosurface of this volume, inside the shown one, which becomes "
        "translucent. The same bake lights it. Isosurfaces that are shown together "
        "neither light nor shade each other"
    )
    conditions = (
        *checks.VOLUME,
        checks.volume_needs(
            lambda volume: volume.library is None,
            "Make a library override of the linked volume first",
        ),
        _has_room,
    )

    isovalue: FloatProperty("Isovalue", options={"HIDDEN", "SKIP_SAVE"})
    tissue: EnumProperty(
        "Tissue", "Tissue of the CT scan to show", TISSUE_ITEMS, options={"SKIP_SAVE"}
    )
    opacity: FloatProperty(
        "Opacity", "Opacity of the outer isosurface", _OPACITY, subtype="FACTOR", min=0.0, max=1.0
    )

    def run(self, context):
        volume = active_volume(context)
        given = self.properties.is_property_set("isovalue")
        isovalue = self.isovalue if given else next_isovalue(volume, self.tissue)
        # Make the outer isosurfaces translucent. A script that gives an isovalue sets the opacity.
        outer = [] if given else shown_outside(volume, isovalue)
        obj = display.add(volume, isovalue, 1.0 if outer else self.opacity)
        isovalues.limit(obj)
        for one in outer:
            one.leaflight_look.opacity = min(one.leaflight_look.opacity, self.opacity)
        if not whole_detail.may_follow():
            obj.leaflight.isovalue = isovalue
            return
        # Show a coarse surface at once. The full detail follows in the background.
        surface_object.update(obj, isovalue, moving=True)
        whole_detail.watch([obj])


class LEAFLIGHT_OT_remove_isosurface(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Remove Isosurface"
    bl_description = "Remove this isosurface"

    name: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def run(self, context):
        obj = context.scene.objects.get(self.name)
        if obj is None or not display.is_added(obj):
            raise LeaflightError(f'"{self.name}" is not an added isosurface: choose one.')
        surface_object.problems.pop(obj.name_full, None)
        display.remove(obj)


class LEAFLIGHT_OT_add_clip_box(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Add Clip Box"
    bl_description = (
        "Add an Empty whose box cuts the isosurfaces; move, rotate and scale it. It "
        "starts at the corner of the volume nearest to the camera"
    )

    def run(self, context):
        volume = active_volume(context)
        low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)
        box = bpy.data.objects.new(f"{volume.name} Clip Box", None)
        box.empty_display_type = "CUBE"
        _place_nearest(box, volume.matrix_world, low, high)
        for collection in volume.users_collection:
            collection.objects.link(box)
        context.view_layer.update()
        volume.leaflight_look.box = box
        # Rays pass through all parts that are cut away, of which a scan has many layers.
        cycles = getattr(context.scene, "cycles", None)
        if cycles is not None:
            cycles.transparent_max_bounces = max(cycles.transparent_max_bounces, _LAYERS)


def _place_nearest(box, volume_to_world, low, high):
    """Puts a box of half size 1 around the eighth of the volume that is nearest to the camera."""
    camera = bpy.context.scene.camera
    middle, size = 0.5 * (low + high), high - low
    towards = np.array([1.0, -1.0, 1.0])
    if camera is not None:
        place = volume_to_world.inverted_safe() @ camera.matrix_world.translation
        towards = np.where(np.array(place) < middle, -1.0, 1.0)
    # Extend the box beyond the volume, so that no face lies on its border.
    half = 0.26 * size
    local = mathutils.Matrix.Diagonal((*half, 1.0))
    local.translation = middle + towards * half
    box.matrix_world = volume_to_world @ local
