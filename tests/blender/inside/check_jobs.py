# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that an exception in any callback of a job ends the job and frees the add-on."""

import json
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import bpy
import leaflight
import pytest
from leaflight_addon.bake import bake, continue_bake, estimate_bake, live, photon_cloud, stopped
from leaflight_addon.compare import render_comparison
from leaflight_addon.export import export_bake
from leaflight_addon.importing import import_job, read_again
from leaflight_addon.operators import failures, jobs
from leaflight_addon.show import preview, surface_material, surface_object, whole_detail
from passes import Window

CALLBACKS = ("run", "fraction", "status", "show", "ended", "apply", "failed")
# Jobs that need a special driver.
SPECIAL = {live.LiveJob, whole_detail._Making, export_bake._SizeJob}
UNREACHED = 0.01


def _bake(obj):
    return bake.BakeJob(bpy.context, obj)


def _continue(obj):
    obj.leaflight.error = 0.5
    return continue_bake.ContinueJob(bpy.context, obj)


def _keep(obj):
    obj.leaflight.error = UNREACHED
    job = _bake(obj)
    work = jobs.BackgroundWork(job)
    while job.latest is None:
        time.sleep(0.01)
    work.cancel()
    with suppress(leaflight.Cancelled):
        work.result()
    job.ended()
    return stopped.KeepJob(job)


def _smooth(obj):
    return read_again.ReadAgainJob(obj, "Smooth", "smooth", 1.0, lambda obj: obj.name)


def _options(operator, **chosen):
    """Returns the properties of an operator with their defaults, and the chosen values."""
    found = {}
    for one in operator.get_rna_type().properties:
        is_array = getattr(one, "is_array", False)
        found[one.identifier] = one.default_array if is_array else getattr(one, "default", None)
    return SimpleNamespace(**{**found, **chosen})


def _import(obj):
    choices = {name: getattr(obj.leaflight, name) for name in import_job.source_files.CHOICES}
    options = _options(bpy.ops.leaflight.import_volume, filepath=obj.leaflight.source, **choices)
    return import_job.ImportJob(bpy.context, options)


def _photons(obj):
    options = _options(bpy.ops.leaflight.photon_cloud, count=1000)
    return photon_cloud.PhotonJob(bpy.context, obj, options)


def _export(obj):
    path = Path(bpy.path.abspath("//out.ply"))
    return export_bake.ExportJob(obj, path, [obj.leaflight.isovalue])


def _compare(obj):
    """Makes a comparison whose renderer is replaced by a program that returns figures at once."""
    job = render_comparison.ComparisonJob(obj, bpy.path.abspath("//pictures"), 2, 2, 0.1)
    figures = {"sentence": "Alike", "doubt": "", "report": "Alike"}
    job._command = ["echo", render_comparison.MARK + json.dumps(figures)]
    return job


MAKERS = {
    bake.BakeJob: _bake,
    continue_bake.ContinueJob: _continue,
    stopped.KeepJob: _keep,
    estimate_bake.EstimateJob: lambda obj: estimate_bake.EstimateJob(bpy.context, obj),
    read_again.ReadAgainJob: _smooth,
    import_job.ImportJob: _import,
    photon_cloud.PhotonJob: _photons,
    export_bake.ExportJob: _export,
    render_comparison.ComparisonJob: _compare,
}


def _all_jobs(kind=jobs.Job):
    for each in kind.__subclasses__():
        yield each
        yield from _all_jobs(each)


def check_each_job_has_its_check():
    assert set(_all_jobs()) - {_EndlessJob} == {*MAKERS, *SPECIAL}


@pytest.fixture
def small(boxed, tmp_path):
    """Yields a quickly baked volume in a saved file."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "jobs.blend"))
    boxed.leaflight.error, boxed.leaflight.resolution = 20.0, 9
    bpy.ops.leaflight.bake()
    yield boxed
    stopped.offer(None)
    failures.forget()
    surface_object.forget_passes()


@pytest.mark.parametrize("kind", MAKERS, ids=lambda kind: kind.__name__)
def check_an_error_in_any_callback_ends_the_job(small, monkeypatch, kind):
    for callback in CALLBACKS:
        with monkeypatch.context() as patch:
            _break(MAKERS[kind](small), callback, patch)
        stopped.offer(None)
    # The next work must start normally.
    assert Window(MAKERS[kind](small)).run() == {"FINISHED"} and not failures.sentence()
    assert not [obj for obj in bpy.data.objects if surface_material._is_first_light(obj)]


def _break(job, callback, patch):
    """Drives a job with a callback that raises an exception."""
    called = []

    def broken(*_):
        called.append(callback)
        raise KeyError("broken on purpose")

    patch.setattr(job, callback, broken)
    if callback == "failed":
        patch.setattr(job, "apply", broken)
    window = Window(job)
    assert window.run(cancels=callback == "ended") <= {"CANCELLED", "FINISHED"}
    assert jobs.running() is None
    if called:
        errors = [text for kind, text in window.said if kind == "ERROR"]
        assert any("broken on purpose" in text for text in errors), (callback, window.said)
        assert "KeyError" in failures.report() and "broken on purpose" in failures.sentence()


class _EndlessJob(bake.BakeJob):
    """A bake whose first pass lasts until the bake is cancelled."""

    def _light(self, on_pass, progress):
        def hold(baked):
            on_pass(baked)
            while not progress.cancelled:
                time.sleep(0.005)

        baked = super()._light(on_pass=hold, progress=progress)
        # The first pass may be the last, which is returned without a callback.
        hold(baked)
        return baked


def check_a_job_whose_passes_cannot_be_shown_offers_the_last(small, monkeypatch):
    small.leaflight.error = UNREACHED
    job = _EndlessJob(bpy.context, small)
    shown = job.show

    def broken():
        if job.latest is None:
            return shown()
        raise KeyError("broken on purpose")

    monkeypatch.setattr(job, "show", broken)
    assert Window(job).run() == {"CANCELLED"}
    assert stopped.offered() is job and job.latest is not None
    monkeypatch.undo()
    first = small.leaflight.bake_id
    assert bpy.ops.leaflight.keep_bake() == {"FINISHED"}
    assert small.leaflight.bake_id != first and preview.of(small) is None


def check_start_and_the_next_job_may_raise(small):
    window = Window(None)
    window.operator.start = lambda _context: 1 // 0
    assert window.run() == {"CANCELLED"} and "ZeroDivisionError" in window.said[-1][1]
    window = Window(estimate_bake.EstimateJob(bpy.context, small))
    window.operator.next_job = lambda _context: 1 // 0
    assert window.run() == {"CANCELLED"} and "ZeroDivisionError" in window.said[-1][1]
    assert jobs.running() is None


def check_a_page_whose_size_is_not_found_has_none(small, monkeypatch):
    monkeypatch.setattr(export_bake, "estimated_bytes", None)
    size = partial(export_bake.LEAFLIGHT_OT_export_page._size, SimpleNamespace(coarser=0), small)
    while size() == "Estimating its size":
        time.sleep(0.01)
    assert size() == ""


def check_live_goes_on_after_an_error(small, monkeypatch):
    monkeypatch.setattr(live, "_is_in_window", lambda: True)
    bpy.context.scene.leaflight_live = True
    bpy.data.objects.remove(next(o for o in bpy.data.objects if o.type == "LIGHT"))
    with monkeypatch.context() as patch:
        patch.setattr(live, "_wanted", lambda _context: 1 // 0)
        live._has_changed = True
        assert live._tick() is None
    assert "ZeroDivisionError" in live.sentence() and live.at_work() is None
    live.forget()
    bpy.context.scene.leaflight_live = False


def check_a_deleted_volume_stops_its_bake(small):
    small.leaflight.error = UNREACHED
    job = _EndlessJob(bpy.context, small)
    window = Window(job)
    shown = job.show

    def delete():
        shown()
        if job.latest is not None and small.name in bpy.data.objects:
            bpy.data.objects.remove(small)

    job.show = delete
    assert window.run() == {"CANCELLED"}
    assert "was deleted" in failures.sentence() and stopped.offered() is None


def check_a_renamed_volume_keeps_its_bake(small):
    job = bake.BakeJob(bpy.context, small)
    before, small.name = small.leaflight.bake_id, "another name"
    job.latest = None
    small.leaflight.seed = 1
    assert Window(job).run() == {"FINISHED"} and job.names == ["another name"]
    assert small.leaflight.bake_id and before
