# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests single precision against a build with radiance in double precision (preset double)."""

import numpy as np
import pytest
from waiting import run_python

ESTIMATORS = ("gather", "volumetric", "path", "thesis")
EPSILON = np.finfo(np.float32).eps
# Upper bound on the relative error: 64 roundings of half an epsilon. A radiance is a product of
# about 20 rounded factors, and a few sums of such products. Positions are double in both builds.
MOST = 32 * EPSILON
# Largest relative step of the light in a grid, which has the mantissa of a half (ShortFloat). An
# error hides within a step, or rounds a value the other way. If all errors were MOST, this share of
# the values would be rounded the other way.
STEP = 2.0**-10
FLIPPED = MOST / STEP
# The test part `double` makes the build; other runs might find an old one.
pytestmark = pytest.mark.slow

BAKES = """
import sys
import leaflight
import numpy as np
import thesis

scene = leaflight.load_scene(sys.argv[1])
grids = {}
for estimator in sys.argv[3:]:
    baked = thesis.bake(
        leaflight.bump_box(20), scene, samples=4, photons=20_000, isovalues=(30.0, 70.0),
        estimator=estimator, both_sides=True,
    )
    for name in ("radiance", "radiance_back"):
        grids[f"{estimator} {name}"] = baked.grid.dense(name)
np.savez(sys.argv[2], **grids)
"""


def bakes(root, preset, folder):
    """Returns bakes by a preset's module in a separate process; skips if it is not built."""
    package = root / "build" / preset / "python"
    if not list((package / "leaflight").glob("_core*.so")):
        pytest.skip(f"the preset {preset} is not built")
    path = folder / f"{preset}.npz"
    arguments = ("-c", BAKES, root / "scenes" / "bump_box.json", path, *ESTIMATORS)
    run_python(*arguments, paths=[package, root / "validation"], check=True)
    return np.load(path)


@pytest.fixture(scope="module")
def both(root, tmp_path_factory):
    folder = tmp_path_factory.mktemp("precision")
    return [bakes(root, preset, folder) for preset in ("release", "double")]


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_single_precision_is_enough(both, estimator):
    for side in ("radiance", "radiance_back"):
        single, double = (grids[f"{estimator} {side}"].astype(np.float64) for grids in both)
        error = np.abs(single - double)
        assert ((single > 0) == (double > 0)).all()
        assert (error <= (STEP + MOST) * double).all()
        assert np.mean(error[double > 0] > 0) <= FLIPPED


def test_the_builds_differ(both):
    single, double = both
    assert any((single[name] != double[name]).any() for name in double.files)
