# SPDX-License-Identifier: GPL-3.0-or-later
"""The stills of a comparison: baked, path-traced by Cycles, and by local shading.

Cycles renders baked and path-traced stills with the same walls and lights. Only the material of the
isosurface differs. In the baked still it emits the baked radiance, which is all the light that
leaves it, and reflects nothing. A path that hits the isosurface therefore ends there, and its light
reaches the walls exactly once. The pixels of a diffuse isosurface have no noise. Their difference
is the error of the bake plus the noise of Cycles. Paths show the surroundings in a mirror or glass,
with noise in both stills. The noise of each still is measured from two halves of its samples.

Local shading is the thesis's local illumination, which viewers of isosurfaces show. It has the
light of lamps on the surface, without shadows and without light between surfaces.
"""

import contextlib
import time

import bpy
import numpy as np
from leaflight import LeaflightError
from leaflight.bake import color_error
from leaflight.measure.flip import flip
from leaflight.volume.setting_error import check_is_baked

from .. import versions
from ..show import display, exploded, fill, isosurface, isovalues, surface_material, surface_object
from ..stage import scene_export
from ..store import source_files
from . import render

# Largest error of the mean in percent. Bakes of the tests, with 32 texels per axis, reach 1.4.
MEAN_OF_A_GOOD_BAKE = 2.0


def rms_percent(image, reference, exposure, mask):
    """Returns the RMS error by thesis Eq. 4.11, corrected, over the pixels of a mask; NaN for an
    empty mask.
    """
    if not mask.any():
        return float("nan")
    return color_error.rms_percent(image[mask], reference[mask], exposure)


def mean_off(baked_halves, cycles_halves, mask):
    """Returns the difference of the mean of the baked still from that of Cycles, in percent.

    Also returns half of its 95 % interval, from the difference of each still's halves at each
    pixel. Both are NaN if the mask is empty or Cycles is black.
    """
    off = within = float("nan")
    if mask.any():
        (baked, baked_error), (cycles, cycles_error) = (
            _mean(halves, mask) for halves in (baked_halves, cycles_halves)
        )
        if cycles > 0:
            off = baked / cycles - 1
            within = color_error.REACH * np.hypot(baked_error, cycles_error * (1 + off)) / cycles
    return {
        "isosurface_mean_off_percent": 100 * float(off),
        "isosurface_mean_off_within": 100 * float(within),
    }


def _mean(halves, mask):
    """Returns (mean over the mask, its standard error) of a still, given as two halves of its
    samples.
    """
    a, b = (half[mask].mean(axis=1, dtype=np.float64) for half in halves)
    return 0.5 * (a.mean() + b.mean()), 0.5 * np.sqrt(np.sum((a - b) ** 2)) / len(a)


def summary(result):
    off, within = result["isosurface_mean_off_percent"], result["isosurface_mean_off_within"]
    return (
        f"Isovalue {result['isovalue']:g}: RMS {result['isosurface_rms_percent']:.2f} % on the "
        f"isosurface, of which noise {result['isosurface_noise_percent']:.2f} %; mean off by "
        f"{off:+.2f} +- {within:.2f} %"
        + (", more than noise explains" if abs(off) > within else "")
        + f"; {flip_words(result)}"
    )


def flip_words(result):
    mean = result["flip_mean"]
    return "no FLIP: flip-evaluator is missing" if mean is None else f"FLIP {mean:.3f}"


def doubt(result):
    """Returns a sentence if noise and texels cannot explain the error of the mean, or ""."""
    off, within = result["isosurface_mean_off_percent"], result["isosurface_mean_off_within"]
    if not abs(off) - within > MEAN_OF_A_GOOD_BAKE:
        return ""
    return (
        f"The mean is off by {off:+.1f} % ({within:.1f} % is noise, {MEAN_OF_A_GOOD_BAKE:g} % "
        "texels of a good bake), so Cycles renders a brighter or darker scene: bake again, with "
        "more texels or samples"
    )


_MASK_SAMPLES = 16
_LOCAL_SAMPLES = 64


def compare(context, volume, samples, baked_samples, share=1.0, report=None):
    """Renders the stills of the current frame, at a share of the scene's resolution.

    report: Called before each render as report(done, part, name): the finished share of the work,
        the share of this render, and its name.
    Raises LeaflightError. Returns a dict with these keys, among others.

    baked, cycles, local, difference: Images (height, width, 3) in linear radiance.
    coverage: Share of each pixel that the isosurface fills, (height, width).
    isosurface_rms_percent, image_rms_percent: RMS error over pixels of the isosurface, and over
        all, by thesis Eq. 4.11 corrected. Colors are multiplied by the exposure and clamped to
        0..1.
    isosurface_noise_percent: Part of isosurface_rms_percent that is noise of both stills.
    isosurface_mean_off_percent, isosurface_mean_off_within: See mean_off().
    flip_mean, flip_percentile_95: FLIP of all pixels (measure/flip.py). None without
        flip-evaluator.
    local_rms_percent: RMS error of local shading against Cycles over pixels of the isosurface.
    baked_seconds, cycles_seconds, local_seconds, bake_seconds: Seconds of the renders and the bake.
    """
    scene = context.scene
    isovalue = volume.evaluated_get(context.evaluated_depsgraph_get()).leaflight.isovalue
    check_lit(volume, isovalue)
    report = _SampleProgress(
        report, 2 * (baked_samples // 2 + samples // 2) + _MASK_SAMPLES + _LOCAL_SAMPLES
    )
    percentage = max(1, round(share * scene.render.resolution_percentage))
    with _volumes_alone(scene), render.overridden(scene.render, resolution_percentage=percentage):
        baked_halves, baked_seconds = _halves(scene, baked_samples, report, "Baked")
        with _seen_alone(context, volume):
            report(_MASK_SAMPLES, "Where the isosurface is")
            mask = render.cycles_still(scene, _MASK_SAMPLES, seed=0, transparent=True)
        with _path_traced(context, volume):
            local, local_seconds = _local(context, report)
            cycles_halves, cycles_seconds = _halves(scene, samples, report, "Cycles")

    exposure = 2.0**scene.view_settings.exposure
    coverage = mask[..., 3]
    filled = coverage > 0.999
    baked, cycles = (0.5 * (a + b) for a, b in (baked_halves, cycles_halves))
    noise = [
        0.5 * rms_percent(one, other, exposure, filled)
        for one, other in (baked_halves, cycles_halves)
    ]
    everywhere = np.ones_like(filled)
    return {
        "baked": baked,
        "cycles": cycles,
        "local": local,
        "difference": baked - cycles,
        "coverage": coverage,
        "isovalue": isovalue,
        "samples": samples,
        "exposure": exposure,
        "isosurface_pixels": int(filled.sum()),
        "isosurface_rms_percent": rms_percent(baked, cycles, exposure, filled),
        "isosurface_noise_percent": float(np.hypot(*noise)),
        **mean_off(baked_halves, cycles_halves, filled),
        "image_rms_percent": rms_percent(baked, cycles, exposure, everywhere),
        **_flip(baked, cycles, exposure),
        "local_rms_percent": rms_percent(local, cycles, exposure, filled),
        "bake_seconds": volume.leaflight.bake_seconds,
        "baked_seconds": baked_seconds,
        "cycles_seconds": cycles_seconds,
        "local_seconds": local_seconds,
    }


def _flip(baked, cycles, exposure):
    """Returns the FLIP figures, None without flip-evaluator, which PyPI lacks for some Pythons."""
    try:
        seen = flip(baked, cycles, exposure)
    except LeaflightError:
        return {"flip_mean": None, "flip_percentile_95": None}
    return {"flip_mean": seen.mean, "flip_percentile_95": seen.percentile_95}


class _SampleProgress:
    """A count of rendered samples, whose share of `total` goes to a function."""

    def __init__(self, report, total):
        self._report, self._total, self._done = report, total, 0

    def __call__(self, samples, name):
        if self._report is not None:
            self._report(self._done / self._total, samples / self._total, name)
        self._done += samples


def _halves(scene, samples, report, name):
    """Returns (two stills with half of the samples and different seeds, seconds of both)."""
    start, halves = time.perf_counter(), []
    for seed in (1, 2):
        report(samples // 2, name)
        halves.append(render.cycles_still(scene, samples // 2, seed)[..., :3])
    return halves, time.perf_counter() - start


def _local(context, report):
    """Returns (still of local shading, its seconds)."""
    report(_LOCAL_SAMPLES, "Local shading")
    start = time.perf_counter()
    with contextlib.ExitStack() as stack:
        for obj in context.view_layer.objects:
            stack.enter_context(render.overridden(obj, visible_shadow=False))
        still = render.cycles_still(context.scene, _LOCAL_SAMPLES, seed=0, max_bounces=0)
    return still[..., :3], time.perf_counter() - start


def check_lit(volume, isovalue):
    settings = volume.leaflight
    check_is_baked(isovalue, isovalues.isovalue_range(settings))
    if settings.isosurface_scattering != "DIFFUSE":
        if not settings.bake_walls:
            raise LeaflightError(
                f'"{volume.name}" is a mirror or glass, which shows only the walls: bake with '
                "Light the Walls, or select a diffuse volume."
            )
    elif source_files.values_changed(settings):
        raise LeaflightError(
            f'The data of "{volume.name}" have changed since the bake: bake again.'
        )
    elif not isosurface.is_lit(volume, isovalue):
        raise LeaflightError(
            f'Capped of "{volume.name}" has changed since the bake, so it is not lit: bake again.'
        )


@contextlib.contextmanager
def _volumes_alone(scene):
    """Shows only the first isosurface of each volume, uncut, closed and opaque, as in the bake."""
    uncut = {"opacity": 1.0, "is_cut": False, "gloss": 0.0}
    with contextlib.ExitStack() as stack:
        for obj in isovalues.isosurfaces(scene):
            shown = uncut | ({} if display.is_added(obj) else {"explode_axis": exploded.CLOSED})
            stack.enter_context(render.overridden(obj.leaflight_look, **shown))
            if display.is_added(obj):
                stack.enter_context(render.overridden(obj, hide_render=True))
        yield


@contextlib.contextmanager
def _path_traced(context, volume):
    """Shows the original walls, and volumes with their unlit materials."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(render.overridden(context.scene.leaflight, show_walls=False))
        for obj in scene_export.volume_objects(context, volume):
            stack.enter_context(_own_material(context, obj))
        yield


@contextlib.contextmanager
def _own_material(context, volume):
    """Shows a volume with the unlit material of its isosurface and the normals of the bake."""
    isovalue = surface_object.shown_isovalue(volume)
    surface = isosurface.isosurface_of(volume, isovalue)
    vertices, normals, triangles = surface.mesh()
    shown = volume.data
    mesh = bpy.data.meshes.new("Leaflight Comparison")
    try:
        fill.fill(mesh, vertices, triangles, surface.texture(vertices))
        versions.set_normals(mesh, normals)
        mesh.materials.append(surface_material.isosurface_material(volume, isovalue))
        surface_object.mark_shown(mesh, shown)
        volume.data = mesh
        context.view_layer.update()
        yield
    finally:
        volume.data = shown
        bpy.data.meshes.remove(mesh)


@contextlib.contextmanager
def _seen_alone(context, volume):
    """Makes all other objects holdouts. Alpha is then the share that the isosurface fills."""
    others = [obj for obj in context.view_layer.objects if obj != volume]
    with contextlib.ExitStack() as stack:
        for obj in others:
            stack.enter_context(render.overridden(obj, is_holdout=True))
        yield
