# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests units of length: bakes, files and worlds of several units, and scenes of any size."""

from dataclasses import replace

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight import Volume
from outcomes import refused
from test_export import gltf_of

# Longest side of a head in millimeters, as in its scan.
SIDE = 220.0


@pytest.fixture(scope="module")
def head_file(tmp_path_factory):
    """Writes a scan of 20^3 voxels whose longest side is 220 mm."""
    path = tmp_path_factory.mktemp("scan") / "head.nii.gz"
    values = leaflight.bump_box(20).values.T
    image = nibabel.Nifti1Image(values, np.diag([SIDE / 19] * 3 + [1.0]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)
    return path


@pytest.fixture(scope="module")
def head(head_file, bump_scene, tmp_path_factory):
    """Returns a bake of the scan, read from its file."""
    path = tmp_path_factory.mktemp("bake") / "head.vdb"
    volume = leaflight.read_volume(head_file)
    leaflight.bake(volume, bump_scene, error=8.0, isovalues=(30.0, 70.0)).save(path)
    return leaflight.load_bake(path)


def longest_side_in_meters(path):
    """Returns the longest side of the first mesh of a .glb, times the scale of its root."""
    file, _ = gltf_of(path)
    (root,) = file["scenes"][0]["nodes"]
    mesh = file["meshes"][0]["primitives"][0]
    positions = file["accessors"][mesh["attributes"]["POSITION"]]
    return np.max(np.subtract(positions["max"], positions["min"]) * file["nodes"][root]["scale"])


def test_a_bake_keeps_the_unit(head):
    assert head.unit == head.volume.unit == head.surface(47.0).unit == "mm"
    np.testing.assert_allclose(head.volume.spacing, SIDE / 19)


def test_info_says_it(cli, head_file):
    done = cli("info", head_file)
    assert "20 x 20 x 20 voxels of 11.5789 x 11.5789 x 11.5789 mm" in done.out
    assert "(no unit)" in cli("info", "bump_box", "--dims", 8).out


def expected_sides(surface):
    """Returns the sides in meters, along x, y, z."""
    sides = np.ptp(surface.vertices, axis=0) / 1000
    assert 0.1 < sides.max() <= 0.22
    return sides


def test_a_head_is_a_head_in_gltf(head, tmp_path):
    """Checks the lengths in trimesh, where y is up."""
    trimesh = pytest.importorskip("trimesh", reason="trimesh of PyPI is not installed")
    surface = leaflight.export(head, tmp_path / "head.glb", [47.0])[47.0]
    x, y, z = expected_sides(surface)
    measured = trimesh.load(tmp_path / "head.glb")
    np.testing.assert_allclose(measured.extents, (x, z, y), rtol=1e-5)


@pytest.mark.parametrize("suffix", ["usda", "usdc"])
def test_a_head_is_a_head_in_usd(head, tmp_path, suffix):
    """Checks the lengths in Pixar's own library."""
    pytest.importorskip("pxr", reason="usd-core of PyPI is not installed")
    from pxr import Usd, UsdGeom

    surface = leaflight.export(head, tmp_path / f"head.{suffix}", [47.0])[47.0]
    stage = Usd.Stage.Open(str(tmp_path / f"head.{suffix}"))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.EarliestTime(), [UsdGeom.Tokens.default_])
    box = cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange()
    measured = np.array(box.GetSize()) * UsdGeom.GetStageMetersPerUnit(stage)
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    np.testing.assert_allclose(measured, expected_sides(surface), rtol=1e-5)


@pytest.mark.parametrize("unit", ["", "Å"])
def test_a_molecule_can_be_seen_in_gltf(head, tmp_path, unit):
    """Checks a molecule, which views would clip at its true size, and a volume of unknown unit."""
    molecule = replace(head, volumes=[replace(head.volume, unit=unit)])
    surface = leaflight.export(molecule, tmp_path / "molecule.glb", [47.0])[47.0]
    expected = np.ptp(surface.vertices, axis=0).max()
    assert longest_side_in_meters(tmp_path / "molecule.glb") == pytest.approx(expected)


def test_volumes_of_two_units_share_a_world():
    box = leaflight.bump_box(8)
    millimeters = replace(box, unit="mm")
    micrometers = replace(millimeters.in_unit("µm"), name="the same")
    assert micrometers.spacing == pytest.approx([1000 / 7] * 3)
    bake = leaflight.bake([millimeters, micrometers, box], error=50.0)
    assert [volume.unit for volume in bake.volumes] == ["mm"] * 3
    for volume in bake.volumes:
        np.testing.assert_allclose(volume.index_to_world, box.index_to_world, rtol=1e-12)


def test_a_bake_of_no_unit_is_refused(head, tmp_path):
    path = tmp_path / "odd.vdb"
    replace(head, provenance=head.provenance.with_volumes(unit="parsec")).save(path)
    refused("lacks the metadata of a bake", leaflight.load_bake, path)


FIXED = {"samples": 4, "photons": 3000}
WORK = {
    "passes": {"error": 6.0, "both_sides": True, "walls": True},
    "fixed": FIXED,
    "thesis": {**FIXED, "estimator": "thesis"},
}


def lit(volume, unit, work, light=leaflight.bake):
    scaled = Volume(volume.values * np.float32(unit), volume.index_to_world, volume.name)
    bake = light(scaled, isovalues=(30.0 * unit, 90.0 * unit), **WORK[work])
    return bake, bake.surface(47.0 * unit)


@pytest.mark.slow
@pytest.mark.parametrize("work", WORK)
def test_powers_of_two_change_no_bit(request, work):
    light = (leaflight if work == "passes" else request.getfixturevalue("thesis")).bake
    box = leaflight.bump_box(14)
    bake, surface = lit(box, 1.0, work, light)
    assert surface.radiance.mean() > 0.1
    for exponent in (-110, 50, 115):
        other, same = lit(box, 2.0**exponent, work, light)
        assert np.array_equal(same.vertices, surface.vertices), exponent
        assert np.array_equal(same.radiance, surface.radiance), exponent
        for name in ("estimated_rms_percent", "passes", "texels", "rays"):
            found = [getattr(one.statistics, name) for one in (bake, other)]
            assert found[0] == found[1], (exponent, name)


def test_beyond_single_precision_is_refused():
    box = leaflight.bump_box(6)
    for unit in (1e-40, 1e36):
        refused("in units", lit, box, unit, "passes")
