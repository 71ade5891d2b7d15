# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers for checks of bakes in passes."""

import math
import time
from dataclasses import replace
from itertools import cycle
from pathlib import Path
from types import SimpleNamespace

import bpy
import leaflight
import pytest
from leaflight_addon.bake import bake
from leaflight_addon.operators import background
from tools import close, mesh_arrays, start, to_world, wait_while

# Target error that takes all passes of a bake with noise (fixture "noisy"), which no check waits
# for.
UNREACHED = 0.01


def state():
    """Returns the state that a discarded bake must not change."""
    obj = bpy.context.object
    return {
        "objects": sorted(o.name for o in bpy.data.objects),
        "meshes": sorted(m.name for m in bpy.data.meshes),
        "materials": sorted(m.name for m in bpy.data.materials),
        "images": sorted(i.name for i in bpy.data.images),
        "material": obj.data.materials[0].name,
        "nodes": sorted(n.type for n in obj.data.materials[0].node_tree.nodes),
        "attributes": sorted(a.name for a in obj.data.attributes),
        "bake": obj.leaflight.bake_id,
        "vertices": mesh_arrays(obj)[0].tobytes(),
        "isovalue": obj.leaflight.isovalue,
        "files": sorted(Path(obj.leaflight.bake_folder).glob("*.*")),
    }


def begin(obj, passes=1, kind=bake.BakeJob):
    """Returns a bake in progress after this many passes, as a BakeJob and its BackgroundWork.

    The next pass waits until job.most allows it, or until the bake is cancelled.
    """

    class Held(kind):
        most = passes

        def __init__(self, context, obj):
            super().__init__(context, obj)
            # Save no checkpoint while it waits.
            self.checkpoint = replace(self.checkpoint, seconds=math.inf)

        def _light(self, on_pass, progress):
            def hold(baked):
                while baked.statistics.passes > self.most and not progress.cancelled:
                    time.sleep(0.005)
                if not progress.cancelled:
                    on_pass(baked)

            return super()._light(on_pass=hold, progress=progress)

    job = Held(bpy.context, obj)
    work = start(job)
    wait_while(work, lambda: passes_of(job) < passes)
    return job, work


def passes_of(job):
    return 0 if job.latest is None else job.latest.statistics.passes


def stop(job, work):
    work.cancel()
    with pytest.raises(leaflight.Cancelled):
        work.result()
    return job.ended()


def assert_shows_pass(obj, shown):
    vertices, _, radiance = mesh_arrays(obj)
    expected = shown.radiance(to_world(obj, vertices))
    assert len(vertices) > 100 and radiance.max() > 0.01
    close(radiance, expected, 1e-4 * expected.max())


class Window:
    """A driver of jobs, like Blender's events in a window.

    work: the work of the job, if it was started already.
    said: the reports, as (kind, text). statuses: the texts of the status bar.
    """

    def __init__(self, job, work=None):
        said, statuses = self.said, self.statuses = [], []

        class Operator(background.BackgroundOperator):
            _job, _work, _timer = job, work, None

            def start(self, _context):
                return job

            def report(self, kind, text):
                said.append((*kind, text))

        manager = SimpleNamespace(
            windows=[],
            event_timer_add=lambda *_, **__: None,
            event_timer_remove=lambda _: None,
            modal_handler_add=lambda _: None,
        )
        workspace = SimpleNamespace(status_text_set=statuses.append)
        self.context = SimpleNamespace(window=None, window_manager=manager, workspace=workspace)
        self.operator = Operator()

    def happens(self, kind):
        event = SimpleNamespace(type=kind, value="PRESS" if kind == "ESC" else "")
        return self.operator.modal(self.context, event)

    def wait(self, result=frozenset({"PASS_THROUGH"}), cancels=False):
        """Runs the timer until the work has ended."""
        events = cycle(["ESC", "TIMER"] if cancels else ["TIMER"])
        while result & {"RUNNING_MODAL", "PASS_THROUGH"}:
            result = self.happens(next(events))
            time.sleep(0.01)
        return result

    def run(self, cancels=False):
        return self.wait(self.operator.run_modal(self.context), cancels)


class Layout:
    """A recorder of what a panel draws."""

    def __init__(self, drawn):
        self._drawn = drawn

    def _sub(self, **_):
        return Layout(self._drawn)

    row = column = _sub
    scale_y, active = 1.0, True

    def prop(self, _data, name, **_):
        self._drawn.append(name)

    def prop_enum(self, _data, _name, value):
        self._drawn.append(value)

    def operator(self, name, **_):
        self._drawn.append(name)

    def operator_menu_enum(self, name, _property, **_):
        self._drawn.append(name)

    def label(self, text, **_):
        self._drawn.append(text)

    def template_list(self, name, *_, **__):
        self._drawn.append(name)


def drawn(panel):
    found = []
    context = SimpleNamespace(
        area=None,
        object=bpy.context.object,
        scene=bpy.context.scene,
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
        region=SimpleNamespace(width=2000),
        view_layer=bpy.context.view_layer,
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )
    methods = {name: f for name, f in vars(panel).items() if callable(f)}
    drawing = type("Drawing", (), methods)()
    drawing.layout = Layout(found)
    drawing.draw(context)
    return found
