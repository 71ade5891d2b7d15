# SPDX-License-Identifier: GPL-3.0-or-later
"""The job that imports a volume: it reads the file and adds the objects that show it."""

import json
from dataclasses import dataclass, replace

import bpy
import leaflight
from leaflight import LeaflightError, blender
from leaflight.bake.both_sides import why_both_sides
from leaflight.io.readers.reading import FIELDS
from leaflight.io.readers.usable import about_labels
from leaflight.scene.volume_texture import SIGN_WIDTH
from leaflight.volume.label_field import has_lobes
from leaflight.words import figures

from ..operators import jobs
from ..show import display, isovalues, label_list, surface_object, volume_properties
from ..stage import orientation
from ..store import cache, source_files
from ..translations import iface_
from . import channels, cropping, placing, stored_facts

# Color map of values below and above 0.
_OF_SIGNS = "CET_D1"
# Isovalue range of the boundary of labels.
_AROUND_BOUNDARY = (0.4, 0.6)


@dataclass(frozen=True, eq=False)
class _Read:
    """A volume that was read with these source_files.CHOICES, and its isovalues."""

    volume: leaflight.Volume
    choices: dict
    range: tuple
    isovalue_range: tuple
    isovalue: float
    why_both_sides: str

    @classmethod
    def of_volume(cls, volume, choices):
        isovalue_range = leaflight.default_isovalue_range(volume)
        isovalue = leaflight.default_isovalue(volume)
        why = why_both_sides(volume, isovalue_range)
        return cls(volume, choices, volume.field().range, isovalue_range, isovalue, why)


class ImportJob(jobs.Job):
    """The reading of a file, and the objects that show its volumes."""

    name = "Import"
    cancelled = "The import was cancelled; nothing has changed"

    def __init__(self, context, operator):
        """Stores the choices of the operator. Raises LeaflightError."""
        self._path = bpy.path.abspath(operator.filepath)
        self._choices = source_files.choices_of(operator)
        self._resolution, self._size = operator.resolution, operator.size
        self._size_from = operator.size_from
        self._axes = [x if x in orientation.AXES else "" for x in (operator.up, operator.front)]
        self._animate, self._unit = operator.animate, volume_properties.unit_of(operator.unit)
        self._both_signs, self._labels = operator.both_signs, operator.labels
        self._chosen = channels.Choice.of(operator)
        self._label_table = operator.label_table and bpy.path.abspath(operator.label_table)
        self._crop = cropping.Crop.of(operator)
        self._partner = operator.partner or next(iter(placing.volume_names(context)), "")
        placing.check(context, self._size_from, self._partner)

    def run(self, progress):
        path, choices = self._path, self._choices
        self._stored = source_files.probe(path, **choices)
        if self._animate and self._stored.frames > 1:
            choices["frame"] = max(choices["frame"], 0)
        choices["downsample"] = stored_facts.step_of(self._resolution, self._stored)
        self._is_rgb = self._chosen.is_rgb(self._stored)
        if self._is_rgb:
            numbers = self._chosen.red_green_blue(path, self._stored)
            of_each = [{"brightest": tuple(numbers)}, *({"channel": k} for k in numbers)]
        else:
            of_each = [{"channel": k} for k in self._chosen.numbers(self._stored)]
        self._read, self._colors, self._left_out = [], None, []
        for one in of_each:
            chosen = {**choices, **one}
            is_needed = one is of_each[-1] and not self._read
            how = {**chosen, "label_table": self._label_table}
            volume = channels.read(path, self._stored, how, is_needed, progress)
            if volume is None:
                self._left_out.append(channels.why_left_out(self._stored, one["channel"]))
                self._read += [None] if self._is_rgb else []
                continue
            field = self._field_of(volume) if len(of_each) == 1 else ""
            if field:
                self._colors = self._cropped(volume, chosen, progress)
                values = FIELDS[field](volume.values, progress)
                # The boundary of labels is smooth without Smooth, which the notes propose.
                notes = [note for note in volume.notes if note not in about_labels(volume)]
                volume = replace(volume, values=values, labels=(), notes=notes)
            read = self._cropped(volume, {**chosen, "field": field}, progress)
            if self._is_rgb and self._read:
                # Only the isosurfaces of the first are shown.
                read = replace(read, why_both_sides="")
            if field == "labels":
                read = replace(read, isovalue=0.5, isovalue_range=_AROUND_BOUNDARY)
            self._read.append(read)
            progress.check()

        if self._is_rgb and len(self._left_out) == 2:
            # A single channel gives a color, but no texture.
            self._is_rgb, self._read = False, [read for read in self._read[1:] if read]

    def _cropped(self, volume, choices, progress):
        """Returns the _Read of a volume. Raises LeaflightError."""
        if self._crop is None:
            return _Read.of_volume(volume, choices)
        region = self._crop.region_of(volume)
        cropped = source_files.changed(volume, [region], progress)
        return _Read.of_volume(cropped, {**choices, "regions": json.dumps([region])})

    def _field_of(self, volume):
        """Returns the key of FIELDS for a single volume of both signs or of labels, or ""."""
        if self._stored.frames > 1:
            return ""
        if self._both_signs and has_lobes(volume):
            return "absolute"
        if not self._labels or volume.labels:
            return "labels" if self._labels else ""
        found = volume.distribution
        is_map = found.are_labels and len(found.levels[0]) > 2 and min(found.levels[0]) == 0
        return "labels" if is_map else ""

    def apply(self):
        context, first = bpy.context, self._read[0]
        volume = first.volume
        self.warnings = (*volume.notes, *self._left_out)
        obj = self._add(context, first)
        self._stand(context, obj)
        if self._colors is not None:
            self._color(context, obj, first.choices["field"])
        others = [read and self._add_over(context, obj, read, "") for read in self._read[1:]]
        if self._stored.channels > 1 and self._colors is None:
            channels.dress(obj, others, self._stored, self._is_rgb)
        if self._animate and obj.leaflight.frames > 1:
            for each in filter(None, (obj, *others)):
                blender.animate_frames(each)
        display.select(context, [obj], obj)
        isovalues.lock_interface(context.scene)
        nz, ny, nx = volume.values.shape
        low, high = figures(*first.range)
        step = self._choices["downsample"]
        return (
            f"{volume.name}: {nx} x {ny} x {nz} voxels, values {low} to {high}"
            + channels.about(others, self._stored, self._is_rgb)
            + (f", read at 1/{step} of its resolution" if step > 1 else "")
            + (
                "; the file has no orientation: choose Up and Front under Stage"
                if obj.leaflight_orientation.is_unknown
                else ""
            )
        )

    def _add(self, context, read):
        """Returns a new object that shows a volume of the file. Raises LeaflightError."""
        volume = read.volume
        obj = surface_object.create(context, volume, self._size)
        try:
            obj.leaflight.unit = self._stored.unit or self._unit
            placing.place(context, obj, volume, self._size_from, self._partner)
        except LeaflightError:
            bpy.data.meshes.remove(obj.data)
            raise

        settings = obj.leaflight
        settings.source = self._path
        for name, value in read.choices.items():
            setattr(settings, name, value)
        settings.frames = self._stored.frames
        settings.shown_frame = max(settings.frame, 0)
        settings.low, settings.high = read.isovalue_range
        if read.why_both_sides:
            settings.both_sides = True
            self.warnings += (f"{read.why_both_sides}, so Both Sides is on for the bake.",)
        settings.is_volume = True
        cache.forget_unused()
        cache.keep_volume(obj, volume)
        if volume.labels:
            label_list.fill_if_empty(obj)
        settings["isovalue"] = read.isovalue
        settings.limit_isovalue(read.range, read.isovalue_range, read.isovalue)
        surface_object.update(obj, read.isovalue)
        return obj

    def _add_over(self, context, obj, read, name):
        """Returns a new object in the place of another one of the same file."""
        other = self._add(context, read)
        other.name, other.matrix_world = name, obj.matrix_world
        orientation.take_over(other, obj)
        return other

    def _color(self, context, obj, field):
        """Adds the values of the file as the colors of the isosurfaces of a field."""
        # Only the isosurfaces of the field are shown.
        read = replace(self._colors, why_both_sides="")
        name = iface_("%s sign") if field == "absolute" else iface_("%s labels")
        other = self._add_over(context, obj, read, name % obj.name)
        settings, width = obj.leaflight, SIGN_WIDTH * self._read[0].range[1]
        if field == "labels":
            label_list.fill_if_empty(other)
            settings.texture_kind = "LABELS"
        settings.texture_map = _OF_SIGNS
        settings.texture_volume = other
        settings.texture_low, settings.texture_high = -width, width

    def _stand(self, context, obj):
        """Orients a volume and places it among the others."""
        orientation.begin(obj, self._stored.patient, *self._axes)
        if self._size_from != "AUTO":
            return
        partner = placing.registered(context, obj, self._stored.patient)
        if partner and not any(self._axes):
            placing.place(context, obj, self._read[0].volume, "SAME", partner)
            orientation.take_over(obj, context.scene.objects[partner])
        else:
            placing.put_beside(context, obj)
