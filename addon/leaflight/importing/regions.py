# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that cut a volume, remove parts of it, or mask it by labels, before it is baked.

Object.leaflight.regions holds the regions as JSON: records of leaflight.volume.regions with the
keys "on" and, for cuts and masks, "object", the name of the clip box or the label map. A box
without it is a crop. A cut has the key "place", too (box_cuts.py). Positions are in the coordinates
of the file, so they stay where they are in the volume when the object moves.
"""

import json

import bpy
import numpy as np
from bpy_extras import view3d_utils
from leaflight import LeaflightError
from leaflight.volume.regions import Box, record_of, sphere

from ..operators import background, checks
from ..operators.checks import active_volume
from ..props import EnumProperty, FloatProperty, IntProperty, StringProperty
from ..show import display, exploded, look
from ..store import cache, source_files
from ..translations import iface_
from . import box_cuts, read_again

# Names of kinds of regions in panels.
_TITLES = {
    "box": "Cut",
    "ball": "Removed Sphere",
    "largest_part": "Largest Part",
    "part": "Removed Part",
    "dust": "Removed Dust",
    "apart": "Parts Moved Apart",
    "within_labels": "Within Labels",
}


def title(item):
    """Returns the name of a region in the panel."""
    text = iface_(_TITLES[item["kind"]])
    if "object" in item:
        return f"{text}: {item['object']}"
    if item["kind"] == "box":
        return iface_("Crop")
    if "isovalue" not in item:
        return text
    return iface_("%s at %s") % (text, f"{item['isovalue']:g}")


def crop(low, high, index_to_file):
    """Returns the region that crops a volume to a box of indices (x, y, z)."""
    box = Box.between(low, high, cut="open").moved(index_to_file)
    return {**record_of(box), "on": True}


class _Change(background.BackgroundOperator):
    """An operator that reads the active volume again with other regions.

    changed(context, obj, regions) returns the new regions. done: The report. shown(obj): Called
    once the object shows them.
    """

    conditions = read_again.CONDITIONS

    def start(self, context):
        obj, done, shown = active_volume(context), self.done, type(self).shown
        regions = self.changed(context, obj, source_files.regions_of(obj.leaflight))

        def report(obj):
            shown(obj)
            return f"{obj.name}: {iface_(done)}"

        value = json.dumps(regions) if regions else ""
        return read_again.ReadAgainJob(obj, "Change Data", "regions", value, report)

    @staticmethod
    def shown(obj):
        pass


def _with_region_by(other, region, regions):
    """Returns the regions with a new one, in place of the last one by this object."""
    kept = [each for each in regions if each.get("object") != other.name]
    return [*kept, {**region, "object": other.name, "on": True}]


_CUTS = [
    ("capped", "Capped", "Isosurfaces are closed by a face on the cut, which is lit as such"),
    ("open", "Open", "Isosurfaces are open, so light falls in and their backs are seen"),
]


class LEAFLIGHT_OT_cut_data(_Change, bpy.types.Operator):
    bl_label = "Cut Data"
    bl_description = (
        "Cut the data itself by the clip box, so that a bake lights the cut. The cut follows the "
        "box"
    )
    conditions = (
        *read_again.CONDITIONS,
        checks.volume_needs(look.box_of, "Add a clip box that cuts first"),
    )
    done = "cut; bake to light the cut"

    cut: EnumProperty("Cut", items=_CUTS)

    def changed(self, context, obj, regions):
        box = look.box_of(obj)
        region = box_cuts.region_by(obj, box, obj.leaflight_look.keep, self.cut)
        return _with_region_by(box, region, regions)


def label_maps(scene):
    """Returns the names of the label maps in a scene."""
    return [obj.name for obj in scene.objects if _is_label_map(obj)]


def _is_label_map(obj):
    return obj.leaflight.is_volume and obj.leaflight.source and len(obj.leaflight.labels) > 0


class LEAFLIGHT_OT_mask_data(_Change, bpy.types.Operator):
    bl_label = "Mask Data"
    bl_description = (
        "Keep only what is within the shown labels of a label map, such as one organ of a scan. "
        "The coordinates of both files place the labels"
    )
    conditions = (
        *read_again.CONDITIONS,
        checks.needs(
            lambda c: any(map(_is_label_map, c.scene.objects)), "Import a label map first"
        ),
    )
    done = "masked; bake again"

    label_map: StringProperty(
        "Label Map",
        "Label map whose shown labels are kept; empty is the first of the scene",
        search=lambda _self, context, _text: label_maps(context.scene),
    )

    def changed(self, context, obj, regions):
        names = label_maps(context.scene)
        name = self.label_map or names[0]
        if name not in names:
            raise LeaflightError(f'"{name}" is no label map of this scene: import it.')
        other = context.scene.objects[name]
        labels, path = other.leaflight, source_files.path_of(other.leaflight)
        shown = [label.number for label in labels.labels if label.is_shown]
        if not shown:
            raise LeaflightError(f'All labels of "{other.name}" are hidden: show one of them.')
        region = {
            "kind": "within_labels",
            "label_map": labels.source,
            "labels": shown,
            "reading": source_files.reading_of(path, source_files.choices_of(labels)),
        }
        return _with_region_by(other, region, regions)


class LEAFLIGHT_OT_crop_to_shown(_Change, bpy.types.Operator):
    bl_label = "Crop to Isosurface"
    bl_description = "Crop the data to a box around the shown isosurfaces, so that a bake is faster"
    done = "cropped"

    margin: IntProperty("Margin", "Voxels around the isosurfaces", 4, min=0)

    def changed(self, context, obj, regions):
        place = cache.volume_of(obj).index_to_world
        surfaces = display.surfaces_of(obj)
        points = np.concatenate([exploded.closed_positions(each.data) for each in surfaces])
        if not len(points):
            raise LeaflightError(f'"{obj.name}" shows no isosurface: choose another isovalue.')
        to_index = np.linalg.inv(place)
        points = points @ to_index[:3, :3].T + to_index[:3, 3]
        low, high = points.min(axis=0) - self.margin, points.max(axis=0) + self.margin
        to_file = np.linalg.inv(source_files.from_file(obj.leaflight)) @ place
        region = crop(low, high, to_file)
        return [*regions, region]


class LEAFLIGHT_OT_clean_data(_Change, bpy.types.Operator):
    bl_label = "Clean Data"
    bl_description = (
        "Remove parts of the data that are not connected at the shown isovalue, with their shadows"
    )
    done = "small parts removed"

    kind: EnumProperty(
        "Remove",
        items=[
            ("largest_part", "All but the Largest Part", "Keep only the part with most voxels"),
            ("dust", "Dust", "Remove parts with fewer voxels than the smallest part"),
        ],
    )
    voxels: IntProperty("Smallest Part", "Voxels of the smallest part to keep", 1000, min=1)

    def changed(self, context, obj, regions):
        region = {"kind": self.kind, "isovalue": obj.leaflight.isovalue, "on": True}
        if self.kind == "dust":
            region["voxels"] = self.voxels
        return [*regions, region]


class LEAFLIGHT_OT_move_parts(_Change, bpy.types.Operator):
    bl_label = "Move Parts in Data"
    bl_description = (
        "Move the parts apart in the data, as they are shown, so that a bake lights them there. "
        "What is not connected with a part at the shown isovalue goes"
    )
    conditions = (
        *read_again.CONDITIONS,
        checks.volume_needs(
            lambda obj: exploded.axis_of(obj) is not None, "Choose an axis of Explode first"
        ),
    )
    done = "parts moved; bake to light them"

    def changed(self, context, obj, regions):
        along = obj.leaflight_look.explode_distance * exploded.axis_of(obj)
        isovalue = obj.leaflight.isovalue
        region = {"kind": "apart", "along": along.tolist(), "isovalue": isovalue, "on": True}
        # Parts move before they are cut.
        cuts = (number for number, each in enumerate(regions) if each.get("cut") == "capped")
        regions.insert(next(cuts, len(regions)), region)
        return regions

    @staticmethod
    def shown(obj):
        obj.leaflight_look.explode_axis = exploded.CLOSED


class LEAFLIGHT_OT_remove_part(_Change, bpy.types.Operator):
    bl_label = "Remove Part"
    bl_description = (
        "Click on a part, such as a head rest, to remove all that is connected with it at the "
        "shown isovalue. Esc ends it"
    )
    done = "part removed"

    point: bpy.props.FloatVectorProperty(
        name="Point", description="Point of the part, in Blender's coordinates", size=3
    )

    def invoke(self, context, _event):
        if context.area is None or context.area.type != "VIEW_3D":
            self.report({"ERROR"}, "Remove Part works only in the 3D viewport: call it there.")
            return {"CANCELLED"}
        self._picks, self._picked = True, active_volume(context).name
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(iface_("Click on the part to remove. Esc: cancel"))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if not getattr(self, "_picks", False):
            return super().modal(context, event)
        is_gone = self._picked not in bpy.data.objects
        if is_gone or (event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS"):
            self._end_picking(context)
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            # Pass other events through, so that the view can be rotated.
            return {"PASS_THROUGH"}
        point = _surface_point(context, event)
        if point is None:
            self.report({"WARNING"}, "There is no isosurface: click on a part, or press Esc.")
            return {"RUNNING_MODAL"}
        self._end_picking(context)
        self.point = point
        return self._begin(context, self.start)

    def cancel(self, context):
        if getattr(self, "_picks", False):
            self._end_picking(context)
        else:
            super().cancel(context)

    def _end_picking(self, context):
        self._picks = False
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)

    def changed(self, context, obj, regions):
        to_file = np.linalg.inv(source_files.place_of_file(obj))
        point = to_file[:3, :3] @ np.array(self.point) + to_file[:3, 3]
        isovalue = obj.leaflight.isovalue
        region = {"kind": "part", "point": point.tolist(), "isovalue": isovalue, "on": True}
        return [*regions, region]


def _surface_point(context, event):
    """Returns surface_point() of the active volume under the mouse."""
    at = event.mouse_region_x, event.mouse_region_y
    origin = view3d_utils.region_2d_to_origin_3d(context.region, context.region_data, at)
    direction = view3d_utils.region_2d_to_vector_3d(context.region, context.region_data, at)
    return surface_point(active_volume(context), origin, direction)


def surface_point(obj, origin, direction):
    """Returns where a ray hits an isosurface, in the world and as in the data, or None."""
    from_world = obj.matrix_world.inverted_safe()
    hit, place, *_ = obj.ray_cast(from_world @ origin, from_world.to_3x3() @ direction)
    return tuple(obj.matrix_world @ exploded.closed_place(obj, place)) if hit else None


# Radius of the first sphere, as a share of the volume's longest side.
_RADIUS = 0.1


class LEAFLIGHT_OT_remove_sphere(_Change, background.AskingOperator, bpy.types.Operator):
    bl_label = "Remove Sphere"
    bl_description = (
        "Remove a sphere about the 3D cursor from the data, with its shadow. Shift and the right "
        "mouse button put the cursor on a surface"
    )
    done = "sphere removed"

    radius: FloatProperty(
        "Radius",
        "Radius of the sphere in the unit of the data; 0 is a tenth of the volume",
        min=0.0,
    )
    cut: EnumProperty("Cut", items=_CUTS)

    def ask(self, context, event):
        self.radius = self.radius or _first_radius(active_volume(context))
        return super().ask(context, event)

    def changed(self, context, obj, regions):
        place = obj.matrix_world.inverted_safe() @ context.scene.cursor.location
        place = exploded.closed_place(obj, place)
        radius = self.radius or _first_radius(obj)
        if np.linalg.norm(np.clip(place, *_bounds(obj)) - place) >= radius:
            raise LeaflightError(
                f'"{obj.name}" is farther than {radius:g} from the 3D cursor: put the cursor on it.'
            )
        center = np.array(place, np.float64) + obj.leaflight.origin
        region = {**record_of(sphere(center, radius, cut=self.cut)), "on": True}
        return [*regions, region]


def _first_radius(obj):
    return _RADIUS * float(np.ptp(_bounds(obj), axis=0).max())


def _bounds(obj):
    return np.asarray(cache.volume_of(obj).field().bounds, np.float64)


class LEAFLIGHT_OT_switch_region(_Change, bpy.types.Operator):
    bl_label = "Switch or Remove"
    bl_description = "Turn this change of the data on or off, or remove it"
    done = "data changed"

    # A button that leaves a property unset must not take the value of the last click.
    index: IntProperty("Number", "Number of the change, from 0", min=0, options={"SKIP_SAVE"})
    action: EnumProperty(
        "Action",
        options={"SKIP_SAVE"},
        items=[
            ("SWITCH", "Switch", "Turn the change on or off"),
            ("REMOVE", "Remove", "Remove the change"),
        ],
    )

    def changed(self, context, obj, regions):
        if self.index >= len(regions):
            raise LeaflightError(
                f'"{obj.name}" has {len(regions)} changes of its data: choose one of them.'
            )
        if self.action == "REMOVE":
            del regions[self.index]
        else:
            regions[self.index]["on"] = not regions[self.index]["on"]
        return regions
