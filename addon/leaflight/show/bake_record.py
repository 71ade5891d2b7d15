# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of Object.leaflight about its bake."""

from .. import versions
from .overridable import (
    BoolProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)


class BakeRecord:
    """The bake that lights a volume; frame_bakes.py has these for each frame."""

    bake_path: StringProperty(name="Bake", subtype="FILE_PATH", options=versions.RELATIVE_PATH)
    bake_matrix: FloatVectorProperty(name="Transform at the Bake, Row by Row", size=16)
    bake_fingerprint: StringProperty(name="Scene at the Bake")
    bake_lamps: StringProperty(name="Lamps at the Bake")
    bake_id: StringProperty(name="Bake Identifier")
    bake_home: StringProperty(name="Folder Where the Bake Was Last")
    bake_values: StringProperty(name="Hash of the Values at the Bake")
    bake_file_state: StringProperty(name="Volume File at the Bake")
    bake_smoothing: FloatVectorProperty(name="Smoothing of Values and Normals at the Bake", size=2)
    bake_index: IntProperty(name="Place Among the Volumes Baked Together")
    bake_low: FloatProperty(name="Lowest Isovalue of the Bake")
    bake_high: FloatProperty(name="Highest Isovalue of the Bake")
    bake_walls: BoolProperty(name="Walls Lit by the Bake")
    bake_seconds: FloatProperty(name="Bake Time")
    bake_outcome: StringProperty(name="Error That the Bake Reached")
    bake_error: FloatProperty(name="Estimated Error of the Bake")
    bake_target: FloatProperty(name="Target of the Bake")
    bake_needs_texels: BoolProperty(name="Most of the Error Is Detail Finer than the Texels")
    bake_warnings: StringProperty(name="Warnings of the Bake")
    comparison: StringProperty(name="Last Comparison")
    atlas_columns: IntProperty(name="Columns of the Atlas, 0 if There Is None")
