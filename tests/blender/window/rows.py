# SPDX-License-Identifier: GPL-3.0-or-later
"""How test_window_operators.py presses each operator of the add-on, and which state it checks.

Plain data for pytest and Blender: the names are those of scenes.py, seen.py and pressing.py.
"""

from dataclasses import dataclass, field

# Ways to press each operator.
HAPPY, CANCELLED, DELETED, NEW = "happy", "cancelled", "object deleted", "new file"
# Ways only for background work.
UNDONE, CLOSED = "step before undone", "window closed"
# Way only for operators that finish at once.
BESIDE = "beside a bake"
WAYS = (HAPPY, CANCELLED, DELETED, NEW, UNDONE, CLOSED, BESIDE)

_INSTANT = dict.fromkeys(
    (CANCELLED, DELETED, NEW), "It is over before Blender takes another event."
)
_LIKE_ONE_VOLUME = dict.fromkeys((CANCELLED, NEW, CLOSED), "It is that of one volume.")
_DIALOG = dict.fromkeys((DELETED, NEW), "Its dialog takes all events until it is closed.")


@dataclass(frozen=True)
class Row:
    """An operator, and how it is pressed.

    operator: its name without "leaflight."
    scene: the scene of scenes.py to open first
    sees: the name in seen.py of the state that it changes
    options: arguments of the operator
    asks: "dialog" or "browser", if the press opens one
    file: the file that the browser chooses
    held: the point halfway: before the "work" in the background, after its first "pass", while
    its "dialog" or browser is open, or while it takes events ("modal")
    without: {way: reason} for the ways that make no sense
    clicks: True if its "modal" waits for a click on the volume, not for a drag in the histogram
    also: words that distinguish it from another row of the same operator
    short: True if the short suite includes it
    undone: True if undo restores the state from before
    """

    operator: str
    scene: str
    sees: str
    options: dict = field(default_factory=dict)
    asks: str = ""
    file: str = ""
    held: str = ""
    without: dict = field(default_factory=dict)
    clicks: bool = False
    also: str = ""
    short: bool = False
    undone: bool = True

    @property
    def name(self):
        return f"{self.operator}, {self.also}" if self.also else self.operator

    @property
    def ways(self):
        ways = [HAPPY, CANCELLED, DELETED, NEW]
        if self.held in ("work", "pass"):
            ways += [UNDONE, CLOSED]
        if not self.held and self.scene not in ("home", "baking", "stopped", "living"):
            ways += [BESIDE]
        return [way for way in ways if way not in self.without]


def _instant(operator, scene, sees, **how):
    return Row(operator, scene, sees, without=_INSTANT, **how)


# The short suite presses twelve operators of the guide's main path: import, stage, bake, stop,
# keep, continue, add an isosurface, preset, cut, slice, label and export.
ROWS = (
    Row(
        "import_volume",
        "home",
        "volumes",
        asks="browser",
        file="head.nii.gz",
        held="work",
        without={DELETED: "There is no object before the file is read."},
        short=True,
    ),
    Row(
        "import_volume",
        "imported",
        "volumes",
        {"size_from": "SAME", "partner": "head"},
        asks="browser",
        file="head.nii.gz",
        held="work",
        also="in the place of another",
    ),
    _instant("open_example", "home", "volumes", short=True),
    Row("load_bake", "home", "lit", asks="browser", file="a bake", held="dialog"),
    Row("load_bake", "imported", "lit", asks="browser", file="a bake", held="dialog", also="of it"),
    Row("relocate_bake", "moved", "bake path", asks="browser", file="a bake", held="dialog"),
    _instant("stage", "imported", "stage", short=True),
    Row(
        "stage",
        "imported",
        "stage",
        {"preset": "MY_SCENE"},
        asks="dialog",
        held="dialog",
        without={HAPPY: "Its dialog asks for a collection, which no key chooses.", **_DIALOG},
        also="My Scene",
    ),
    _instant("frame_isosurface", "moved on", "camera"),
    _instant("show_hidden", "staged", "hidden"),
    _instant("turn_volume", "staged", "stands", options={"way": "TIP"}, also="tip"),
    _instant("turn_volume", "baked", "stands", options={"way": "TURN"}, also="lit"),
    Row("bake", "staged", "lit", held="pass", short=True),
    Row(
        "bake",
        "two",
        "lit",
        held="pass",
        without=_LIKE_ONE_VOLUME,
        also="two volumes",
    ),
    Row(
        "bake",
        "colored",
        "lit",
        held="pass",
        without=_LIKE_ONE_VOLUME,
        also="colored by another volume",
    ),
    Row(
        "bake",
        "walled",
        "lit",
        held="pass",
        without=dict.fromkeys((CANCELLED, DELETED, NEW, CLOSED), "It is that without walls."),
        also="with walls",
    ),
    Row("bake_frames", "frames", "baked frames", held="pass"),
    _instant("stop_bake", "baking", "at work", short=True),
    Row("keep_bake", "stopped", "lit", held="work", short=True),
    # Undo cannot restore passes, which no file contains.
    _instant("throw_bake_away", "stopped", "waits", undone=False),
    _instant("stop_live", "living", "live"),
    Row("continue_bake", "unreached", "lit", held="pass", short=True),
    Row("finer_texels", "baked", "lit", held="pass"),
    Row("resume_bake", "interrupted", "lit", held="pass"),
    Row("estimate_bake", "staged", "estimate", held="work"),
    Row(
        "remove_unused_bakes",
        "unused",
        "files of bakes",
        asks="dialog",
        held="dialog",
        without=_DIALOG,
    ),
    Row("photon_cloud", "staged", "photons", {"count": 2000}, asks="dialog", held="work"),
    Row(
        "render_comparison",
        "baked",
        "comparison",
        {"samples": 2, "baked_samples": 2, "share": 10.0},
        asks="dialog",
        held="work",
    ),
    Row("export", "baked", "exported", asks="browser", held="work", short=True),
    Row("export_page", "baked", "exported", asks="browser", held="work"),
    Row("pick_isovalue", "imported", "isovalue", held="modal"),
    Row("smooth", "imported", "smoothing", {"what": "smooth", "amount": "1"}, held="work"),
    Row("cut_data", "clipped", "regions", {"cut": "capped"}, held="work"),
    Row("mask_data", "labeled", "regions", {"label_map": "regions labels"}, held="work"),
    Row("crop_to_shown", "imported", "regions", held="work"),
    Row("clean_data", "parts", "regions", {"kind": "largest_part"}, held="work"),
    Row("move_parts", "exploded", "regions", held="work"),
    Row("remove_part", "parts", "regions", held="modal", clicks=True),
    Row("remove_sphere", "aimed", "regions", asks="dialog", held="work"),
    Row("switch_region", "cleaned", "regions", {"index": 0}, held="work"),
    _instant("isosurface_preset", "baked", "look", options={"preset": "COPPER"}, short=True),
    _instant("show_labels", "labeled", "hidden labels", options={"which": "ACTIVE"}),
    Row(
        "read_label_table",
        "labeled",
        "names of labels",
        asks="browser",
        file="names.txt",
        held="dialog",
    ),
    _instant("add_stop", "baked", "stops"),
    _instant("remove_stop", "stops", "stops"),
    _instant("add_isosurface", "baked", "isosurfaces", short=True),
    _instant("remove_isosurface", "several", "isosurfaces", options={"name": "head Isosurface"}),
    _instant("add_clip_box", "baked", "clip box", short=True),
    _instant("animate", "baked", "keyframes", options={"kind": "SWEEP"}, short=True),
    _instant("animate", "baked", "keyframes", options={"kind": "TURNTABLE"}, also="turntable"),
    _instant("animate", "baked", "keyframes", options={"kind": "WIPE"}, also="wipe"),
    _instant("animate", "baked", "baked frames", options={"kind": "LIT_WIPE"}, also="lit wipe"),
    _instant("copy_report", "home", "clipboard"),
    _instant("add_scale_bar", "baked", "labels"),
    _instant("add_letters", "baked", "labels"),
    _instant("add_orientation_cube", "baked", "labels"),
    _instant("add_color_bar", "colored", "labels"),
)

# Operators that cannot be pressed, each with its reason.
UNPRESSED = {
    "go_on": "It takes over the work of a window that was closed, by itself.",
}
