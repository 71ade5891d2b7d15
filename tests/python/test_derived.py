# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests volumes that are computed from another one: gradient and height."""

from dataclasses import replace

import numpy as np
import pytest
from leaflight import Volume, gradient_of, height_of, texture_of

# Gradient of the field in world coordinates.
SLOPE = np.array([3.0, -4.0, 12.0])


def turned():
    """Returns the matrix of an anisotropic grid that is turned about a diagonal and moved."""
    axis, angle = np.ones(3) / np.sqrt(3.0), 0.7
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    rotation = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, :3] = rotation @ np.diag([0.3, 1.1, 0.6])
    matrix[:3, 3] = 5.0, -2.0, 1.0
    return matrix


def world_nodes(shape, matrix):
    k, j, i = np.indices(shape)
    return np.stack([i, j, k], axis=-1) @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.fixture
def linear():
    matrix = turned()
    values = world_nodes((5, 6, 7), matrix) @ SLOPE
    return Volume(values.astype(np.float32), matrix, "linear", unit="mm")


def test_the_gradient_of_a_linear_field_is_exact(linear):
    found = gradient_of(linear)
    np.testing.assert_allclose(found.values, 13.0, rtol=1e-4)
    assert found.values.shape == linear.values.shape and found.name == "gradient of linear per mm"
    np.testing.assert_array_equal(found.index_to_world, linear.index_to_world)


def test_differences_are_one_sided_next_to_missing_values(linear):
    values = linear.values.copy()
    values[2, 3, 3] = np.nan
    found = gradient_of(replace(linear, values=values)).values
    assert np.isnan(found[2, 3, 3]) and np.isnan(found).sum() == 1
    np.testing.assert_allclose(found[np.isfinite(found)], 13.0, rtol=1e-4)
    values[2, 3, 5] = np.nan
    # The node between both has no neighbor along x.
    assert np.isnan(gradient_of(replace(linear, values=values)).values[2, 3, 4])


def test_integers_have_the_gradient_of_their_values():
    ramp = np.broadcast_to(np.arange(200, 0, -50, dtype=np.uint8), (3, 4, 4))
    found = gradient_of(Volume(np.ascontiguousarray(ramp), spacing=2.0))
    np.testing.assert_allclose(found.values, 25.0)


def test_the_height_is_exact(linear):
    found = height_of(linear)
    assert found.values.shape == (2, 2, 2) and found.name == "height in mm"
    points = np.random.default_rng(1).uniform([0, 0, 0], [6, 5, 4], (50, 3))
    world = points @ linear.index_to_world[:3, :3].T + linear.index_to_world[:3, 3]
    ramp = [(-100.0, (0.0, 0.0, 0.0)), (100.0, (1.0, 1.0, 1.0))]
    heights = 200.0 * texture_of(found, ramp).at(world)[:, 0] - 100.0
    np.testing.assert_allclose(heights, world[:, 2], atol=1e-4)
    sideways = texture_of(height_of(linear, (0.0, 1.0, 0.0)), ramp).at(world)
    np.testing.assert_allclose(200.0 * sideways[:, 0] - 100.0, world[:, 1], atol=1e-4)


def test_the_layer_of_a_capped_volume_is_left_out(linear):
    for made in (gradient_of, height_of):
        plain, capped = made(linear), made(linear.capped())
        np.testing.assert_array_equal(capped.values, plain.values)
        np.testing.assert_allclose(capped.index_to_world, plain.index_to_world, atol=1e-12)
