# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes by rays: several volumes, mirrors and glass, to an error, in a time, continued."""

from dataclasses import replace
from functools import partial

import leaflight
import numpy as np
import pytest
from leaflight import Cancelled, Progress, lapr, load_bake, refine
from leaflight.bake.checkpoint import Checkpoint
from leaflight.bake.statistics import outcome
from same_bytes import assert_same_light

UNREACHED = 1e-3


@pytest.fixture
def two(lapr_scene):
    """Returns bake(**settings) of two volumes of 10^3 nodes."""
    return partial(leaflight.bake, list(lapr(10)), lapr_scene)


@pytest.fixture
def beside(root):
    """Returns f(name) -> bake(**settings) of the bump box with 8^3 nodes in a shipped scene."""

    def bake_in(name, **settings):
        scene = leaflight.load_scene(root / "scenes" / f"{name}.json")
        settings = {"isovalues": (30.0, 70.0), **settings}
        return partial(leaflight.bake, leaflight.bump_box(8), scene, **settings)

    return bake_in


@pytest.fixture
def mirror(beside):
    return beside("mirror")


@pytest.fixture
def glass(beside):
    """Returns a bake of a floor with the caustics of a glass isosurface."""
    return beside("glass_isosurface", walls=True)


def test_an_error_is_reached_in_passes(two, mirror):
    for bake in (two, mirror):
        seen = []
        baked = bake(error=4.0, on_pass=seen.append)
        assert 0 < baked.statistics.estimated_error_percent < 4.0
        assert not baked.statistics.stopped and baked.provenance.blocks >= 4
        assert len(seen) == baked.statistics.passes - 1
        assert "(target 4 %)" in outcome(baked)


def test_a_glass_isosurface_has_the_error_of_its_walls(glass):
    baked = glass(error=20.0)
    assert 0 < baked.statistics.estimated_error_percent < 20
    assert baked.walls.radiance(0, 50.0).mean() > 0.01
    late = glass(error=UNREACHED, time=1e-9)
    assert late.statistics.stopped and "was not reached" in outcome(late)


def test_the_time_ends_it(two):
    baked = two(error=UNREACHED, time=1e-9)
    assert baked.statistics.stopped and baked.statistics.passes == 1
    assert baked.surface(0.5).radiance.mean() > 0.01


def test_an_interrupted_bake_goes_on_with_the_same_bits(mirror, two, tmp_path):
    for number, bake in enumerate((two, mirror)):
        checkpoint = Checkpoint(tmp_path / str(number), seconds=0.0)
        progress = Progress()
        hooks = {"on_pass": lambda _: progress.cancel(), "progress": progress}
        with pytest.raises(Cancelled):
            bake(error=2.0, threads=1, checkpoint=checkpoint, **hooks)
        resumed = bake(error=2.0, threads=2, checkpoint=replace(checkpoint, resume=True))
        assert_same_light(resumed, bake(error=2.0))


def test_it_is_continued_from_its_file(two, tmp_path):
    progress = Progress()
    first = two(error=UNREACHED, on_pass=lambda _: progress.stop(), progress=progress)
    first.save(tmp_path / "first.vdb")
    loaded = load_bake(tmp_path / "first.vdb")
    points = first.surface(0.5, 1).vertices
    light = [one.radiance(points, 1) for one in (loaded, first)]
    np.testing.assert_allclose(*light, rtol=2**-9, atol=1e-5)
    more = [refine(one, error=2.0) for one in (first, loaded)]
    assert_same_light(*more)
    was, now = (one.statistics.estimated_error_percent for one in (first, more[0]))
    assert now < was and more[0].provenance.blocks > first.provenance.blocks


def test_lamps_of_several_volumes_are_relit(two):
    baked = two(error=20.0)
    lamp = baked.scene.lights[0].name
    points = baked.surface(0.5).vertices
    relit = baked.relit({lamp: 2}).radiance(points)
    np.testing.assert_allclose(relit, 2 * baked.radiance(points), rtol=1e-3)
