# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions for Blender's Python that do the same as the panels.

    from leaflight import blender

    head = blender.import_volume("head.nii.gz")
    blender.stage(head)
    blender.bake(head, error=1.5)
    blender.show(head, 45.5)
    blender.export(head, "head.glb")

Enable the add-on first. It runs with a window or without (`blender --background`): each function
returns when its work is done. `head` is an ordinary object. The settings of the panels are in
`head.leaflight`. Every function raises LeaflightError, one sentence, where a panel shows it.
"""

import contextlib
import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ._core import LeaflightError
from .measure import blender_versions
from .paths import AnyPath

try:
    import bpy
except ImportError:
    raise LeaflightError(
        "leaflight.blender works only inside Blender: run the script there, or use "
        "leaflight.bake() here."
    ) from None


def import_volume(path: AnyPath, **options: Any) -> bpy.types.Object:
    """Imports a volume and returns its object, which shows a default isosurface.

    path: A file of any format of File > Import.
    options: Options of the import operator, such as size (of the longest side, in Blender units),
        dims and value_type (of a .raw), frame.
    """
    _call(bpy.ops.leaflight.import_volume, filepath=_absolute(path), **options)
    return bpy.context.object


def stage(obj: bpy.types.Object, preset: str = "STUDIO", **options: Any) -> None:
    """Puts walls, lights and a camera around the volumes, and hides other objects.

    preset: Identifier of a stage of the panel.
    options: Options of the operator, such as hide_others, and collection (name, for the preset
        MY_SCENE).
    """
    with _active(obj):
        _call(bpy.ops.leaflight.stage, preset=preset, **options)


def bake(obj: bpy.types.Object, isovalues: Sequence[float] | None = None, **settings: Any) -> Path:
    """Bakes the light of every isosurface in an isovalue range, for all volumes that render.

    isovalues: Range (lowest, highest) in data units. None keeps the current range.
    settings: Attributes of obj.leaflight that the panel shows, such as error (percent), time_limit
        (seconds), both_sides, light_walls, bake_folder. They keep these values.
    Returns the path of the bake.
    """
    with _active(obj):
        _set(obj, isovalues, settings)
        _call(bpy.ops.leaflight.bake)
    return Path(os.path.normpath(bpy.path.abspath(obj.leaflight.bake_path)))


def bake_frames(
    obj: bpy.types.Object, isovalues: Sequence[float] | None = None, **settings: Any
) -> None:
    """Bakes every frame of a volume that changes over time, one after the other.

    If the frames are animated, each is baked in the scene at the time it is shown. Arguments are
    those of bake().
    """
    with _active(obj):
        _set(obj, isovalues, settings)
        _call(bpy.ops.leaflight.bake_frames)


def show(obj: bpy.types.Object, isovalue: float) -> None:
    """Shows an isosurface, lit by the bake if there is one, and updates all linked volumes.

    obj: A volume, or an object of add_isosurface().
    isovalue: Isovalue in data units.
    """
    if not isinstance(obj, bpy.types.Object) or not math.isfinite(isovalue):
        raise LeaflightError("An isosurface needs an object and a finite isovalue: give both.")
    obj.leaflight.isovalue = float(isovalue)
    bpy.context.view_layer.update()


def add_isosurface(
    obj: bpy.types.Object,
    isovalue: float,
    opacity: float = 0.3,
    color: Sequence[float] | None = None,
) -> bpy.types.Object:
    """Shows another isosurface of a volume, lit by the same bake; up to three.

    isovalue: Isovalue in data units.
    opacity: Opacity in 0..1; 1 hides everything behind the isosurface.
    color: Albedo (r, g, b). None is that of the volume. Baked light is not changed.
    Returns its object, a child of obj. show() and animate() change its isovalue, and
    `leaflight_look.opacity` its opacity.
    """
    before = set(obj.children)
    with _active(obj):
        _call(bpy.ops.leaflight.add_isosurface, isovalue=float(isovalue), opacity=opacity)
    (added,) = set(obj.children) - before
    if color is not None:
        added.leaflight_look.color = color
    return added


def clip(obj: bpy.types.Object, box: "bpy.types.Object | None", keep: str = "OUTSIDE") -> None:
    """Cuts the isosurfaces of a volume by a box that moves like any object.

    box: An object with its bounding box, or an Empty with its cube. None cuts nothing.
    keep: "OUTSIDE" removes the parts in the box, "INSIDE" keeps only these.
    Set `leaflight_look.is_cut` of an added isosurface to include it.
    """
    obj.leaflight_look.keep = keep
    obj.leaflight_look.box = box


def animate(obj: bpy.types.Object, isovalues: Iterable[float], first_frame: int = 1) -> None:
    """Keyframes one isovalue per frame, for a sweep, and sets the frame range of the scene.

    isovalues: Isovalues in data units, one for each frame from first_frame on.
    """
    settings, isovalues = obj.leaflight, [float(isovalue) for isovalue in isovalues]
    if not isovalues:
        raise LeaflightError("The list of isovalues is empty: give one for each frame.")
    for frame, isovalue in enumerate(isovalues, start=first_frame):
        # Set the stored value directly: showing each isosurface would take long.
        settings["isovalue"] = isovalue
        obj.keyframe_insert('leaflight["isovalue"]', frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = first_frame, first_frame + len(isovalues) - 1
    scene.frame_set(first_frame)


def animate_frames(obj: bpy.types.Object, first_frame: int | None = None) -> None:
    """Keyframes the frames of a volume that changes over time, one per frame of the scene.

    first_frame: Frame of the scene that shows the first one. None is the scene's first frame.
    The frame range of the scene is unchanged.
    """
    settings, scene = obj.leaflight, bpy.context.scene
    if settings.frames < 2:
        raise LeaflightError(
            f'The file of "{obj.name}" holds only one frame: animate a file with several frames.'
        )
    if first_frame is None:
        first_frame = scene.frame_start
    for frame in range(settings.frames):
        settings["shown_frame"] = frame
        obj.keyframe_insert("leaflight.shown_frame", frame=first_frame + frame)
    for curve in blender_versions.fcurves(obj):
        if curve.data_path == "leaflight.shown_frame":
            for point in curve.keyframe_points:
                # Frames are whole numbers; a linear curve would be rounded down.
                point.interpolation = "CONSTANT"
    settings["shown_frame"] = settings.frame
    scene.frame_set(scene.frame_current)


def compare(
    obj: bpy.types.Object,
    folder: AnyPath,
    samples: int = 256,
    baked_samples: int = 64,
    share: float = 1.0,
) -> dict[str, Any]:
    """Renders the view from the bake, by Cycles and by local shading, and measures differences.

    folder: Folder for the pictures, the .csv and the .json.
    samples: Samples per pixel of Cycles.
    baked_samples: Samples per pixel of the picture from the bake.
    share: Share of the scene's resolution, 0..1.
    Returns a dict of figures: isosurface_rms_percent, isosurface_noise_percent, baked_seconds, ...
    """
    folder = Path(_absolute(folder))
    before = _written(folder)
    with _active(obj):
        _call(
            bpy.ops.leaflight.render_comparison,
            folder=str(folder),
            samples=samples,
            baked_samples=baked_samples,
            share=100.0 * share,
        )
    path = max(_written(folder).items() - before.items(), key=lambda item: item[1])[0]
    figures: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return figures


def export(obj: bpy.types.Object, path: AnyPath, isovalues: Iterable[float] | None = None) -> None:
    """Writes the bake of an object in another program's format, by leaflight.export().

    path: File whose suffix chooses the format (docs/export.md).
    isovalues: Isovalues of a sequence, in data units. None is the shown one.
    """
    chosen = {}
    if isovalues is not None:
        values = " ".join(repr(float(isovalue)) for isovalue in isovalues)
        chosen = {"isovalues": "LIST", "listed": values}
    with _active(obj):
        _call(bpy.ops.leaflight.export, filepath=_absolute(path), **chosen)


def _set(
    obj: bpy.types.Object, isovalues: Sequence[float] | None, settings: dict[str, Any]
) -> None:
    """Sets the settings of a bake on an object."""
    if isovalues is not None:
        settings = {**settings, "low": float(isovalues[0]), "high": float(isovalues[1])}
    for name, value in settings.items():
        if name not in obj.leaflight.bl_rna.properties:
            raise LeaflightError(f'"{obj.name}" has no bake setting "{name}": check its name.')
        setattr(obj.leaflight, name, value)


@contextlib.contextmanager
def _active(obj: "bpy.types.Object | None") -> Iterator[None]:
    """Makes an object the active one, on which operators work, within a `with` block."""
    if obj is None or not obj.leaflight.is_volume:
        name = "None" if obj is None else f'"{obj.name}"'
        raise LeaflightError(
            f"{name} is not a Leaflight volume: give the result of import_volume()."
        )
    layer = bpy.context.view_layer
    before = layer.objects.active
    layer.objects.active = obj
    try:
        yield
    finally:
        if before is not None and before.name in layer.objects:
            layer.objects.active = before


def _call(operator: Any, **options: Any) -> None:
    """Runs an operator to its end. Raises LeaflightError with the operator's message."""
    try:
        result = operator("EXEC_DEFAULT", **options)
    except RuntimeError as error:
        sentence = str(error).strip().removeprefix("Error: ")
        # Remove the operator's name, which Blender puts before the reason why it is disabled.
        raise LeaflightError(sentence.rpartition("poll() failed, ")[2]) from None
    if "FINISHED" not in result:
        raise LeaflightError(f"{operator.idname_py()} was cancelled.")


def _absolute(path: AnyPath) -> str:
    resolved: str = bpy.path.abspath(str(path))
    return os.path.abspath(resolved)


def _written(folder: Path) -> dict[Path, int]:
    """Returns the modification time of the .json of each comparison in a folder."""
    return {path: path.stat().st_mtime_ns for path in folder.glob("*_comparison.json")}
