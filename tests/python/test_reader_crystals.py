# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests maps of crystallography: DSN6, BRIX, and structure factors, which gemmi makes a map."""

import gzip

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import refused, written

# Edges and angles of a cell.
CELL = (12.0, 15.0, 9.0, 80.0, 95.0, 110.0)


def bricks(values):
    """Returns the bytes of a map, in cubes of 8 x 8 x 8 that are padded with zeros."""
    whole = np.pad(values, [(0, -n % 8) for n in values.shape]).astype(np.uint8)
    parts = []
    for z in range(0, whole.shape[0], 8):
        for y in range(0, whole.shape[1], 8):
            for x in range(0, whole.shape[2], 8):
                parts.append(whole[z : z + 8, y : y + 8, x : x + 8].tobytes())
    return b"".join(parts)


def dsn6(values, order=">", **words):
    numbers = np.zeros(256, order + "i2")
    numbers[:9] = -3, 2, 5, *values.shape[::-1], 24, 30, 18
    numbers[9:15] = [round(80 * number) for number in CELL]
    numbers[15:19] = 4400, 34, 80, 100
    for place, number in words.get("at", {}).items():
        numbers[place] = number
    data = bricks(values)
    return numbers.tobytes() + (np.frombuffer(data, "<i2").astype(order + "i2").tobytes())


def brix(values, plus="34", factor=44):
    nz, ny, nx = values.shape
    cell = "".join(f"{number:10.3f}" for number in CELL)
    head = f":-) Origin   -3    2    5 Extent{nx:5}{ny:5}{nz:5} Grid   24   30   18 Cell {cell} "
    head += f"Prod{factor:12.5f} Plus{plus:>8} Sigma      0.30094"
    return head.encode().ljust(512) + bricks(values)


@pytest.fixture
def densities():
    return np.random.default_rng(5).integers(0, 256, (9, 17, 21))


@pytest.mark.parametrize("kind", ["big", "little", "brix", "packed"])
def test_maps_of_bytes(tmp_path, densities, kind):
    path = tmp_path / {"brix": "x.brix", "packed": "x.omap.gz"}.get(kind, "x.dsn6")
    data = {"big": dsn6(densities), "little": dsn6(densities, "<"), "brix": brix(densities)}
    volume = read_volume(written(path, data.get(kind) or gzip.compress(data["big"])))
    np.testing.assert_allclose(volume.values, (densities - 34) / 44, rtol=1e-6, atol=1e-7)
    assert (probe(path).dims, volume.unit, volume.name) == ((21, 17, 9), "Å", "x")
    # Compare with gemmi's positions of a grid's points in this cell.
    gemmi = pytest.importorskip("gemmi")
    cell = gemmi.UnitCell(*CELL)
    for index in ((0, 0, 0), (5, 3, 1)):
        parts = np.add(index, (-3, 2, 5)) / (24, 30, 18)
        theirs = cell.orthogonalize(gemmi.Fractional(*parts)).tolist()
        np.testing.assert_allclose((volume.index_to_world @ [*index, 1])[:3], theirs, atol=1e-6)


def test_damaged_maps_of_bytes(tmp_path, densities):
    whole, path = dsn6(densities), tmp_path / "x.dsn6"
    for broken, sentence in (
        (whole[:-100], "claims"),
        (whole[:30], "readable DSN6"),
        (dsn6(densities, at={18: 0}), "readable DSN6"),
        (dsn6(densities, at={3: -1}), "shape -1 x"),
        (dsn6(densities, at={15: 0}), "damaged"),
        (dsn6(densities, at={17: 0}), "readable DSN6|not invertible"),
        (dsn6(densities, at={9: 0}), "not invertible"),
        (brix(densities, "none"), "readable DSN6"),
        (b":-)", "readable DSN6"),
        (b"", "readable DSN6"),
    ):
        refused(f"x.dsn6: .*({sentence})", read_volume, written(path, broken))


def mtz(path, columns, cell=CELL):
    """Returns structure factors by gemmi; columns: (label, type, numbers of the three waves)."""
    gemmi = pytest.importorskip("gemmi")
    file = gemmi.Mtz(with_base=True)
    file.spacegroup = gemmi.SpaceGroup("P 1")
    file.add_dataset("d")
    file.set_cell_for_all(gemmi.UnitCell(*cell))
    for label, kind, _ in columns:
        file.add_column(label, kind)
    waves = [[1, 0, 0], [0, 2, 1], [3, 4, -2]]
    file.set_data(np.column_stack([waves, *(numbers for *_, numbers in columns)]).astype("f4"))
    file.write_to_file(str(path))
    return waves


def test_a_map_of_structure_factors(tmp_path):
    """Compares the map with the sum of its waves."""
    path = tmp_path / "x.mtz"
    amplitudes, phases = [30.0, 20.0, 10.0], [10.0, 100.0, -50.0]
    columns = [("FWT", "F", amplitudes), ("PHWT", "P", phases), ("FOM", "W", [1, 1, 1])]
    waves = mtz(path, columns)
    stored, volume = probe(path), read_volume(path)
    assert stored.datasets == ("FWT/PHWT",) and stored.unit == "Å" and not stored.notes
    dims = np.array(stored.dims)
    points = np.stack(np.meshgrid(*map(np.arange, dims), indexing="ij"), axis=-1) / dims
    expected = np.zeros(dims)
    for wave, amplitude, phase in zip(waves, amplitudes, phases):
        expected += amplitude * np.cos(2 * np.pi * points @ wave - np.radians(phase))
    axes = volume.index_to_world[:3, :3] * dims
    expected *= 2 / np.linalg.det(axes)
    np.testing.assert_allclose(volume.values.transpose(2, 1, 0), expected, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=0), CELL[:3], rtol=1e-6)
    a, b, c = axes.T / np.array(CELL[:3])[:, None]
    np.testing.assert_allclose(np.degrees(np.arccos([b @ c, a @ c, a @ b])), CELL[3:], rtol=1e-5)


def test_several_maps_in_a_file(tmp_path):
    path = tmp_path / "x.mtz"
    one, two = [1.0, 2, 3], [10.0, 20, 30]
    observed = [("FP", "F", one), ("SIGFP", "Q", one)]
    columns = [*observed, ("FC", "F", two), ("PHIC", "P", two), ("FOFCWT", "F", one)]
    columns += [("PHFOFCWT", "P", two), ("2FOFCWT", "F", two), ("PH2FOFCWT", "P", one)]
    mtz(path, columns)
    stored = probe(path)
    assert stored.datasets == ("FC/PHIC", "FOFCWT/PHFOFCWT", "2FOFCWT/PH2FOFCWT")
    assert stored.notes[0].startswith("The map of 2FOFCWT/PH2FOFCWT is computed; other datasets")
    other = read_volume(path, dataset="FC")
    assert not other.notes and other.values.max() > 0
    refused("'FP'", probe, path, dataset="FP")
    mtz(path, columns[:6])
    assert probe(path).dims is None
    mtz(path, observed)
    refused("x.mtz: .*no phases", probe, path)
    path.write_bytes(path.read_bytes()[:200])
    refused("x.mtz: .*(readable MTZ|holds no phases)", probe, path)
