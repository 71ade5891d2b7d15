# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests potentials and densities of molecules and crystals in OpenDX, VASP and XSF."""

import gzip

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

# Edges of a cell without right angles, as rows.
LATTICE = np.array([[3.0, 0, 0], [1, 4, 0], [0, 0.5, 5]])


def opendx(values, more="data follows", kind="double"):
    """Returns a map without right angles in a handwritten file; its array is [x, y, z]."""
    dims = " ".join(map(str, values.shape[::-1]))
    lines = ["# of some program, class array", f"object 1 class gridpositions counts {dims}"]
    lines += ["origin 1 2 3.0D+00", *(f"delta {' '.join(map(str, axis))}" for axis in LATTICE)]
    lines += [f"object 2 class gridconnections counts {dims}"]
    lines += [f"object 3 class array type {kind} rank 0 items {values.size} {more}"]
    numbers = list(map(str, values.transpose(2, 1, 0).ravel().tolist()))
    rows = (" ".join(numbers[at : at + 3]) for at in range(0, len(numbers), 3))
    return "\n".join([*lines, *rows])


def test_a_map_of_apbs(tmp_path, values):
    content = opendx(values) + '\nattribute "dep" string "positions"\n'
    for name, data in (("x.dx", content.encode()), ("x.dx.gz", gzip.compress(content.encode()))):
        volume = reads(values, written(tmp_path / name, data))
        np.testing.assert_array_equal(volume.index_to_world[:3, :3], LATTICE.T)
        np.testing.assert_array_equal(volume.index_to_world[:3, 3], [1, 2, 3])
        assert (volume.unit, volume.name) == ("Å", "x") and "angstrom" in volume.notes[0]


@pytest.mark.parametrize("suffix", ["dx", "dx.gz"])
def test_a_map_of_griddataformats(tmp_path, values, suffix):
    grids = pytest.importorskip("gridData")
    path = tmp_path / f"x.{suffix}"
    edges = [np.arange(7) * 0.5, np.arange(6) * 1.0, np.arange(5) * 2.0]
    grids.Grid(values.transpose(2, 1, 0), edges=edges).export(str(path), type="double")
    theirs, volume = grids.Grid(str(path)), read_volume(path)
    np.testing.assert_array_equal(volume.values.transpose(2, 1, 0), theirs.grid)
    np.testing.assert_allclose(np.diag(volume.index_to_world)[:3], theirs.delta)
    np.testing.assert_allclose(volume.index_to_world[:3, 3], theirs.origin)


def test_other_arrays_of_opendx(tmp_path, values):
    path = tmp_path / "x.dx"
    reads(values, written(path, opendx(values, "follows", '"float"')))
    numbers = values.transpose(2, 1, 0).astype(">f4").tobytes()
    binary = opendx(values, "msb ieee data follows", "float").partition("follows")[0] + "follows\n"
    reads(values, written(path, binary.encode() + numbers))
    (tmp_path / "x.bin").write_bytes(b"abc" + numbers)
    reads(values, written(path, opendx(values, 'msb ieee data file "x.bin",3', "float")))
    # Values of connections are at their centers.
    volume = reads(values, written(path, opendx(values).replace("counts 6 5 4", "counts 7 6 5")))
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [1 + 2, 2 + 2.25, 3 + 2.5])
    vectors = opendx(values).replace("rank 0", "rank 1 shape 2 ")
    numbers = np.stack([values, -values], -1).transpose(2, 1, 0, 3).ravel().tolist()
    head = vectors.partition("follows\n")[0] + "follows\n"
    reads(-values, written(path, head + "\n".join(map(str, numbers))), channel=1)


def test_damaged_maps(tmp_path, values):
    path = tmp_path / "x.dx"
    whole = opendx(values)
    for broken, sentence in (
        (whole[:-20], "ends before"),
        (whole.replace("6 5 4", "600 500 4"), "claims 120 values"),
        (whole.replace("6 5 4", "6 5"), "readable OpenDX map"),
        (whole.replace("counts 6 5 4", "counts 600 500 400").replace("120", "120000000"), "ends"),
        (whole.replace("double", "string"), "readable OpenDX map"),
        (whole.replace("delta 3.0 0.0 0.0", "delta 0 0 0"), "not invertible"),
        (whole.replace("data follows", 'data file "../x",0'), "outside .* folder"),
        (whole.partition("object 2")[0], "readable OpenDX map"),
        ("", "readable OpenDX map"),
    ):
        refused(f"x.dx: .*{sentence}", read_volume, written(path, broken))


def vasp(*grids, title="some crystal", scale="1.0", selective=False, augmented=True):
    """Returns a file of VASP: each grid is [z, y, x]; between them are values of spheres."""
    lines = [title, scale, *(" ".join(map(str, axis)) for axis in LATTICE), "C O", "1 2"]
    lines += ["Selective dynamics"] * selective + ["Direct", *["0.1 0.2 0.3"] * 3, ""]
    for grid in grids:
        numbers = [f"{number:.11E}" for number in grid.ravel()]
        lines += ["   ".join(["", *map(str, grid.shape[::-1])])]
        lines += [" ".join(numbers[at : at + 5]) for at in range(0, len(numbers), 5)]
        lines += ["augmentation occupancies   1   3", "0.1E-01 0.2 0.3"] * augmented
        lines += ["0.5 0.5 0.5"]
    return "\n".join(lines) + "\n"


VOLUME = np.linalg.det(LATTICE)


@pytest.mark.parametrize(
    "name", ["CHGCAR", "CHG", "AECCAR2", "PARCHG.0012.0001", "CHGCAR_sum", "x.vasp", "CHGCAR.gz"]
)
def test_densities_of_vasp(tmp_path, values, name):
    text = vasp(values * VOLUME, -values * VOLUME).encode()
    path = written(tmp_path / name, gzip.compress(text) if name.endswith("gz") else text)
    stored = probe(path)
    assert (stored.dims, stored.channels, stored.unit) == ((6, 5, 4), 2, "Å")
    assert "1 is spin up less spin down" in stored.notes[0]
    for channel, expected in enumerate((values, -values)):
        volume = read_volume(path, channel=channel)
        np.testing.assert_allclose(volume.values, expected, rtol=1e-6)
    # The cell is periodic: the last point is one step before its end.
    np.testing.assert_allclose(volume.index_to_world[:3, :3] * [6, 5, 4], LATTICE.T)
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], 0)


def test_other_files_of_vasp(tmp_path, values):
    potential = vasp(values, selective=True, augmented=False)
    for name in ("LOCPOT", "ELFCAR", "LOCPOT.vasp"):
        volume = read_volume(written(tmp_path / name, potential))
        np.testing.assert_allclose(volume.values, values)
    # If the name does not tell, the values are read as a density, with a note.
    volume = read_volume(written(tmp_path / "x.vasp", potential))
    np.testing.assert_allclose(volume.values, values / VOLUME, rtol=1e-6)
    assert "divided by the volume" in volume.notes[0]
    volume = read_volume(written(tmp_path / "CHGCAR", vasp(values, scale="2.0")))
    np.testing.assert_allclose(volume.values, values / (8 * VOLUME), rtol=1e-6)
    for scale in ("-480", "2 2 2"):
        again = read_volume(written(tmp_path / "CHGCAR", vasp(values, scale=scale)))
        np.testing.assert_allclose(again.index_to_world, volume.index_to_world)
    run = vasp(values, augmented=False) + vasp(2 * values, augmented=False, scale="2.0")
    path = written(tmp_path / "CHG", run)
    for frame, size in ((0, VOLUME), (1, 4 * VOLUME)):
        volume = read_volume(path, frame=frame)
        np.testing.assert_allclose(volume.values, values / size, rtol=1e-6)
    assert (probe(path).frames, probe(path).channels) == (2, 1)


def test_damaged_files_of_vasp(tmp_path, values):
    path = tmp_path / "CHGCAR"
    whole = vasp(values)
    head = whole.partition("   6   5   4")[0]
    for broken, sentence in (
        (whole[:1500], "ends before"),
        (whole.replace("   6   5   4", "  600  500  400"), "ends before"),
        (whole.replace("3.0 0.0 0.0", "0 0 0"), "not invertible"),
        (whole.replace("   6   5   4", "   6   0   4"), "readable VASP file"),
        (head, "no values"),
        ("", "readable VASP file"),
    ):
        refused(f"CHGCAR: .*({sentence})", read_volume, written(path, broken))


def test_a_density_of_ase(tmp_path, values):
    pytest.importorskip("ase")
    from ase import Atoms
    from ase.calculators.vasp import VaspChargeDensity

    path = tmp_path / "CHGCAR"
    density = VaspChargeDensity(None)
    density.atoms.append(Atoms("CO", [[0, 0, 0], [0, 0, 1.1]], cell=LATTICE, pbc=True))
    density.chg.append(values.transpose(2, 1, 0))
    density.write(str(path))
    volume, theirs = read_volume(path), VaspChargeDensity(str(path))
    np.testing.assert_allclose(volume.values.transpose(2, 1, 0), theirs.chg[0], rtol=1e-6)
    np.testing.assert_allclose(volume.values, values, rtol=1e-6)
    np.testing.assert_allclose(volume.index_to_world[:3, :3] * [6, 5, 4], LATTICE.T)


def xsf(*named):
    lines = ["CRYSTAL", "PRIMVEC", *(" ".join(map(str, axis)) for axis in LATTICE), ""]
    lines += ["BEGIN_BLOCK_DATAGRID_3D", "of some program"]
    for name, grid in named:
        lines += [f"  BEGIN_DATAGRID_3D_{name}", " ".join(map(str, grid.shape[::-1])), "1 2 3"]
        lines += [" ".join(map(str, axis)) for axis in LATTICE]
        lines += ["\n".join(map(str, grid.ravel())), "  END_DATAGRID_3D"]
    return "\n".join([*lines, "END_BLOCK_DATAGRID_3D"])


def test_grids_of_xcrysden(tmp_path, values):
    path = tmp_path / "x.xsf"
    volume = reads(values, written(path, xsf(("rho", values))))
    # The last point is at the end of the vectors.
    np.testing.assert_allclose(volume.index_to_world[:3, :3] * [5, 4, 3], LATTICE.T)
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [1, 2, 3])
    assert volume.unit == "Å"
    reads(-values, written(path, xsf(("up", values), ("down", -values))), dataset="down")
    assert probe(path).datasets == ("up", "down")
    whole = xsf(("rho", values))
    for broken, sentence in (
        (whole[:500], "ends before"),
        (whole.replace("6 5 4", "600 500 400"), "ends before"),
        (whole.replace("6 5 4", "6 5 4 7"), "readable XSF"),
        (whole.replace("6 5 4", "6 5 -4"), "readable XSF"),
        (whole.replace("_3D", "_2D"), "three-dimensional"),
        ("", "three-dimensional"),
    ):
        refused(f"x.xsf: .*{sentence}", read_volume, written(path, broken))


def test_a_grid_of_ase(tmp_path, values):
    pytest.importorskip("ase")
    from ase import Atoms
    from ase.io.xsf import read_xsf, write_xsf

    path = tmp_path / "x.xsf"
    atoms = Atoms("CO", [[0, 0, 0], [0, 0, 1.1]], cell=LATTICE, pbc=True)
    with open(path, "w") as file:
        write_xsf(file, [atoms], data=values.transpose(2, 1, 0))
    with open(path) as file:
        theirs = read_xsf(file, read_data=True)[0]
    np.testing.assert_allclose(read_volume(path).values.transpose(2, 1, 0), theirs)
