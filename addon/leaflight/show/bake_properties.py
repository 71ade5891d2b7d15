# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of Object.leaflight about the next bake and the last one."""

from .. import versions
from ..props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

# Target error of each quality, in percent.
QUALITIES = {"DRAFT": 4.0, "GOOD": 1.5, "FINAL": 0.7}
QUALITY_ITEMS = [
    ("DRAFT", "Draft", "Quick preview with noise"),
    ("GOOD", "Good", "Little noise; suits most work"),
    ("FINAL", "Final", "Very little noise, for stills; several times the time of Good"),
    ("CUSTOM", "Custom", "Error set under Advanced"),
]


def _quality(settings):
    """Returns the index of the quality with the present error, or that of Custom."""
    near = (n for n, error in enumerate(QUALITIES.values()) if abs(settings.error - error) < 1e-3)
    return next(near, len(QUALITIES))


def _set_quality(settings, number):
    if number < len(QUALITIES):
        settings.error = list(QUALITIES.values())[number]


def _switches_on(name):
    """Returns an update function that enables the property `name`."""

    def changed(settings, _context):
        setattr(settings, name, True)

    return changed


class BakeOptions:
    """The quality of the next bake."""

    low: FloatProperty("Lowest Isovalue", "Lowest isovalue to bake")
    high: FloatProperty("Highest Isovalue", "Highest isovalue to bake")
    use_resolution: BoolProperty(
        "Texels",
        "Set the number of texels, for volumes that exceed the memory or the time. "
        "Otherwise it follows from the voxels",
    )
    resolution: IntProperty(
        "Texels",
        "Texels along the longest side. Fewer are faster and blur the light",
        128,
        min=2,
        soft_max=1024,
        update=_switches_on("use_resolution"),
    )
    quality: EnumProperty(
        "Quality", "Accuracy of the bake", QUALITY_ITEMS, get=_quality, set=_set_quality
    )
    error: FloatProperty(
        "Error",
        "Target error, in percent of the displayable range, if Draft, Good and Final do not suit",
        QUALITIES["GOOD"],
        subtype="PERCENTAGE",
        min=0.01,
        soft_min=0.2,
        soft_max=10.0,
        max=100.0,
        precision=2,
    )
    use_time_limit: BoolProperty(
        "Time Limit", "Stop after a number of seconds. A short time makes the light coarser"
    )
    time_limit: FloatProperty(
        "Seconds",
        "Upper bound on the seconds of the bake",
        60.0,
        subtype="TIME_ABSOLUTE",
        min=0.1,
        soft_max=600.0,
        precision=1,
        update=_switches_on("use_time_limit"),
    )
    seed: IntProperty(
        "Seed",
        "Seed of the random numbers. Another seed changes the noise, but not the detail",
        min=0,
    )
    both_sides: BoolProperty(
        "Both Sides",
        "Bake the backs of isosurfaces, too, for volumes that are cut open. Nearly "
        "doubles the time",
    )
    light_walls: BoolProperty(
        "Light the Walls",
        "Bake the light of the walls for every isovalue, too, so that their shadows "
        "and color bleeding follow the isosurface",
    )
    bake_folder: StringProperty(
        "Folder",
        "Folder of the bakes; empty is the folder leaflight beside the .blend",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
    )


class BakeRecord:
    """The bake that lights a volume. frame_bakes.py stores one for each frame."""

    bake_path: StringProperty("Bake", subtype="FILE_PATH", options=versions.RELATIVE_PATH)
    bake_matrix: FloatVectorProperty("Transform at the Bake, by Rows", size=16)
    bake_fingerprint: StringProperty("Scene at the Bake")
    bake_lamps: StringProperty("Lamps at the Bake")
    bake_id: StringProperty("Bake Identifier")
    bake_home: StringProperty("Last Folder of the Bake")
    bake_values: StringProperty("Hash of the Values at the Bake")
    bake_file_state: StringProperty("Volume File at the Bake")
    bake_changes: StringProperty("Changes of the Values at the Bake")
    bake_index: IntProperty("Number Among the Volumes Baked Together")
    bake_low: FloatProperty("Lowest Isovalue of the Bake")
    bake_high: FloatProperty("Highest Isovalue of the Bake")
    bake_walls: BoolProperty("Walls Lit by the Bake")
    bake_seconds: FloatProperty("Bake Time")
    bake_outcome: StringProperty("Error That the Bake Reached")
    bake_error: FloatProperty("Estimated Error of the Bake")
    bake_target: FloatProperty("Target Error of the Bake, 0 for None")
    bake_needs_texels: BoolProperty("Most of the Error Is Detail Finer than the Texels")
    bake_warnings: StringProperty("Warnings of the Bake")
    comparison: StringProperty("Last Comparison")
    atlas_columns: IntProperty("Columns of the Atlas, 0 for None")
