# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds background work halfway until the test releases it, or it is cancelled."""

import time

import leaflight
from leaflight_addon.operators import jobs

# Point where work waits: before it starts, or after its first pass. Empty if it does not wait.
closed = ""
# True if work waits, or has waited.
reached = False


def close(where):
    global closed, reached
    closed, reached = where, False


def open_():
    close("")


def _wait(where, progress):
    global reached
    while closed == where and not progress.cancelled:
        reached = True
        time.sleep(0.005)


def install():
    """Makes all work of the add-on pass this gate."""
    run = jobs.BackgroundWork._run

    def held(work):
        _wait("work", work.progress)
        run(work)

    jobs.BackgroundWork._run = held
    leaflight.bake, leaflight.refine = _in_passes(leaflight.bake), _in_passes(leaflight.refine)


def _in_passes(bake):
    def held(*arguments, on_pass=None, progress=None, **options):
        def hold(baked):
            if on_pass is not None:
                on_pass(baked)
            if progress is not None:
                _wait("pass", progress)

        baked = bake(*arguments, on_pass=hold, progress=progress, **options)
        if not reached:
            # The first pass reached the target, so there was no callback.
            hold(baked)
        return baked

    return held
