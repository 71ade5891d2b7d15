# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Example: a volume for a first try of Leaflight."""

from pathlib import Path

import bpy
from leaflight import LeaflightError

from ..operators import checks, jobs
from ..store import bake_files

# Files of the Colin27 brain and head in the Debian package mricron-data.
_SCANS = [Path("/usr/share/mricron/templates") / name for name in ("ch2bet.nii.gz", "ch2.nii.gz")]

# Nodes along an axis of the volume that is computed if there is no scan.
_NODES = 96


class LEAFLIGHT_OT_open_example(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Open Example"
    bl_description = (
        "Import an example: a brain scan if this computer has one (Debian's "
        "mricron-data), else a computed hydrogen atom"
    )
    conditions = (jobs.is_free, checks.in_object_mode)

    def run(self, _context):
        path = next((scan for scan in _SCANS if scan.exists()), None) or _computed()
        try:
            bpy.ops.leaflight.import_volume(filepath=str(path))
        except RuntimeError as error:
            raise LeaflightError(str(error).strip().removeprefix("Error: ")) from None


def _computed():
    """Returns the file of a computed volume. Computes it only once. Raises LeaflightError."""
    path = bake_files.user_folder() / "examples" / "hydrogen.nii.gz"
    if not path.exists():
        import nibabel
        from leaflight.volume.particles import hydrogen

        volume = hydrogen(_NODES)
        bake_files.make_folder(path.parent)
        part = path.with_name("part.nii.gz")
        nibabel.save(nibabel.Nifti1Image(volume.values.T, volume.index_to_world), part)
        part.replace(path)
    return path


def _draw_menu(menu, _context):
    menu.layout.operator(LEAFLIGHT_OT_open_example.bl_idname, text="Example for Leaflight")


CLASSES = (LEAFLIGHT_OT_open_example,)
MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
