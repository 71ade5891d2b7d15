# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove Unused Bakes: the files of bakes that lie with this .blend and light nothing in it.

Those of .blends that were never saved are among them, once nothing can need them any more.
"""

import bpy
from leaflight import LeaflightError

from ..operators import checks
from ..store import atlases, bake_files, frame_bakes
from ..translations import iface_

# Rows of the list before it is cut short.
_MOST_ROWS = 12


class LEAFLIGHT_OT_remove_unused_bakes(checks.LeaflightOperator, bpy.types.Operator):
    bl_idname = "leaflight.remove_unused_bakes"
    bl_label = "Remove Unused Bakes"
    bl_description = (
        "Delete the files of bakes in the folders of this .blend that light none of its volumes. "
        "Undo, and other .blend files that use them, then lose their light"
    )
    bl_options = set()
    conditions = (
        checks.needs(
            lambda _: unused(), "Every bake in the folders of this .blend lights a volume of it"
        ),
    )

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self, width=500)

    def draw(self, _context):
        column = self.layout.column(align=True)
        column.label(text="Undo and other .blend files that use them lose their light:")
        found = unused()
        for path in found[:_MOST_ROWS]:
            column.label(text=f"{path.name}, {megabytes([path])}", icon="FILE")
        if len(found) > _MOST_ROWS:
            column.label(text=iface_("and %d more") % (len(found) - _MOST_ROWS), icon="BLANK1")

    def run(self, _context):
        found = unused()
        size = megabytes(found)
        for path in found:
            try:
                for file in (path, *atlases.beside(path)):
                    file.unlink()
                bake_files.remove_if_empty(path.parent)
            except OSError as error:
                raise LeaflightError(f"{path}: cannot delete it: {error.strerror}.") from None
        self.report({"INFO"}, f"Removed {len(found)} bakes, {size}")


def of_this_file():
    """The bakes in the folders where bakes of this .blend go or went, each a path."""
    volumes = [obj for obj in bpy.data.objects if obj.leaflight.is_volume and obj.library is None]
    folders = [bake_files.folder_for(obj) for obj in volumes] + bake_files.folders_of_unsaved()
    return [path for folder in dict.fromkeys(folders) for path in bake_files.bakes_in(folder)]


def unused():
    """Those of of_this_file() that light no object of this .blend."""
    return unused_among(of_this_file())


def unused_among(bakes):
    """Those of some bakes, each a path, that light no object of this .blend."""
    lit = set().union(*(frame_bakes.bakes_of(obj.leaflight) for obj in bpy.data.objects))
    return [path for path in bakes if bake_files.id_in(path) not in lit]


def megabytes(paths):
    """The size of bakes with their atlases, as text."""
    files = [file for path in paths for file in (path, *atlases.beside(path))]
    return f"{sum(file.stat().st_size for file in files) / 1e6:.1f} MB"


CLASSES = (LEAFLIGHT_OT_remove_unused_bakes,)
