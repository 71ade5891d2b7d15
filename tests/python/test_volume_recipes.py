# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the volumes of reports and benchmarks come from (validation/volume_recipes.py)."""

import numpy as np
from test_reader_vti import vti
from volume_recipes import read


def test_files_that_are_absent_are_left_out(tmp_path, values):
    """And present ones are placed at the origin, along the axes."""
    recipe = read("x.vti", placed=False)
    assert recipe(tmp_path, 1.0) is None and recipe(None, 1.0) is None
    more = 'Origin="10 20 30" Spacing="1 2 3"'
    (tmp_path / "x.vti").write_bytes(vti(values, "Float32", "appended", more=more))
    (volume,) = recipe(tmp_path, 1.0)
    assert np.diag(volume.index_to_world).tolist() == [1, 2, 3, 1]
    assert not volume.index_to_world[:3, 3].any()
