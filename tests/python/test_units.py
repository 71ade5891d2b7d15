# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that units of the data, such as particles per cubic meter, do not change the light."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume
from outcomes import refused

FIXED = {"samples": 4, "photons": 3000}
WORK = {
    "passes": (leaflight.bake, {"error": 6.0, "both_sides": True, "walls": True}),
    "fixed": (leaflight.thesis.bake, FIXED),
    "thesis": (leaflight.thesis.bake, {**FIXED, "estimator": "thesis"}),
}


def lit(volume, unit, work):
    scaled = Volume(volume.values * np.float32(unit), volume.index_to_world, volume.name)
    light, settings = WORK[work]
    bake = light(scaled, isovalues=(30.0 * unit, 90.0 * unit), **settings)
    return bake, bake.surface(47.0 * unit)


@pytest.mark.slow
@pytest.mark.parametrize("work", WORK)
def test_powers_of_two_change_no_bit(work):
    box = leaflight.bump_box(14)
    bake, surface = lit(box, 1.0, work)
    assert surface.radiance.mean() > 0.1
    for exponent in (-110, 50, 115):
        other, same = lit(box, 2.0**exponent, work)
        assert np.array_equal(same.vertices, surface.vertices), exponent
        assert np.array_equal(same.radiance, surface.radiance), exponent
        for name in ("estimated_rms_percent", "passes", "texels", "rays"):
            assert getattr(other.statistics, name) == getattr(bake.statistics, name), (
                exponent,
                name,
            )


def test_beyond_single_precision_is_refused():
    box = leaflight.bump_box(6)
    for unit in (1e-40, 1e36):
        refused("in units", lit, box, unit, "passes")
