# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Import > Volume for Leaflight."""

import bpy
from bpy_extras.io_utils import ImportHelper
from leaflight.io import readers

from .. import props
from ..operators import background, failures
from ..props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    StringProperty,
)
from ..show import volume_properties
from ..stage import orientation
from ..store import source_files
from ..translations import draw_wrapped, iface_
from . import channels, cropping, import_job, placing, stored_facts

# Name patterns of the files that the browser lists.
_BY_NAME = readers.name_patterns()

_OF_THE_FILE = ("FILE", "As in the File", "Orientation of the file, or +Z up and -Y to the front")


def _list_files(operator, context):
    browser = getattr(context.space_data, "params", None)
    if browser is not None:
        browser.filter_glob = "*" if operator.all_files else _BY_NAME


class LEAFLIGHT_OT_import_volume(
    volume_properties.ReadingChoices,
    # The next file need not have the part that was chosen in the last one.
    volume_properties.choice_of_part(options={"SKIP_SAVE"}),
    channels.Choices,
    background.AskingOperator,
    bpy.types.Operator,
    ImportHelper,
):
    bl_label = "Import Volume"
    bl_description = "Read a scalar volume and show one of its isosurfaces"

    filter_glob: StringProperty(default=_BY_NAME, options={"HIDDEN"})
    all_files: BoolProperty(
        "All Files",
        "List files with any suffix, because DICOM slices often have none. You can "
        "also choose their folder",
        options={"SKIP_SAVE"},
        update=_list_files,
    )
    size_from: EnumProperty("Size From", "Size of the volume in Blender", placing.SIZE_ITEMS)
    size: FloatProperty(
        "Size",
        "Length of the volume's longest side in Blender units",
        2.0,
        min=1e-3,
        soft_max=100.0,
    )
    partner: StringProperty(
        "Volume",
        "Volume whose scale and position the new one takes",
        search=lambda _self, context, _text: placing.volume_names(context),
    )
    up: EnumProperty("Up", orientation.UP_TEXT, [_OF_THE_FILE, *orientation.ITEMS])
    front: EnumProperty("Front", orientation.FRONT_TEXT, [_OF_THE_FILE, *orientation.ITEMS])
    resolution: EnumProperty(
        "Resolution",
        "Share of the voxels to keep, for volumes that exceed the memory",
        stored_facts.RESOLUTION_ITEMS,
    )
    smooth: FloatProperty(
        "Smooth",
        "Standard deviation, in voxels, of a Gaussian on the values. Removes noise "
        "and the steps of 8-bit values",
        min=0.0,
        max=10.0,
    )
    smooth_normals: FloatProperty(
        "Smooth Normals",
        "Standard deviation, in voxels, of a Gaussian on the normals. Smooths the "
        "shading; isosurfaces stay where they are",
        min=0.0,
        max=10.0,
    )
    both_signs: BoolProperty(
        "Both Signs",
        "Show values of both signs, such as those of an orbital, at the isovalue and at "
        "its negative, in two colors",
        True,
    )
    labels: BoolProperty(
        "Labels as Surfaces",
        "Show labels as closed surfaces, each in its own color",
        True,
    )
    label_table: StringProperty(
        "Label Table",
        "File with the names and colors of labels, of 3D Slicer, FreeSurfer, ITK-SNAP or BIDS; "
        "empty takes those of the file, or the table of that name beside it",
        options={"SKIP_SAVE"},
    )
    crop: BoolProperty(
        "Crop",
        "Read only a part of the volume, so that bakes are faster and take less memory",
        options={"SKIP_SAVE"},
    )
    crop_from: FloatVectorProperty(
        "From",
        "Start of the part along each axis of the voxels, in percent",
        3,
        default=(0.0, 0.0, 0.0),
        min=0.0,
        max=100.0,
        options={"SKIP_SAVE"},
    )
    crop_to: FloatVectorProperty(
        "To",
        "End of the part along each axis of the voxels, in percent",
        3,
        default=(100.0, 100.0, 100.0),
        min=0.0,
        max=100.0,
        options={"SKIP_SAVE"},
    )
    use_spacing: BoolProperty(
        "Own Voxel Size", "Set the voxel size, if the file has none or a wrong one"
    )
    unit: EnumProperty(
        "Unit",
        "Unit of the voxel size, if the file has none",
        volume_properties.UNIT_ITEMS,
        options={"SKIP_SAVE"},
    )
    animate: BoolProperty(
        "As Animation",
        "Show the next volume of the series at each frame, by keyframes from the "
        "first frame of the scene on",
    )
    dataset: StringProperty(
        "Dataset",
        "Volume of the file, or series of the folder, to read if there are several",
        options={"SKIP_SAVE"},
        search=lambda self, _context, _text: self._datasets(),
    )

    def _facts(self):
        path = bpy.path.abspath(self.filepath)
        return path, *stored_facts.read_facts(path, source_files.choices_of(self))

    def _datasets(self):
        _, stored, _ = self._facts()
        return list(stored.datasets) if stored is not None else []

    # Choices of source_files.CHOICES that the resolution and the values set later.
    downsample, field, hide, regions, brightest = 1, "", "", "", (-1, -1, -1)
    _patience = 0.3

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "all_files")
        path, stored, problem = self._facts()
        takes = source_files.format_of(path).options if stored is not None or problem else ()
        facts = [problem]
        if stored is not None:
            step = stored_facts.step_of(self.resolution, stored)
            facts = stored_facts.lines(path, stored, step, cropping.Crop.of(self))
        column = layout.column(align=True)
        for fact in facts:
            draw_wrapped(column, fact, 38)
        layout.prop(self, "size_from")
        if self.size_from in {"AUTO", "FIT"}:
            layout.prop(self, "size")
        elif self.size_from == "SAME":
            layout.prop(self, "partner")
        props.draw(layout, self, "resolution", "crop")
        if self.crop:
            props.draw(layout, self, "crop_from", "crop_to")
        props.draw(layout, self, "smooth", "smooth_normals", "both_signs", "labels", "label_table")
        if stored is not None and not stored.patient:
            layout.label(text="The file has no orientation", icon="QUESTION")
        props.draw(layout, self, "up", "front")
        if stored is not None and not stored.unit:
            layout.label(text="The file has no unit of length", icon="QUESTION")
            layout.prop(self, "unit")
        self._draw_choices(layout, stored, takes)

    def _draw_choices(self, layout, stored, takes):
        """Draws the options of the file's format."""
        if "type" in takes:
            props.draw(layout, self, "dims", "value_type", "endian", "skip")
        elif "spacing" in takes:
            layout.prop(self, "use_spacing")
        if "type" in takes or ("spacing" in takes and self.use_spacing):
            layout.prop(self, "spacing")
        if stored is None:
            if "level" in takes:
                layout.prop(self, "level")
            return
        open_choices = (
            len(stored.datasets) > 1 and not self.dataset and stored.dims is None,
            stored.frames > 1 and self.frame < 0 and not self.animate,
            channels.Choice.of(self).is_open(stored),
        )
        if any(open_choices):
            layout.label(text="Several volumes: choose one", icon="QUESTION")
        if len(stored.datasets) > 1:
            layout.prop(self, "dataset")
        if stored.levels:
            layout.prop(self, "level", text=iface_("Level (0 to %d)") % (len(stored.levels) - 1))
        if stored.frames > 1:
            layout.prop(self, "animate")
            row = layout.row()
            row.active = not self.animate
            row.prop(self, "frame", text=iface_("Frame (0 to %d)") % (stored.frames - 1))
        if stored.channels > 1:
            channels.draw(layout, self, stored)

    def ask(self, context, event):
        return ImportHelper.invoke(self, context, event)

    def start(self, context):
        return import_job.ImportJob(context, self)

    def _fail(self, error):
        """Reports an error, but not in the panels, which show another volume."""
        self.report({"ERROR"}, failures.sentence_of(error))
        return {"CANCELLED"}


def _draw_menu(menu, _context):
    name = LEAFLIGHT_OT_import_volume.bl_idname
    menu.layout.operator(name, text="Volume for Leaflight (.nii, .nrrd, .dcm, .tif, .raw, ...)")


MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
