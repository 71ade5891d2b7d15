# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""Render Comparison: the baked surface beside the same surface path-traced by Cycles.

Both stills go through Cycles with the same walls and lights; only the leaf's material differs. In
the baked still it emits the baked radiance, which is all the light that leaves it, and reflects
nothing: a path from the camera or from a wall that meets the leaf ends there with the answer the
bake has stored. So the leaf's light reaches the walls exactly once, the walls look right, and a
diffuse leaf's pixels have no noise: what differs there is the error of the bake plus the noise of
Cycles. A mirror or glass shows its surroundings by paths, with noise in both stills. So that of
each is measured as well, from two halves of its samples.
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

# Percent. The bakes of the tests, with 32 texels a side, are off by up to 1.4.
MEAN_OF_A_GOOD_BAKE = 2.0

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
        min=2,
        soft_max=4096,
    )
    folder: StringProperty(
        name="Folder",
        description="Folder for the images; empty means beside the bake",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
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
        found, doubts = summary(result), doubt(result)
        self.report({"INFO"}, f"{found}; images in {folder}")
        if doubts:
            self.report({"WARNING"}, doubts)
        leaf.leaflight.comparison = f"{found}. {doubts}" if doubts else found
        return {"FINISHED"}

    def _make_folder(self, leaf):
        chosen = self.folder or str(bake_files.locate(leaf).parent)
        folder = Path(bpy.path.abspath(chosen))
        bake_files.make_folder(folder)
        return folder


def compare(context, leaf, samples, baked_samples):
    """Renders both stills of the current frame.

    Returns a dict: images baked, cycles, difference (height, width, 3) in linear radiance and
    coverage (height, width), the share of each pixel that the leaf fills; leaf_rms_percent over the
    pixels that the leaf fills and image_rms_percent over all (thesis Eq. 4.11 corrected: colours
    times exposure, clamped to 0..1); leaf_noise_percent, what the noise of both stills adds to the
    former; leaf_mean_off_percent, how much more radiance the leaf's pixels have than in Cycles,
    nothing clamped, and leaf_mean_off_within, half of its interval of 95 %; baked_seconds,
    cycles_seconds. Raises LeaflightError.
    """
    scene = context.scene
    isovalue = leaf.evaluated_get(context.evaluated_depsgraph_get()).leaflight.isovalue
    _check_lit(leaf, isovalue)
    start = time.perf_counter()
    baked_halves = _halves(scene, baked_samples)
    baked_seconds = time.perf_counter() - start
    with _seen_alone(context, leaf):
        coverage = render.cycles_still(scene, _MASK_SAMPLES, seed=0, transparent=True)[..., 3]
    start = time.perf_counter()
    with _path_traced(context, leaf):
        cycles_halves = _halves(scene, samples)
    cycles_seconds = time.perf_counter() - start

    exposure = 2.0**scene.view_settings.exposure
    filled = coverage > 0.999
    baked, cycles = (0.5 * (a + b) for a, b in (baked_halves, cycles_halves))
    noise = [0.5 * rms_percent(*each, exposure, filled) for each in (baked_halves, cycles_halves)]
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
        "leaf_noise_percent": float(np.hypot(*noise)),
        **mean_off(baked_halves, cycles_halves, filled),
        "image_rms_percent": rms_percent(baked, cycles, exposure, everywhere),
        "baked_seconds": baked_seconds,
        "cycles_seconds": cycles_seconds,
    }


def _halves(scene, samples):
    """Two stills of half of the samples each, by different random numbers."""
    return [render.cycles_still(scene, samples // 2, seed)[..., :3] for seed in (1, 2)]


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


def mean_off(baked_halves, cycles_halves, mask):
    """By how many percent the mean of the baked still differs from that of Cycles.

    With half of its interval of 95 %, which the difference of each still's halves tells, pixel by
    pixel; NaN where the mask holds no pixels, or all is dark.
    """
    off = within = float("nan")
    if mask.any():
        (baked, baked_error), (cycles, cycles_error) = (
            _mean(halves, mask) for halves in (baked_halves, cycles_halves)
        )
        if cycles > 0:
            off = baked / cycles - 1
            within = color_error.REACH * np.hypot(baked_error, cycles_error * (1 + off)) / cycles
    return {"leaf_mean_off_percent": 100 * float(off), "leaf_mean_off_within": 100 * float(within)}


def _mean(halves, mask):
    """(mean over the mask, its standard error) of a still of two halves of samples."""
    a, b = (half[mask].mean(axis=1, dtype=np.float64) for half in halves)
    return 0.5 * (a.mean() + b.mean()), 0.5 * np.sqrt(np.sum((a - b) ** 2)) / len(a)


def summary(result):
    off, within = result["leaf_mean_off_percent"], result["leaf_mean_off_within"]
    return (
        f"RMS {result['leaf_rms_percent']:.2f} % on the leaf, of which noise "
        f"{result['leaf_noise_percent']:.2f} %; mean off by {off:+.2f} +- {within:.2f} %"
        + (", more than noise explains" if abs(off) > within else "")
    )


def doubt(result):
    """A sentence when the mean is off by more than noise and texels explain, or an empty text."""
    off, within = result["leaf_mean_off_percent"], result["leaf_mean_off_within"]
    if not abs(off) - within > MEAN_OF_A_GOOD_BAKE:
        return ""
    return (
        f"The mean is off by {off:+.1f} %, of which noise explains {within:.1f} % and the texels of "
        f"a good bake {MEAN_OF_A_GOOD_BAKE:g} %: Cycles renders something brighter or darker than "
        "it was baked; see what differs, bake again, or bake with more texels and samples"
    )


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
