# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""Render Comparison: the baked surface beside the same surface path-traced by Cycles.

Both stills go through Cycles with the same walls and lights; only the leaf's material differs. In
the baked still it emits the baked radiance, which is all the light that leaves it, and reflects
nothing: a path from the camera or from a wall that meets the leaf ends there with the answer the
bake has stored. So the leaf's light reaches the walls exactly once, the walls look right, and the
leaf's pixels have no noise: what differs there is the error of the bake plus the noise of Cycles,
which is measured as well, from two halves of its samples.
"""

import contextlib
import json
import time
from pathlib import Path

import bpy
import leaflight
import leaflight._core as _core
import numpy as np
from bpy.props import IntProperty, StringProperty
from leaflight.bake import color_error

from .. import versions
from ..operators import checks
from ..show import isovalues, surface_object
from ..stage import scene_export
from ..store import bake_files
from . import render

LeaflightError = leaflight.LeaflightError

# In the PNG of the difference, which would be all black otherwise. The EXR holds it signed and as
# it is.
DIFFERENCE_GAIN = 5.0

_MASK_SAMPLES = 16


class LEAFLIGHT_OT_render_comparison(bpy.types.Operator):
    bl_idname = "leaflight.render_comparison"
    bl_label = "Render Comparison"
    bl_description = (
        "Render the baked surface and the same surface path-traced by Cycles, and measure the "
        "difference. Blender waits for the renders"
    )

    samples: IntProperty(
        name="Cycles Samples",
        description="Samples per pixel of the path-traced still",
        default=256,
        min=2,
        soft_max=4096,
    )
    baked_samples: IntProperty(
        name="Baked Samples",
        description="Samples per pixel of the baked still; only its walls need many",
        default=64,
        min=1,
        soft_max=4096,
    )
    folder: StringProperty(
        name="Folder",
        description="Folder for the images; empty means beside the bake",
        subtype="DIR_PATH",
    )

    @classmethod
    def poll(cls, context):
        if not checks.has_bake(cls, context):
            return False
        if context.scene.camera is None:
            cls.poll_message_set("Add a camera to the scene first")
            return False
        return True

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        leaf = context.object
        isovalue = leaf.leaflight.isovalue
        try:
            scene_export.export_scene(context, leaf)
            folder = self._make_folder(leaf)
            result = compare(context, leaf, self.samples, self.baked_samples)
            stem = f"{leaf.name}_{isovalue:g}".replace("/", "_")
            write(context.scene, folder / stem, result)
        except LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        rms, noise = result["leaf_rms_percent"], result["leaf_noise_percent"]
        leaf.leaflight.comparison = (
            f"RMS {rms:.2f} % on the leaf, of which Cycles noise {noise:.2f} %; mean off by "
            f"{result['leaf_mean_off_percent']:+.2f} +- {result['leaf_mean_off_within']:.2f} %"
        )
        self.report({"INFO"}, f"{leaf.leaflight.comparison}; images in {folder}")
        return {"FINISHED"}

    def _make_folder(self, leaf):
        chosen = self.folder or str(bake_files.locate(leaf).parent)
        folder = Path(bpy.path.abspath(chosen))
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise LeaflightError(
                f"{folder}: cannot make this folder: {error.strerror}; choose another."
            ) from None
        return folder


def compare(context, leaf, samples, baked_samples):
    """Renders both stills of the current frame.

    Returns a dict: images baked, cycles, difference (height, width, 3) in linear radiance and
    coverage (height, width), the share of each pixel that the leaf fills; leaf_rms_percent over the
    pixels that the leaf fills and image_rms_percent over all (thesis Eq. 4.11 corrected: colours
    times exposure, clamped to 0..1); leaf_noise_percent, what the noise of Cycles adds to the
    former; leaf_mean_off_percent, how much more radiance the leaf's pixels have than in Cycles,
    nothing clamped, and leaf_mean_off_within, half of its interval of 95 %; baked_seconds,
    cycles_seconds. Raises LeaflightError.
    """
    scene = context.scene
    isovalue = leaf.evaluated_get(context.evaluated_depsgraph_get()).leaflight.isovalue
    _check_lit(leaf, isovalue)
    start = time.perf_counter()
    baked = render.cycles_still(scene, baked_samples, seed=0)[..., :3]
    baked_seconds = time.perf_counter() - start
    with _seen_alone(context, leaf):
        coverage = render.cycles_still(scene, _MASK_SAMPLES, seed=0, transparent=True)[..., 3]
    start = time.perf_counter()
    with _path_traced(context, leaf):
        halves = [render.cycles_still(scene, samples // 2, seed)[..., :3] for seed in (1, 2)]
    cycles_seconds = time.perf_counter() - start

    exposure = 2.0**scene.view_settings.exposure
    cycles = 0.5 * (halves[0] + halves[1])
    filled = coverage > 0.999
    everywhere = np.ones_like(filled)
    return {
        "baked": baked,
        "cycles": cycles,
        "difference": baked - cycles,
        "coverage": coverage,
        "isovalue": isovalue,
        "samples": samples,
        "leaf_pixels": int(filled.sum()),
        "leaf_rms_percent": rms_percent(baked, cycles, exposure, filled),
        "leaf_noise_percent": 0.5 * rms_percent(*halves, exposure, filled),
        **mean_off(baked, halves, filled),
        "image_rms_percent": rms_percent(baked, cycles, exposure, everywhere),
        "baked_seconds": baked_seconds,
        "cycles_seconds": cycles_seconds,
    }


def _check_lit(leaf, isovalue):
    settings = leaf.leaflight
    low, high = isovalues.window(settings)
    if not low <= isovalue <= high:
        raise LeaflightError(
            f"Isovalue {isovalue:g} lies outside the baked window {low:g} to {high:g}: choose one "
            "inside, or bake with a wider window."
        )
    if settings.leaf_scattering != "DIFFUSE":
        if not settings.bake_surroundings:
            raise LeaflightError(
                f'"{leaf.name}" is a mirror or glass, which only shows its surroundings: bake with '
                "Light the Surroundings, or select a diffuse volume."
            )
    elif not surface_object.is_lit(leaf, isovalue):
        raise LeaflightError(
            f'"{leaf.name}" is capped otherwise than in its bake, so it is not lit: bake again.'
        )


def rms_percent(image, reference, exposure, mask):
    """Thesis Eq. 4.11, corrected, over the pixels of the mask; NaN where there are none."""
    if not mask.any():
        return float("nan")
    return color_error.rms_percent(image[mask], reference[mask], exposure)


def mean_off(image, halves, mask):
    """By how many percent the mean of an image differs from that of two halves of Cycles' samples.

    With half of its interval of 95 %, which the halves' difference tells, pixel by pixel; NaN where
    the mask holds no pixels, or all is dark.
    """
    off = within = float("nan")
    if mask.any():
        own, *each = (x[mask].mean(axis=1, dtype=np.float64) for x in (image, *halves))
        mean = 0.5 * (each[0].mean() + each[1].mean())
        error = 0.5 * np.sqrt(np.sum((each[0] - each[1]) ** 2)) / len(own)
        if mean > 0:
            off, within = float(own.mean() / mean - 1), float(color_error.REACH * error / mean)
    return {"leaf_mean_off_percent": 100.0 * off, "leaf_mean_off_within": 100.0 * within}


def write(scene, stem, result):
    """Writes <stem>_{baked,cycles,difference}.{exr,png} and <stem>_comparison.json."""
    for name in ("baked", "cycles", "difference"):
        image = np.ascontiguousarray(result[name])
        _core.write_exr(f"{stem}_{name}.exr", image)
        shown = DIFFERENCE_GAIN * np.abs(image) if name == "difference" else image
        render.write_png(scene, f"{stem}_{name}.png", shown)
    numbers = {key: value for key, value in result.items() if not isinstance(value, np.ndarray)}
    Path(f"{stem}_comparison.json").write_text(json.dumps(numbers, indent=2) + "\n")


@contextlib.contextmanager
def _path_traced(context, leaf):
    """All that was baked as it is: the surroundings themselves, the volumes with their own material."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(render.overridden(context.scene.leaflight, show_walls=False))
        for obj in scene_export.volume_objects(context, leaf):
            stack.enter_context(_own_material(context, obj))
        yield


@contextlib.contextmanager
def _own_material(context, leaf):
    """The same mesh with the leaf's own material and the normals that the bake shades with."""
    isovalue = surface_object.shown_isovalue(leaf)
    vertices, normals, triangles = surface_object.contour(leaf, isovalue)
    shown = leaf.data
    mesh = bpy.data.meshes.new("Leaflight Comparison")
    try:
        surface_object.fill(mesh, vertices, triangles, {})
        versions.set_normals(mesh, normals)
        mesh.materials.append(surface_object.leaf_material(leaf))
        surface_object.mark_shown(mesh, shown)
        leaf.data = mesh
        context.view_layer.update()
        yield
    finally:
        leaf.data = shown
        bpy.data.meshes.remove(mesh)


@contextlib.contextmanager
def _seen_alone(context, leaf):
    """Everything else becomes a hole, so that alpha is the share of a pixel that the leaf fills."""
    others = [obj for obj in context.view_layer.objects if obj != leaf]
    with contextlib.ExitStack() as stack:
        for obj in others:
            stack.enter_context(render.overridden(obj, is_holdout=True))
        yield


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_render_comparison)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_render_comparison)
