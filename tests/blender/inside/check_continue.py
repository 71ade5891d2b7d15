# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Continue: a kept or finished bake continues."""

from dataclasses import replace
from pathlib import Path

import bpy
import leaflight
import pytest
from leaflight_addon.bake import bake, continue_bake
from leaflight_addon.show import preview
from leaflight_addon.stage import staleness
from leaflight_addon.store import cache
from leaflight_addon.ui import bake_panel
from passes import UNREACHED, assert_shows_pass, begin, drawn, state, stop
from tools import assert_shows, error_of


def check_a_kept_bake_is_continued(endless):
    stop(*begin(endless))
    assert "stopped bake" in error_of(bpy.ops.leaflight.continue_bake)
    bpy.ops.leaflight.keep_bake()
    kept = cache.bake_of(endless)
    noise = kept.statistics.estimated_noise_percent
    # The rest of the error is that of the texels, which stays.
    texture = kept.statistics.estimated_error_percent**2 - noise**2
    endless.leaflight.error = (texture + (0.7 * noise) ** 2) ** 0.5
    assert bpy.ops.leaflight.continue_bake() == {"FINISHED"}
    ours = cache.bake_of(endless)
    assert ours.provenance.continued == kept.id and endless.leaflight.bake_id == ours.id
    assert 0 < ours.statistics.estimated_noise_percent < 0.8 * noise
    # More passes also change the estimate of the texture error, so the target may be out of reach.
    assert f"(target {endless.leaflight.error:g} %)" in endless.leaflight.bake_outcome
    assert endless.leaflight.bake_seconds > kept.statistics.seconds
    assert_shows(endless, 50.0)
    # Both files remain, and a bake with a reached target is not continued.
    assert len(list(Path(endless.leaflight.bake_folder).glob("*.vdb"))) == 2
    endless.leaflight.error = 1.1 * ours.statistics.estimated_error_percent
    assert "smaller target" in error_of(bpy.ops.leaflight.continue_bake)
    assert cache.bake_of(endless) is ours


def check_a_continued_bake_shows_its_passes_and_is_stopped(noisy):
    noisy.leaflight.error = 20.0
    bpy.ops.leaflight.bake()
    noisy.leaflight.error = UNREACHED
    before, first = state(), cache.bake_of(noisy)
    more = first.statistics.passes + 1
    job, work = begin(noisy, more, continue_bake.ContinueJob)
    job.show()
    assert_shows_pass(noisy, preview.of(noisy).bake)
    assert "keep" in stop(job, work)
    assert job.latest.provenance.continued == first.id
    bpy.ops.leaflight.throw_bake_away()
    assert state() == before


def check_only_what_can_be_is_continued(passes, tmp_path):
    assert "Bake this volume first" in error_of(bpy.ops.leaflight.continue_bake)
    path = str(tmp_path / "fixed.vdb")
    volume, scene = cache.world_volume(passes), leaflight.cornell_box()
    baked = leaflight.bake(volume, scene, isovalues=(40.0, 60.0), error=20.0)
    # As validation/thesis saves a bake with a fixed number of samples, which has no target error.
    fixed = replace(baked.provenance, error=None, passes=0, fixed={"samples": 1})
    replace(baked, provenance=fixed).save(path)
    bpy.ops.leaflight.load_bake(filepath=path)
    assert "leaflight.continue_bake" not in drawn(bake_panel.LEAFLIGHT_PT_bake)
    assert "target error" in error_of(bpy.ops.leaflight.continue_bake)
    passes.leaflight.error = 20.0
    bpy.ops.leaflight.bake()
    # A lower target error makes the panel offer the operator that reaches it.
    settings, offers = passes.leaflight, {"leaflight.continue_bake", "leaflight.finer_texels"}
    assert not offers & set(drawn(bake_panel.LEAFLIGHT_PT_bake))
    settings.error = 0.5 * settings.bake_error
    for needs_texels, offered in ((False, "continue_bake"), (True, "finer_texels")):
        settings.bake_needs_texels = needs_texels
        assert offers & set(drawn(bake_panel.LEAFLIGHT_PT_bake)) == {f"leaflight.{offered}"}
    passes.leaflight.high = 55.0
    staleness.forget()
    assert "scene has changed" in error_of(bpy.ops.leaflight.continue_bake)


def check_finer_texels_lower_the_error(passes):
    passes.leaflight.error = 20.0
    passes.leaflight.resolution = 9
    bpy.ops.leaflight.bake()
    coarse = cache.bake_of(passes)
    assert bpy.ops.leaflight.finer_texels() == {"FINISHED"}
    fine = cache.bake_of(passes)
    assert max(fine.grid.resolution) == 2 * max(coarse.grid.resolution) - 1
    errors = [bake.statistics.estimated_error_percent for bake in (coarse, fine)]
    assert errors[1] < errors[0]


class _Interrupted(bake.BakeJob):
    """A bake that ends after its first pass, as if Blender had ended."""

    def __init__(self, context, obj):
        super().__init__(context, obj)
        self.checkpoint = replace(self.checkpoint, seconds=0.0)

    def _light(self, on_pass, progress):
        def end(bake):
            on_pass(bake)
            progress.cancel()

        return super()._light(on_pass=end, progress=progress)


def check_an_interrupted_bake_is_resumed(passes):
    assert "interrupted" in error_of(bpy.ops.leaflight.resume_bake)
    passes.leaflight.error = 0.3
    job = _Interrupted(bpy.context, passes)
    with pytest.raises(leaflight.Cancelled):
        job.run(leaflight.Progress())
    assert "leaflight.resume_bake" in drawn(bake_panel.LEAFLIGHT_PT_bake)
    # The checkpoint belongs to a bake with other settings.
    passes.leaflight.error = 0.31
    assert "belongs to another bake" in error_of(bpy.ops.leaflight.resume_bake)
    passes.leaflight.error = 0.3
    assert bpy.ops.leaflight.resume_bake() == {"FINISHED"}
    resumed = cache.bake_of(passes)
    assert "leaflight.resume_bake" not in drawn(bake_panel.LEAFLIGHT_PT_bake)
    assert not list(Path(passes.leaflight.bake_folder).glob("*.checkpoint"))
    bpy.ops.leaflight.bake()
    whole = cache.bake_of(passes)
    assert whole.id == resumed.id and whole.statistics.passes > 1
    assert (whole.grid.dense("radiance") == resumed.grid.dense("radiance")).all()
    # A discarded bake cannot be resumed.
    passes.leaflight.error = UNREACHED
    job, work = begin(passes)
    job.checkpoint.path.write_bytes(b"of this bake")
    stop(job, work)
    bpy.ops.leaflight.throw_bake_away()
    assert "leaflight.resume_bake" not in drawn(bake_panel.LEAFLIGHT_PT_bake)
