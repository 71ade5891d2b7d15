# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests Gaussian's cubes, and the ways in which programs write numbers as text."""

import gzip
import io

import numpy as np
import pytest
from leaflight import _core, read_volume
from leaflight.io.readers import probe
from leaflight.io.readers.text_numbers import numbers_of, read_numbers
from outcomes import reads, refused, written


def cube(values, orbitals=1, sign=1):
    nz, ny, nx = values.shape
    atoms = -1 if orbitals > 1 else 1
    lines = ["a", "b", f"{atoms} -1 2 3", f"{sign * nx} 0.5 0 0", f"{sign * ny} 0 1 0"]
    lines += [f"{sign * nz} 0 0 2", "7 7 0 0 0"]
    if orbitals > 1:
        # The numbers of orbitals are split over two lines.
        lines += ["2 11", "12"]
    grids = np.stack([values, -values][:orbitals], axis=-1).transpose(2, 1, 0, 3)
    lines += [" ".join(map(str, line)) for line in grids.reshape(-1, nz * orbitals)]
    return "\n".join(lines)


@pytest.mark.parametrize("name", ["x.cube", "x.cube.gz"])
@pytest.mark.parametrize("orbitals", [1, 2])
def test_orbitals(tmp_path, values, name, orbitals):
    path = tmp_path / name
    text = cube(values, orbitals).encode()
    stored = probe(written(path, gzip.compress(text) if name.endswith("gz") else text))
    assert (stored.dims, stored.channels, stored.unit) == ((6, 5, 4), orbitals, "bohr")
    volume = reads(-values if orbitals > 1 else values, path, channel=orbitals - 1)
    assert np.diag(volume.index_to_world).tolist() == [0.5, 1, 2, 1] and volume.name == "x"
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], [-1, 2, 3])


def test_a_cube_in_angstrom_with_exponents_of_fortran(tmp_path, values):
    path = written(tmp_path / "x.cube", cube(values, sign=-1).replace(" 7.0", " 0.7D+01"))
    assert probe(path).unit == "Å"
    reads(values, path)


def test_damaged_cubes(tmp_path, values):
    path = tmp_path / "x.cube"
    for broken, sentence in (
        (cube(values)[:-30], "ends before"),
        (cube(values).replace("6 0.5", "60000 0.5"), "ends before"),
        ("a\nb\nc\n", "readable"),
        (cube(values).replace("0.5 0 0", "0 0 0"), "not invertible"),
    ):
        refused(f"x.cube: .*{sentence}", read_volume, written(path, broken))
    refused("2 channels.* 0..1", read_volume, written(path, cube(values, 2)))


NUMBERS = {
    "without a letter": ("0.123-100 -0.5+101 .25-099", [0.123e-100, -0.5e101, 0.25e-99]),
    "letters of Fortran": ("0.1D+01 -2.5d-3 1D2", [1, -0.0025, 100]),
    "signs that touch": ("-0.12345E-01-0.23456E-02 1.5-2.5", [-0.012345, -0.0023456, 1.5, -2.5]),
    "touching without a letter": ("-0.12345-100-0.5-101", [-0.12345e-100, -0.5e-101]),
    "full columns": ("1.234567E-1002.345678E-100", [1.234567e-100, 2.345678e-100]),
    "columns, some full": ("  1.00000E+001.234567E-100          7.5", [1, 1.234567e-100, 7.5]),
    "not finite": ("nan -inf Infinity 1", [np.nan, -np.inf, np.inf, 1]),
}


def numbers_in(text, count, dtype=np.float64, width=13):
    return read_numbers(io.BytesIO(text.encode()), count, dtype, _core.Progress(), width)


@pytest.mark.parametrize("kind", NUMBERS)
def test_numbers(kind):
    text, numbers = NUMBERS[kind]
    np.testing.assert_array_equal(numbers_in(text, len(numbers)), numbers)
    # Put the values among other lines, in more text than one read returns.
    plain = "1.5 2.5 3.5\r\n" * 45_000
    found = numbers_in(f"{plain}{text}\n{plain}augmentation", 270_000 + len(numbers))
    np.testing.assert_array_equal(found[135_000 : 135_000 + len(numbers)], numbers)
    np.testing.assert_array_equal(found[-3:], [1.5, 2.5, 3.5])


@pytest.mark.parametrize("space", [" ", "\n", "\t", "\r\n", "  \n\n "])
def test_numbers_in_one_line_or_a_line_for_each(space):
    numbers = np.random.default_rng(3).random(200_000).round(9)
    np.testing.assert_array_equal(numbers_in(space.join(map(str, numbers)), 200_000), numbers)


@pytest.mark.parametrize(
    "text, dtype, error",
    [
        ("1 2", np.float64, EOFError),
        ("1 2 ********", np.float64, ValueError),
        ("1 2 0.5E-010.5E-01", np.float64, ValueError),
        ("1 2 300", np.uint8, ValueError),
        ("1 2 nan", np.int16, ValueError),
        pytest.param("1 2 " + "9" * 200_000, np.int16, EOFError, id="endless"),
        ("1 2 x", np.float64, ValueError),
    ],
)
def test_what_is_no_number(text, dtype, error):
    with pytest.raises(error):
        numbers_in(text, 3, dtype)


def test_numbers_of_a_line():
    assert numbers_of(" -12-1234.567890   1.0D+00") == [-12, -1234.56789, 1]


@pytest.mark.parametrize("write", ["{:13.5E}", "{:12.5E}", " {:.5E}"])
def test_a_cube_whose_columns_touch(tmp_path, values, write):
    """Checks small numbers with exponents of three digits, which leave no space between columns."""
    small = -values * np.float32(1e-3)
    text = cube(values).splitlines()[:7]
    numbers = [write.format(float(number)) for number in small.transpose(2, 1, 0).ravel()]
    numbers[7] = "-1.20000E-100"
    text += ["".join(numbers[at : at + 6]) for at in range(0, len(numbers), 6)]
    path = written(tmp_path / "x.cube", "\n".join(text))
    read = read_volume(path).values.transpose(2, 1, 0).ravel()
    expected = small.transpose(2, 1, 0).ravel()
    expected[7] = 0
    np.testing.assert_allclose(read, expected, rtol=1e-5)


def test_several_values_of_a_voxel_without_a_list(tmp_path, values):
    """Checks the fifth number of the third line (NVAL)."""
    text = cube(values, 2).replace("-1 -1 2 3", "1 -1 2 3 2").replace("\n2 11\n12\n", "\n")
    path = written(tmp_path / "x.cube", text)
    assert probe(path).channels == 2
    reads(-values, path, channel=1)


def test_a_cube_of_ase(tmp_path, values):
    pytest.importorskip("ase")
    from ase import Atoms
    from ase.io.cube import read_cube_data, write_cube

    path = tmp_path / "x.cube"
    atoms = Atoms("CO", [[0, 0, 0], [0, 0, 1.1]], cell=[[3, 0, 0], [1, 4, 0], [0, 0.5, 5]])
    with open(path, "w") as file:
        write_cube(file, atoms, values.transpose(2, 1, 0), origin=(0.5, 1, 2))
    volume = read_volume(path)
    theirs, read_atoms = read_cube_data(str(path))
    np.testing.assert_allclose(volume.values.transpose(2, 1, 0), theirs)
    in_angstrom = volume.in_unit("Å").index_to_world
    np.testing.assert_allclose(in_angstrom[:3, :3] * [6, 5, 4], read_atoms.cell.T, rtol=1e-4)
    np.testing.assert_allclose(in_angstrom[:3, 3], [0.5, 1, 2], rtol=1e-4)
