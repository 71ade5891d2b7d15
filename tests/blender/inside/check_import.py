# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks File > Import > Volume for Leaflight."""

import bpy
import leaflight
import nibabel
import numpy as np
import pytest
from leaflight_addon.importing import stored_facts
from leaflight_addon.show import surface_object
from leaflight_addon.store import source_files
from leaflight_addon.show import distribution
from tools import assert_shows, close, error_of, mesh_arrays

N = 24


def check_the_isosurface_is_the_cores(bumps):
    assert_shows(bumps, bumps.leaflight.isovalue)


def check_the_longest_side_is_two_units_and_stands_on_the_floor(bumps):
    vertices, _, _ = mesh_arrays(bumps)
    bumps.leaflight.isovalue = 1.0
    # The origin of the object must be the center of the volume.
    bounds = 0.5 * (N - 1) * np.array([[-1, -1, -0.8], [1, 1, 0.8]])
    matrix = np.array(bumps.matrix_world)
    world = bounds @ matrix[:3, :3].T + matrix[:3, 3]
    close(world, [[-1, -1, 0], [1, 1, 1.6]], 1e-5)
    assert np.all(vertices >= bounds[0] - 1e-4) and np.all(vertices <= bounds[1] + 1e-4)


def check_the_slider_has_the_range_of_the_data(bumps):
    limits = bumps.leaflight.id_properties_ui("isovalue").as_dict()
    volume = leaflight.bump_box(N)
    low, high = leaflight.default_isovalue_range(volume)
    close([limits["min"], limits["max"]], [0, 255], 1e-4)
    close([limits["soft_min"], limits["soft_max"]], [low, high], 1e-3)
    assert bumps.leaflight.isovalue == limits["default"]
    assert low < bumps.leaflight.isovalue < high
    close([bumps.leaflight.low, bumps.leaflight.high], [low, high], 1e-3)


def check_before_a_bake_the_surface_is_plain(bumps):
    material = bumps.data.materials[0]
    assert [n.type for n in material.node_tree.nodes if n.type != "OUTPUT_MATERIAL"] == [
        "BSDF_DIFFUSE"
    ]


def check_an_isovalue_outside_the_data_is_explained_and_undone_by_a_good_one(bumps):
    bumps.leaflight.isovalue = 1000.0
    assert "1000" in surface_object.problems[bumps.name]
    assert len(bumps.data.vertices) == 0
    bumps.leaflight.isovalue = 100.0
    assert bumps.name not in surface_object.problems
    assert_shows(bumps, 100.0)


def _write_nifti(path, shape):
    values = np.random.default_rng(0).normal(size=shape).astype(np.float32)
    affine = np.array([[-2.0, 0, 0, 7], [0, 0, 3, 8], [0, 2, 0, 9], [0, 0, 0, 1]])
    nibabel.save(nibabel.Nifti1Image(values, affine), path)
    return values


def check_nifti_with_a_mirroring_affine(tmp_path):
    path = tmp_path / "noise.nii.gz"
    _write_nifti(path, (6, 7, 8))
    bpy.ops.leaflight.import_volume(filepath=str(path), size=1.0)
    obj = bpy.context.object
    assert obj.name == "noise"
    assert_shows(obj, obj.leaflight.isovalue)


def check_a_frame_of_a_series(tmp_path):
    path = tmp_path / "series.nii"
    values = _write_nifti(path, (6, 7, 8, 3))
    objects = len(bpy.data.objects)
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path))
    assert "series.nii" in sentence and "frame" in sentence
    assert len(bpy.data.objects) == objects
    bpy.ops.leaflight.import_volume(filepath=str(path), frame=1)
    limits = bpy.context.object.leaflight.id_properties_ui("isovalue").as_dict()
    close([limits["min"], limits["max"]], [values[..., 1].min(), values[..., 1].max()], 1e-6)


@pytest.mark.parametrize("name", ["scan.vol", "scan.unknown"])
def check_a_header_is_skipped_in_a_file_of_any_suffix(tmp_path, name):
    """Checks that the dialog offers options for raw values, which later reads use, too."""
    values = np.random.default_rng(0).integers(0, 99, (5, 6, 7)).astype(np.int16)
    path = tmp_path / name
    path.write_bytes(b"a header" + values.tobytes())
    assert "skip" in source_files.format_of(path).options
    choices = {"dims": (7, 6, 5), "value_type": "int16", "skip": 8}
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path))
    assert name in sentence and "\n" not in sentence
    bpy.ops.leaflight.import_volume(filepath=str(path), **choices)
    obj = bpy.context.object
    np.testing.assert_array_equal(source_files.read(obj.leaflight).values, values)
    stored, problem = stored_facts.read_facts(str(path), source_files.choices_of(obj.leaflight))
    assert stored.dims == (7, 6, 5) and not problem
    assert stored_facts.lines(str(path), stored, 1)[0] == "file without a header"


@pytest.mark.parametrize(
    "name, content, options, expected",
    [
        ("missing.nii", None, {}, "no such file"),
        ("broken.nii.gz", b"no gzip", {}, "broken.nii.gz"),
        ("short.raw", bytes(10), {"dims": (4, 4, 4)}, "64 bytes"),
        ("flat.raw", bytes(64), {"dims": (4, 4, 4)}, "flat.raw"),
        ("table.csv", b"1,2", {}, ".csv"),
    ],
)
def check_bad_files_give_one_sentence_and_change_nothing(
    tmp_path, name, content, options, expected
):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path), **options)
    assert expected in sentence and "\n" not in sentence
    assert not bpy.data.objects and not bpy.data.meshes and not bpy.data.materials


def _read_array(path, values, **options):
    np.save(path, values)
    bpy.ops.leaflight.import_volume(filepath=str(path), **options)
    return bpy.context.object


def check_what_is_seen_from_its_back_has_both_sides(tmp_path):
    z, y, x = np.mgrid[:N, :N, :N] - 0.5 * (N - 1)
    distance = np.sqrt(x**2 + y**2 + z**2).astype(np.float32)
    ball = _read_array(tmp_path / "ball.npy", np.exp(-distance / 4))
    assert not ball.leaflight.both_sides
    level_set = _read_array(tmp_path / "level.npy", distance - 8)
    assert level_set.leaflight.both_sides and level_set.leaflight.isovalue == 0
    assert_shows(level_set, 0.0)
    values = x.astype(np.float32) * np.exp(-distance / 3)
    orbital = _read_array(tmp_path / "p.npy", values, both_signs=False)
    assert orbital.leaflight.both_sides and orbital.leaflight.isovalue > 0


def check_a_mask_is_shown_half_way_and_proposed_to_be_smoothed(tmp_path):
    z, y, x = np.mgrid[:N, :N, :N] - 0.5 * (N - 1)
    ball = x**2 + y**2 + z**2 < 64
    obj = _read_array(tmp_path / "mask.npy", 255 * ball.astype(np.uint8))
    assert obj.leaflight.isovalue == 127.5 and not obj.leaflight.both_sides
    close([obj.leaflight.low, obj.leaflight.high], [0, 255], 0)
    assert distribution.look_now(obj).are_labels
    bpy.ops.leaflight.smooth(amount="1")
    assert obj.leaflight.smooth == 1.0 and not distribution.look_now(obj).are_labels


def check_fill_values_are_left_out(tmp_path):
    values = np.random.default_rng(3).random((N, N, N)).astype(np.float32)
    values[:4] = 1e20
    obj = _read_array(tmp_path / "filled.npy", values)
    assert obj.leaflight.id_properties_ui("isovalue").as_dict()["max"] < 1.001
