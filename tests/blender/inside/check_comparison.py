# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Render Comparison: images, figures, and that the scene does not change."""

import csv
import importlib.util
import json
import sys
import time
from pathlib import Path

import bpy
import leaflight
import numpy as np
import pytest
from leaflight import _core
from leaflight.measure import blender_versions
from leaflight_addon import versions
from leaflight_addon.compare import render, render_comparison, stills
from leaflight_addon.show import texture
from PIL import Image
from tools import close, colors_of, error_of, start, vertices_of, wait_while


def _render_settings():
    scene = bpy.context.scene
    owners = (scene.render, scene.render.image_settings, scene.cycles, scene.view_settings)
    settings = []
    for owner in owners:
        for prop in owner.bl_rna.properties:
            if not prop.is_readonly and prop.type in {"BOOLEAN", "INT", "FLOAT", "ENUM", "STRING"}:
                value = getattr(owner, prop.identifier)
                settings.append(
                    (prop.identifier, tuple(value) if getattr(prop, "is_array", False) else value)
                )
    shown = [(o.name, o.data.name if o.data else "", o.is_holdout) for o in bpy.data.objects]
    images = [image.name for image in bpy.data.images if image.type != "RENDER_RESULT"]
    return settings, shown, [mesh.name for mesh in bpy.data.meshes], images


@pytest.fixture
def small_frame():
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 80
    scene.render.resolution_percentage = 100


def check_images_and_figures(boxed, small_frame, tmp_path):
    boxed.leaflight.error, boxed.leaflight.resolution = 1.5, 48
    boxed.leaflight.isovalue = 47.0
    bpy.ops.leaflight.bake()
    before = _render_settings()
    folder = tmp_path / "images"
    bpy.ops.leaflight.render_comparison(samples=256, baked_samples=16, folder=str(folder))
    assert _render_settings() == before

    images = {}
    for name in ("baked", "cycles", "local", "difference"):
        stem = folder / f"{boxed.name}_47_{name}"
        images[name] = _core.read_exr(f"{stem}.exr")[..., :3]
        assert images[name].shape == (80, 80, 3)
        picture = bpy.data.images.load(f"{stem}.png")
        assert tuple(picture.size) == (80, 80)
    close(images["difference"], images["baked"] - images["cycles"], 1e-5)

    result = json.loads((folder / f"{boxed.name}_47_comparison.json").read_text())
    assert result["isovalue"] == 47.0 and result["isosurface_pixels"] > 100
    assert 0 < result["isosurface_noise_percent"] < 3
    assert result["isosurface_noise_percent"] < result["isosurface_rms_percent"] < 6
    everywhere = np.ones((80, 80), bool)
    rms = stills.rms_percent(images["baked"], images["cycles"], 1.0, everywhere)
    assert rms == pytest.approx(result["image_rms_percent"], rel=1e-3)
    assert f"{result['isosurface_rms_percent']:.2f}" in boxed.leaflight.comparison
    _flip_of(result, boxed.leaflight.comparison)
    assert abs(result["isosurface_mean_off_percent"]) < 3
    assert 0 < result["isosurface_mean_off_within"] < 0.5
    assert f"mean off by {result['isosurface_mean_off_percent']:+.2f}" in boxed.leaflight.comparison
    assert "brighter or darker" not in boxed.leaflight.comparison

    _local_shading(images, result)
    _labelled_picture_and_table(folder / f"{boxed.name}_47_comparison", result)


def _flip_of(result, sentence):
    if importlib.util.find_spec("flip_evaluator") is None:
        assert result["flip_mean"] is None and "no FLIP" in sentence
        return
    assert 0 < result["flip_mean"] < 0.1
    assert result["flip_mean"] < result["flip_percentile_95"] < 0.3
    assert f"FLIP {result['flip_mean']:.3f}" in sentence


def check_it_is_shown_without_flip(baked, small_frame, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    bpy.ops.leaflight.render_comparison(samples=2, baked_samples=2, folder=str(tmp_path))
    assert "no FLIP" in baked.leaflight.comparison
    (numbers,) = tmp_path.glob("*_comparison.json")
    result = json.loads(numbers.read_text())
    assert result["flip_mean"] is None and 0 < result["isosurface_rms_percent"] < 100


def _local_shading(images, result):
    """Checks local shading: without shadows, lit parts are at least as bright as their direct
    light, but far from the full solution.
    """
    assert result["local_rms_percent"] > 2 * result["isosurface_rms_percent"]
    local = images["local"]
    assert 0.01 < local.mean() and 0.5 < local.mean() / images["cycles"].mean() < 2.0


def _labelled_picture_and_table(stem, result):
    picture = np.asarray(Image.open(f"{stem}.png").convert("RGB")) / 255.0
    assert picture.shape[0] > 2 * 560 and picture.shape[1] > 2 * 560
    # Stills fill half of the picture, and are not white; the color bar is blue below and red above.
    assert 0.5 < (picture.min(axis=2) < 0.9).mean() < 0.95
    bar = picture[picture.shape[0] // 2 :, picture.shape[1] - 90 :]
    assert ((bar[..., 0] - bar[..., 2]) > 0.4).any() and ((bar[..., 2] - bar[..., 0]) > 0.4).any()
    rows = list(csv.DictReader(Path(f"{stem}.csv").open()))
    assert [row["still"] for row in rows] == ["baked", "local", "cycles"]
    for row in rows[:2]:
        name = {"baked": "isosurface"}.get(row["still"], row["still"])
        expected = result[f"{name}_rms_percent"]
        assert float(row["rms_percent_on_isosurface"]) == pytest.approx(expected, abs=1e-4)


def check_in_a_blender_of_its_own(baked, small_frame, tmp_path):
    """Checks the job as in a window: it runs in a thread, and this Blender does not change."""
    if not render_comparison.can_start():
        pytest.skip("Blender as a Python module has no program to start")
    before, statuses = _render_settings(), []

    class Recorded(render_comparison.ComparisonJob):
        """A record of every status, however brief."""

        _status = property(lambda self: statuses[-1], lambda self, text: statuses.append(text))

    folder = tmp_path / "images"
    folder.mkdir()
    job = Recorded(baked, folder, 16, 4, 0.5)
    work = start(job)
    work.result()
    assert work.status() == statuses[-1]
    begins = f"Isovalue {baked.leaflight.isovalue:g}: RMS"
    assert job.apply().startswith(begins) and baked.leaflight.comparison.startswith(begins)
    assert _render_settings() == before
    (numbers,) = folder.glob("*_comparison.json")
    result = json.loads(numbers.read_text())
    assert 0 < result["isosurface_rms_percent"] < 10 and len(list(folder.iterdir())) == 11
    assert _core.read_exr(str(next(folder.glob("*_baked.exr")))).shape[:2] == (40, 40)
    names = {status.rpartition("%")[2].strip() for status in statuses}
    assert {"Blender starts", "Cycles"} <= names


def _cancel(isosurface, folder):
    """Cancels a comparison during its rendering, which would take hours. Returns the job and the
    seconds until it ended.
    """
    if not render_comparison.can_start():
        pytest.skip("Blender as a Python module has no program to start")
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 2000
    job = render_comparison.ComparisonJob(isosurface, folder, 4096, 4096, 1.0)
    work = start(job)
    wait_while(work, lambda: "%" not in work.status())
    assert "Baked" in work.status()
    cancelled = time.monotonic()
    work.cancel()
    with pytest.raises(leaflight.Cancelled):
        work.result()
    return job, time.monotonic() - cancelled


def check_it_is_cancelled(baked, small_frame, tmp_path):
    job, _ = _cancel(baked, tmp_path)
    assert not list(tmp_path.glob("*.png")) and not Path(job._files.name).exists()


@pytest.mark.machine
def check_it_is_cancelled_at_once(baked, small_frame, tmp_path):
    _, seconds = _cancel(baked, tmp_path)
    assert seconds < 2.0


def check_the_interval_of_the_mean_holds():
    """Checks that 95 % of the intervals contain the true deviation, for halves with noise."""
    random, mask, held = np.random.default_rng(2), np.ones((30, 30), bool), 0
    for _ in range(400):
        baked, cycles = (
            [random.normal(mean, noise, (30, 30, 1)) * np.ones(3) for _ in range(2)]
            for mean, noise in ((1.02, 0.2), (1.0, 0.3))
        )
        found = stills.mean_off(baked, cycles, mask)
        off, within = found["isosurface_mean_off_percent"], found["isosurface_mean_off_within"]
        held += abs(off - 2.0) < within
    assert 365 < held < 394


def check_a_lamp_in_wrong_units_is_noticed(boxed, small_frame, tmp_path, monkeypatch):
    """Checks wrong units of an area lamp: those of Blender 3.4 in 4.2 and later, or vice versa,
    differ by 27 % or 21 %.
    """
    right = versions.light_units()
    others = (blender_versions.light_units(version) for version in ((3, 4), (4, 2)))
    (wrong,) = (units for units in others if units != right)
    boxed.leaflight.error = 3.0
    said = []
    for units in (wrong, right):
        monkeypatch.setattr(versions, "light_units", lambda units=units: units)
        bpy.ops.leaflight.bake()
        bpy.ops.leaflight.render_comparison(samples=64, baked_samples=2, folder=str(tmp_path))
        said.append(boxed.leaflight.comparison)
    assert "more than noise explains" in said[0] and "brighter or darker" in said[0]
    assert "brighter or darker" not in said[1]


def check_rms_is_thesis_equation_4_11_corrected():
    image = np.zeros((2, 1, 3))
    reference = np.array([[[0.3, 0.0, 0.0]], [[5.0, 5.0, 5.0]]])
    all_pixels = np.ones((2, 1), bool)
    rms = stills.rms_percent(image, reference, 1.0, all_pixels)
    assert rms == pytest.approx(100 * np.sqrt((0.3**2 / 3 + 1) / 2))
    first = np.array([[True], [False]])
    assert stills.rms_percent(image, reference, 2.0, first) == pytest.approx(
        100 * np.sqrt(0.6**2 / 3)
    )


def check_outside_the_window_it_is_refused_and_nothing_has_changed(baked, small_frame, tmp_path):
    baked.leaflight.low, baked.leaflight.high = 40.0, 60.0
    baked.leaflight.isovalue = 50.0
    bpy.ops.leaflight.bake()
    baked.leaflight.isovalue = 80.0
    before = _render_settings()
    sentence = error_of(bpy.ops.leaflight.render_comparison, folder=str(tmp_path / "images"))
    assert "80" in sentence and "range" in sentence
    assert _render_settings() == before


def check_an_error_in_the_middle_restores_the_scene(baked, small_frame, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise leaflight.LeaflightError("The render was cancelled; nothing has changed.")

    before = _render_settings()
    still = render.cycles_still
    calls = []

    def fail_at_the_last(*arguments, **options):
        calls.append(1)
        return (fail if len(calls) == 6 else still)(*arguments, **options)

    monkeypatch.setattr(render, "cycles_still", fail_at_the_last)
    sentence = error_of(
        bpy.ops.leaflight.render_comparison, samples=2, baked_samples=2, folder=str(tmp_path)
    )
    assert "cancelled" in sentence and len(calls) == 6
    assert _render_settings() == before


def check_the_path_traced_surface_has_the_colors(boxed):
    boxed.leaflight.texture_kind = "HEIGHT"
    with stills._path_traced(bpy.context, boxed):
        colors = texture.local_texture(boxed).at(vertices_of(boxed))
        close(colors_of(boxed, "texture"), colors, 1e-6)
    assert np.ptp(colors) > 0.1


def check_it_needs_a_bake_and_a_camera(boxed):
    assert "Bake this volume first" in error_of(bpy.ops.leaflight.render_comparison)
