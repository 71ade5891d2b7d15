# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of Object.leaflight about the next bake and the last one."""

from bpy.props import EnumProperty

from .. import versions
from .overridable import (
    BoolProperty,
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

# Arguments of the property Error.
ERROR = {
    "name": "Error",
    "description": "Target error, in percent of the displayable range",
    "subtype": "PERCENTAGE",
    "default": QUALITIES["GOOD"],
    "min": 0.01,
    "soft_min": 0.2,
    "soft_max": 10.0,
    "max": 100.0,
    "precision": 2,
}
_WHEN_TO_CHANGE = "Target error, if Draft, Good and Final do not suit"


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

    low: FloatProperty(
        name="Lowest Isovalue",
        description="Lowest isovalue to bake",
    )
    high: FloatProperty(
        name="Highest Isovalue",
        description="Highest isovalue to bake",
    )
    use_resolution: BoolProperty(
        name="Texels",
        description="Set the number of texels, for volumes that exceed the memory or the time. "
        "Otherwise it follows from the voxels",
    )
    resolution: IntProperty(
        name="Texels",
        description="Texels along the longest side. Fewer are faster and blur the light",
        default=128,
        min=2,
        soft_max=1024,
        update=_switches_on("use_resolution"),
    )
    quality: EnumProperty(
        name="Quality",
        description="Accuracy of the bake",
        items=QUALITY_ITEMS,
        get=_quality,
        set=_set_quality,
    )
    error: FloatProperty(
        **{**ERROR, "description": f"{ERROR['description']}. {_WHEN_TO_CHANGE}"},
    )
    use_time_limit: BoolProperty(
        name="Time Limit",
        description="Stop after a number of seconds. A short time makes the light coarser",
    )
    time_limit: FloatProperty(
        name="Seconds",
        description="Upper bound on the seconds of the bake",
        subtype="TIME_ABSOLUTE",
        default=60.0,
        min=0.1,
        soft_max=600.0,
        precision=1,
        update=_switches_on("use_time_limit"),
    )
    seed: IntProperty(
        name="Seed",
        description="Seed of the random numbers. Another seed changes the noise, but not the "
        "detail",
        min=0,
    )
    both_sides: BoolProperty(
        name="Both Sides",
        description="Bake the backs of isosurfaces, too, for volumes that are cut open. Nearly "
        "doubles the time",
    )
    light_walls: BoolProperty(
        name="Light the Walls",
        description="Bake the light of the walls for every isovalue, too, so that their shadows "
        "and color bleeding follow the isosurface",
    )
    bake_folder: StringProperty(
        name="Folder",
        description="Folder of the bakes; empty is the folder leaflight beside the .blend",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
    )


class BakeRecord:
    """The bake that lights a volume. frame_bakes.py stores one for each frame."""

    bake_path: StringProperty(name="Bake", subtype="FILE_PATH", options=versions.RELATIVE_PATH)
    bake_matrix: FloatVectorProperty(name="Transform at the Bake, by Rows", size=16)
    bake_fingerprint: StringProperty(name="Scene at the Bake")
    bake_lamps: StringProperty(name="Lamps at the Bake")
    bake_id: StringProperty(name="Bake Identifier")
    bake_home: StringProperty(name="Last Folder of the Bake")
    bake_values: StringProperty(name="Hash of the Values at the Bake")
    bake_file_state: StringProperty(name="Volume File at the Bake")
    bake_smoothing: FloatVectorProperty(name="Smoothing of Values and Normals at the Bake", size=2)
    bake_index: IntProperty(name="Number Among the Volumes Baked Together")
    bake_low: FloatProperty(name="Lowest Isovalue of the Bake")
    bake_high: FloatProperty(name="Highest Isovalue of the Bake")
    bake_walls: BoolProperty(name="Walls Lit by the Bake")
    bake_seconds: FloatProperty(name="Bake Time")
    bake_outcome: StringProperty(name="Error That the Bake Reached")
    bake_error: FloatProperty(name="Estimated Error of the Bake")
    bake_target: FloatProperty(name="Target Error of the Bake, 0 for None")
    bake_needs_texels: BoolProperty(name="Most of the Error Is Detail Finer than the Texels")
    bake_warnings: StringProperty(name="Warnings of the Bake")
    comparison: StringProperty(name="Last Comparison")
    atlas_columns: IntProperty(name="Columns of the Atlas, 0 for None")
