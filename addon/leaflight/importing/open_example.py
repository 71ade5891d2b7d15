# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Example: a computed volume for a first try of Leaflight."""

from pathlib import Path

import bpy
from leaflight import LeaflightError
from leaflight.volume.examples import EXAMPLES, load

from .. import icons
from ..operators import checks, jobs
from ..props import EnumProperty
from ..store import bake_files

# Pictures of the examples by name.
_FOLDER = Path(__file__).with_name("pictures")
# Entries of the property. Blender needs a reference to their texts.
_entries = []


def _examples(_operator, _context):
    if not _entries:
        for number, (name, example) in enumerate(EXAMPLES.items()):
            picture = icons.pictures().load(name, str(_FOLDER / f"{name}.png"), "IMAGE")
            _entries.append((name, example.label, example.text, picture.icon_id, number))
    return _entries


class LEAFLIGHT_OT_open_example(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Open Example"
    bl_description = "Compute an example volume and import it"
    conditions = (jobs.is_free, checks.in_object_mode)

    example: EnumProperty("Example", "Volume to compute", _examples)

    def run(self, _context):
        path = _computed(self.example)
        try:
            bpy.ops.leaflight.import_volume(filepath=str(path))
        except RuntimeError as error:
            raise LeaflightError(str(error).strip().removeprefix("Error: ")) from None


def _computed(name):
    """Returns the file of an example. Computes it only once. Raises LeaflightError."""
    path = bake_files.user_folder() / "examples" / f"{name}.nii.gz"
    if not path.exists():
        import nibabel

        volume = load(name)
        bake_files.make_folder(path.parent)
        part = path.with_name("part.nii.gz")
        nibabel.save(nibabel.Nifti1Image(volume.values.T, volume.index_to_world), part)
        part.replace(path)
    return path


def _draw_menu(menu, _context):
    menu.layout.operator_menu_enum(
        LEAFLIGHT_OT_open_example.bl_idname, "example", text="Example for Leaflight"
    )


def unregister():
    _entries.clear()


MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
