# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes whose parts several processes compute, also if some of them die."""

import os
import signal
import socket
import threading
from dataclasses import replace

import leaflight
import pytest
from leaflight import Cancelled, Progress, load_bake, texture_of
from leaflight.bake.bake import task_of, worker_memory

pytest.importorskip("distributed")

from cone import cone  # noqa: E402
from distributed import LocalCluster  # noqa: E402
from leaflight.cluster import part_tracer  # noqa: E402
from leaflight.cluster.workers import Workers  # noqa: E402
from leaflight.volume.regions import HalfSpace, changed  # noqa: E402
from outcomes import refused
from same_bytes import assert_same_light  # noqa: E402
from waiting import HANG, wait_for  # noqa: E402

# These settings need several passes.
SETTINGS = {"error": 0.5, "isovalues": (30.0, 70.0), "both_sides": True, "walls": True}


@pytest.fixture(scope="module")
def volume():
    return cone(16, is_open=True)


@pytest.fixture(scope="module")
def alone(volume):
    return leaflight.bake(volume, **SETTINGS)


@pytest.fixture
def workers():
    with Workers(2) as started:
        yield started


@pytest.mark.parametrize("count", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_any_number_of_workers(volume, alone, count):
    with Workers(count) as workers:
        assert workers.processes() == count
        assert_same_light(leaflight.bake(volume, workers=workers, **SETTINGS), alone)
        assert workers.traced >= 4 and workers.lost == 0


SCENES = {
    "cut": lambda: (changed(cone(16), [HalfSpace((0.5, 0.5, 0.5), (0.3, -0.5, 1.0))]), None),
    "smooth normals": lambda: (replace(cone(16), smooth_normals=1.3), None),
    "texture": lambda: (
        cone(16),
        leaflight.cornell_box().colored_by(texture_of(cone(8), "MAGMA", nearest=True)),
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_workers_trace_all_of_a_scene(name):
    volume, scene = SCENES[name]()
    settings = {**SETTINGS, "both_sides": False, "walls": False}
    with Workers(1) as workers:
        found = leaflight.bake(volume, scene, workers=workers, **settings)
        assert workers.traced > 0
    assert_same_light(found, leaflight.bake(volume, scene, **settings))


@pytest.mark.slow
def test_workers_that_die(volume, alone, workers):
    """Kills a worker after each pass; new workers start without the data of the bake."""
    killed = []

    def kill(_bake):
        alive = []
        while not alive:
            # The client may not have noticed that the last killed worker is dead.
            found = workers.client.run(os.getpid, on_error="ignore")
            alive = [pid for pid in found.values() if pid not in killed]
        killed.append(alive[0])
        os.kill(killed[-1], signal.SIGKILL)

    assert_same_light(leaflight.bake(volume, workers=workers, on_pass=kill, **SETTINGS), alone)
    assert killed and workers.traced > 0


@pytest.mark.slow
def test_nobody_is_left(volume, alone):
    """Checks that the bake continues without workers."""
    workers = Workers(2)
    close = {"on_pass": lambda _bake: workers.close()}
    assert_same_light(leaflight.bake(volume, workers=workers, **close, **SETTINGS), alone)
    assert workers.traced > 0 and workers.lost > 0


@pytest.mark.slow
def test_a_scheduler_loses_its_workers(volume, alone):
    with LocalCluster(1, dashboard_address="127.0.0.1:0", memory_limit=0) as cluster:
        with Workers(scheduler=cluster.scheduler_address, patience_seconds=5) as workers:
            leave = {"on_pass": lambda _bake: cluster.scale(0)}
            assert_same_light(leaflight.bake(volume, workers=workers, **leave, **SETTINGS), alone)
            assert workers.traced > 0 and workers.lost > 0


@pytest.mark.slow
def test_going_on_with_a_bake(volume, workers):
    progress = Progress()
    part = leaflight.bake(
        volume, progress=progress, on_pass=lambda _: progress.stop(), **{**SETTINGS, "error": 1.0}
    )
    alone = leaflight.refine(part, error=0.2)
    assert_same_light(leaflight.refine(part, error=0.2, workers=workers), alone)
    assert workers.traced > 0


def never_done():
    """Makes this worker compute each part again and again."""

    traced = part_tracer._Tracer.traced

    def traced_forever(self, sent, part):
        while True:
            traced(self, sent, part)

    part_tracer._Tracer.traced = traced_forever


def test_cancel_goes_through(volume, workers):
    """Checks that workers stop with a cancelled bake, and are free for the next."""
    workers.client.run(never_done)
    progress, outcome = Progress(), []

    def work():
        try:
            leaflight.bake(volume, workers=workers, progress=progress, **SETTINGS)
        except Cancelled as error:
            outcome.append(error)

    def is_traced():
        return any(workers.client.run(lambda: part_tracer._tracer is not None).values())

    bake = threading.Thread(target=work)
    bake.start()
    assert wait_for(is_traced, bake.is_alive)
    progress.cancel()
    bake.join(HANG)
    assert len(outcome) == 1
    assert workers.client.submit(abs, -1).result(timeout=HANG) == 1
    assert not is_traced()


def test_workers_of_another_leaflight(volume, workers, monkeypatch):
    monkeypatch.setattr(part_tracer.Recipe, "__init__", _of_another(part_tracer.Recipe.__init__))
    refused("install the same", leaflight.bake, volume, workers=workers, **SETTINGS)


def _of_another(init):
    return lambda recipe, **parts: init(recipe, **parts, version="0.0.1")


def test_what_cannot_be_shared(volume, workers):
    refused("one volume", leaflight.bake, leaflight.lapr(12), workers=workers)
    refused("number of workers", Workers, 0)
    refused("either", Workers)
    with socket.socket() as silent:
        # Reserve a port on which nothing answers.
        silent.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        refused(address, Workers, scheduler=address, patience_seconds=1)


@pytest.mark.slow
def test_the_command_line(cli, tmp_path):
    """Checks the command's own workers, and those of a running scheduler."""
    arguments = ["bake", "bump_box", "--dims", "12", "--error", "4", "--out"]
    outs = [tmp_path / f"{name}.vdb" for name in ("alone", "two", "scheduler")]
    with LocalCluster(2, dashboard_address="127.0.0.1:0", memory_limit=0) as cluster:
        address = cluster.scheduler_address
        for out, who in zip(outs, ([], ["--workers", "2"], ["--scheduler", address])):
            cli.runs(*arguments, out, *who)
            assert not list(tmp_path.glob("*.checkpoint"))
        assert len(cluster.workers) == 2, "they are not ours to end"
    bakes = [load_bake(out) for out in outs]
    for bake in bakes[1:]:
        assert_same_light(bake, bakes[0])


@pytest.mark.slow
def test_memory_is_reported_beforehand(cli):
    assert worker_memory(task_of(leaflight.bump_box(40))) > 4 * 40**3
    options = ("--dims", "20", "--error", "5", "--workers", "2", "--estimate")
    assert "each worker needs about" in cli.runs("bake", "bump_box", *options)


@pytest.mark.machine
def test_workers_hold_what_was_reported(workers):
    volume = leaflight.bump_box(100)
    reported = worker_memory(task_of(volume))
    (before, *_) = (low for low in workers.client.run(resident).values())
    leaflight.bake(volume, error=4.0, workers=workers)
    held = max(workers.client.run(resident).values()) - before
    assert 0.5 * reported < held < 1.5 * reported


def resident():
    """Returns the peak memory of this process in bytes. ru_maxrss would include its parent."""
    lines = open("/proc/self/status").read().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
