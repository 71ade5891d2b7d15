# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests volumes from scattered points."""

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.volume.scattered_points import interpolated
from outcomes import refused, written


def bump(points):
    return np.exp(-4 * (np.asarray(points) ** 2).sum(axis=-1))


@pytest.fixture
def points():
    return np.random.default_rng(4).uniform(-1, 1, (8_000, 3)) * [1, 0.5, 2]


def world_nodes(volume):
    nz, ny, nx = volume.values.shape
    k, j, i = np.mgrid[:nz, :ny, :nx]
    return np.stack([i, j, k, np.ones_like(i)], axis=-1) @ volume.index_to_world[:3].T


def test_a_smooth_function_comes_back(points):
    volume = interpolated(points, bump(points), "bump")
    sizes = np.diag(volume.index_to_world)[:3]
    assert sizes.max() / sizes.min() < 1.1
    assert 0.5 * len(points) < volume.values.size < 2 * len(points)
    error = np.abs(volume.values - bump(world_nodes(volume)))
    # Half a voxel off a node, the steepest slope of 1.7 gives this error.
    assert error.max() < 1.7 * sizes.max() and error.mean() < 0.02


def test_a_lattice_of_points_comes_back_exactly(values):
    nz, ny, nx = values.shape
    k, j, i = np.mgrid[:nz, :ny, :nx]
    places = np.stack([i, j, k], axis=-1).reshape(-1, 3) * [2.0, 2.0, 2.0] + [5, 6, 7]
    order = np.random.default_rng(1).permutation(len(places))
    volume = interpolated(places[order], values.ravel()[order], "h", nodes=(nx, ny, nz))
    np.testing.assert_allclose(volume.values, values, atol=1e-6)
    np.testing.assert_allclose(volume.index_to_world @ [0, 0, 0, 1], [5, 6, 7, 1])
    np.testing.assert_allclose(np.diag(volume.index_to_world), [2, 2, 2, 1])


def grid(values, steps, first, digits=None):
    """Returns positions and values of a grid as a table, in any order."""
    nz, ny, nx = values.shape
    k, j, i = np.mgrid[:nz, :ny, :nx]
    places = np.stack([i, j, k], axis=-1).reshape(-1, 3) * np.array(steps, float) + first
    places = places if digits is None else places.round(digits)
    order = np.random.default_rng(1).permutation(len(places))
    return places[order], values.ravel()[order].astype(np.float64)


@pytest.mark.parametrize(
    "steps, first, digits",
    [
        ((0.5, 0.5, 2), (0, 0, 0), None),
        ((1 / 3, 2, 0.01), (-7, 1e4, 0.1), None),
        ((1 / 3, 0.7, 12.5), (100, 5, -3), 2),
    ],
)
def test_a_grid_with_other_distances_along_each_axis(tmp_path, values, steps, first, digits):
    places, h = grid(values, steps, first, digits)
    path = tmp_path / "x.csv"
    np.savetxt(path, np.c_[places, h], delimiter=",", header="x,y,z,value", comments="")
    volume = read_volume(path)
    np.testing.assert_array_equal(volume.values, values)
    slack = 0.5 * 10.0 ** -(digits or 9)
    np.testing.assert_allclose(volume.index_to_world[:3, 3], first, rtol=0, atol=2 * slack)
    np.testing.assert_allclose(volume.spacing, steps, rtol=0, atol=slack)
    path = tmp_path / "x.ply"
    ply(path, places, "ascii", density=h)
    np.testing.assert_array_equal(read_volume(path).values, values)


def test_a_grid_in_single_precision_far_from_the_origin(values):
    """Checks coordinates with seven digits before the decimal point, as in surveys."""
    places, h = grid(values, (1, 2.3, 0.7), (4_000_000.1, 500_000, 10))
    volume = interpolated(places.astype(np.float32), h, "h")
    np.testing.assert_array_equal(volume.values, values)
    np.testing.assert_allclose(volume.spacing, (1, 2.3, 0.7), rtol=0.1)


def test_a_grid_keeps_its_missing_values_and_its_precision():
    values = np.arange(1e9, 1e9 + 60).reshape(3, 4, 5)
    values[1, 1, 1] = np.nan
    places, h = grid(values, (1, 2, 3), (0, 0, 0))
    np.testing.assert_array_equal(interpolated(places, h, "h").values, values)


def test_no_whole_grid_is_interpolated(values):
    """Checks incomplete grids, and grids with another requested number of nodes."""
    places, h = grid(values, (1, 2, 3), (0, 0, 0))
    for points, of_points in (
        (places[1:], h[1:]),
        (np.r_[places[1:], places[1:2]], np.r_[h[1:], h[1:2]]),
        (places + np.random.default_rng(2).uniform(-0.1, 0.1, places.shape), h),
        # Points are denser towards one end.
        (places**1.2, h),
    ):
        assert interpolated(points, of_points, "h").values.dtype == np.float32
        assert interpolated(points, of_points, "h").values.shape != values.shape
    assert interpolated(places, h, "h", nodes=(9,)).values.shape == (9, 8, 5)
    assert interpolated(places, h, "h", nodes=(6,)).values.shape == (4, 5, 6)


def test_gaps_are_filled(points):
    kept = points[np.linalg.norm(points - [0, 0, 1], axis=1) > 0.4]
    volume = interpolated(kept, kept[:, 2], "z", nodes=(40,))
    assert max(volume.values.shape) == 40
    assert not volume.field().masked
    inside = np.linalg.norm(world_nodes(volume) - [0, 0, 1], axis=-1) < 0.2
    assert inside.any() and np.abs(volume.values[inside] - 1).max() < 0.4


@pytest.mark.parametrize("comma", [",", ";", "\t", "  "])
@pytest.mark.parametrize("names", ["", "id,value,z,y,x", "# x y z pressure"])
def test_csv(tmp_path, points, comma, names):
    h = bump(points)
    columns = [*points.T, h]
    if "id" in names:
        columns = [np.arange(len(h)), h, *points.T[::-1]]
        names = names.replace(",", comma)
    table = np.stack(columns, axis=-1)
    path = tmp_path / "x.csv"
    np.savetxt(path, table, delimiter=comma, header=names, comments="" if names else "# ")
    volume = read_volume(path)
    expected = interpolated(points, h, "x")
    np.testing.assert_allclose(volume.values, expected.values, atol=1e-6)
    np.testing.assert_allclose(volume.index_to_world, expected.index_to_world, atol=1e-9)
    assert read_volume(path, dims=(20,)).values.shape[0] == 20


def test_csv_of_a_catalogue(tmp_path, points):
    """Checks quoted names, texts with commas, line numbers, empty other fields, comments."""
    path = tmp_path / "x.csv"
    lines = ['"","z","name","x","y","mag","note"']
    for i, (x, y, z) in enumerate(points):
        lines.append(f'"{i}",{z:.17g},"a, b",{x:.17g}, {y:.17g},{x + y:.17g},')
    lines.insert(5, "# measured again")
    path.write_text("\n" + "\n".join(lines) + "\n\n")
    expected = interpolated(points, points[:, 0] + points[:, 1], "x")
    np.testing.assert_allclose(read_volume(path).values, expected.values, atol=1e-6)


def ply(path, points, form, **columns):
    kinds = [("x", "double"), ("y", "double"), ("z", "double")]
    kinds += [(name, "float") for name in columns]
    mark = "<" if "little" in form else ">"
    dtype = [(name, mark + {"double": "f8", "float": "f4"}[kind]) for name, kind in kinds]
    table = np.zeros(len(points), dtype)
    for axis, name in enumerate("xyz"):
        table[name] = points[:, axis]
    for name, column in columns.items():
        table[name] = column
    header = f"ply\nformat {form} 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property {kind} {name}\n" for name, kind in kinds)
    header += "element face 0\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(header.encode())
    with open(path, "ab") as file:
        if form == "ascii":
            np.savetxt(file, np.stack([table[name] for name, _ in kinds], axis=-1))
        else:
            file.write(table.tobytes())


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply(tmp_path, points, form):
    path = tmp_path / "x.ply"
    h = bump(points).astype(np.float32)
    ply(path, points, form, red=h, density=h)
    expected = interpolated(points, h, "x").values
    np.testing.assert_allclose(read_volume(path).values, expected, atol=1e-6)
    # Write the header with Windows' line ends.
    path.write_bytes(path.read_bytes().replace(b"end_header\n", b"end_header\r\n"))
    np.testing.assert_allclose(read_volume(path).values, expected, atol=1e-6)
    ply(path, points, form, density=h, heat=-h)
    np.testing.assert_allclose(read_volume(path, dataset="heat").values, -expected, atol=1e-6)
    refused("density, heat", read_volume, path)


def test_damaged(tmp_path, points):
    path = tmp_path / "x.csv"
    for text, sentence in (
        ("1,2,3,4\n5,6,7\n", "'5, 6, 7'"),
        # An empty field must not shift the following ones.
        ("x,y,z,value,w\n1,2,3,4,5\n1,,3,4,5\n", "lacks numbers or fields"),
        ("x,y,z,value,w\n1,2,3,4,5\n1,2,3,4\n", "fields"),
        ("1;2;3;4\n1,5;2;3;4\n", "lacks numbers or fields"),
        ("a,b,c,d\n1,2,3,4\n", "does not name the columns"),
        ("0,0,0,1\n1,1,0,2\n2,0,0,3\n3,2,0,3\n", "box"),
        ("", "do not fill"),
    ):
        refused(f"x.csv: .*({sentence})", read_volume, written(path, text))
    path = tmp_path / "x.ply"
    ply(path, points, "binary_little_endian")
    refused("x, y, z", read_volume, path)
    ply(path, points, "binary_little_endian", value=bump(points))
    refused("claims", read_volume, written(path, path.read_bytes()[:-1]))
