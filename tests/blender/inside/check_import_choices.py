# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the options of an import: size, resolution, and which of several volumes."""

import sys
import zlib

import bpy
import nibabel
import numpy as np
import pytest
from blends import open_saved
from leaflight.volume.examples import EXAMPLES
from leaflight_addon.importing import stored_facts
from leaflight_addon.show import isosurfaces
from leaflight_addon.store import cache, source_files
from leaflight_addon.edit import data_picture
from leaflight_addon.show import distribution
from tools import assert_shows, close, error_of

CHOICES = {"use_spacing": False, "level": 0, "dataset": "", "spacing": (1, 1, 1)}
AFFINE = np.array([[-2.0, 0, 0, 90], [0, 2.5, 0, -126], [0, 0.5, 3.0, -72], [0, 0, 0, 1]])


def write_scan(path, shape=(12, 14, 16), affine=AFFINE, seed=0):
    values = np.random.default_rng(seed).normal(size=shape).astype(np.float32)
    nibabel.save(nibabel.Nifti1Image(values, affine), path)
    return values


def imported(path, **options):
    bpy.ops.leaflight.import_volume(filepath=str(path), **options)
    bpy.context.view_layer.update()
    return bpy.context.object


def to_world(obj, index):
    matrix = np.array(obj.matrix_world) @ cache.volume_of(obj).index_to_world
    return (matrix @ [*index, 1])[:3]


def check_life_size_is_the_files_meters_at_its_own_place(tmp_path):
    write_scan(tmp_path / "scan.nii")
    obj = imported(tmp_path / "scan.nii", size_from="LIFE")
    assert obj.leaflight.unit == "mm"
    close(to_world(obj, (3, 4, 5)), 1e-3 * (AFFINE @ [3, 4, 5, 1])[:3], 1e-6)
    bpy.context.scene.unit_settings.scale_length = 0.01
    obj = imported(tmp_path / "scan.nii", size_from="LIFE")
    close(to_world(obj, (3, 4, 5)), 0.1 * (AFFINE @ [3, 4, 5, 1])[:3], 1e-4)


def check_two_scans_of_one_patient_lie_over_each_other(tmp_path):
    """Checks two scans with other voxels and positions: a point of the patient must match in
    both.
    """
    write_scan(tmp_path / "a.nii")
    finer = (
        AFFINE
        @ np.diag([0.5, 0.5, 0.5, 1])
        @ np.array([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]])
    )
    write_scan(tmp_path / "b.nii", affine=finer)
    first = imported(tmp_path / "a.nii", size=3.0)
    first.rotation_euler[2] = 0.5
    second = imported(tmp_path / "b.nii", size_from="SAME", partner=first.name)
    close(to_world(second, (0, 2, 4)), to_world(first, (2, 1, 3)), 1e-5)
    # Without a name it is the active volume.
    third = imported(tmp_path / "b.nii", size_from="SAME")
    close(third.matrix_world, second.matrix_world, 1e-6)


def check_a_volume_of_another_space_stands_beside_the_first(tmp_path):
    write_scan(tmp_path / "a.nii")
    write_scan(tmp_path / "b.nii", affine=np.diag([1.0, 1.0, 1.0, 1.0]) + _shifted(500))
    np.save(tmp_path / "c.npy", np.random.default_rng(0).normal(size=(9, 8, 7)).astype(np.float32))
    boxes = []
    for name in ("a.nii", "b.nii", "c.npy"):
        obj = imported(tmp_path / name)
        boxes.append(isosurfaces.world_box(obj))
    for (low, high), (next_low, next_high) in zip(boxes, boxes[1:]):
        assert 0 < next_low[0] - high[0] < 0.5
        close([next_low[2], (next_low + next_high)[1]], [low[2], (low + high)[1]], 1e-4)
    # Another scan of the first patient lies over it, unless another position is chosen.
    close(imported(tmp_path / "a.nii").matrix_world, bpy.data.objects["a"].matrix_world, 1e-6)
    obj = imported(tmp_path / "a.nii", size_from="FIT")
    close(isosurfaces.world_box(obj), boxes[0], 1e-5)


def check_a_mesh_does_not_hide_the_first_volume(tmp_path):
    """Checks that Blender's default cube is hidden, but not a room or a table below the volume."""
    write_scan(tmp_path / "a.nii")
    bpy.ops.mesh.primitive_cube_add(size=9.0)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, -0.5))
    low, high = isosurfaces.world_box(imported(tmp_path / "a.nii"))
    close((low + high)[:2], (0.0, 0.0), 1e-5)
    bpy.data.objects.remove(bpy.data.objects["a"])
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    cube = bpy.context.object
    moved_low, moved_high = isosurfaces.world_box(imported(tmp_path / "a.nii"))
    assert 0 < moved_low[0] - 1.0 < 0.5
    close([moved_low[2], (moved_low + moved_high)[1]], [0.0, 0.0], 1e-5)
    bpy.data.objects.remove(bpy.data.objects["a"])
    cube.hide_set(True)
    close(isosurfaces.world_box(imported(tmp_path / "a.nii")), [low, high], 1e-5)


def _shifted(distance):
    matrix = np.zeros((4, 4))
    matrix[:3, 3] = distance
    return matrix


def check_together_with_nothing_is_explained(tmp_path):
    write_scan(tmp_path / "a.nii")
    sentence = error_of(
        bpy.ops.leaflight.import_volume, filepath=str(tmp_path / "a.nii"), size_from="SAME"
    )
    assert "Together With" in sentence and not bpy.data.objects


def check_what_life_size_cannot_show_is_explained(tmp_path):
    path = tmp_path / "x.cube"
    numbers = np.random.default_rng(0).normal(size=(64,)).round(3)
    axes = ["4 1 0 0", "4 0 1 0", "4 0 0 1"]
    path.write_text("\n".join(["a", "b", "0 0 0 0", *axes, " ".join(map(str, numbers))]))
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path), size_from="LIFE")
    assert "choose Fit" in sentence
    assert not bpy.data.objects and not bpy.data.meshes
    assert imported(path).leaflight.unit == "bohr"


def check_half_the_resolution_is_read_again_as_it_was(tmp_path):
    values = write_scan(tmp_path / "scan.nii")
    obj = imported(tmp_path / "scan.nii", resolution="HALF")
    assert obj.leaflight.downsample == 2
    assert cache.volume_of(obj).values.shape == (8, 7, 6)
    close(cache.volume_of(obj).values[0, 0, 0], values[:2, :2, :2].mean(), 1e-6)
    isovalue = obj.leaflight.isovalue
    obj = open_saved(tmp_path / "scene.blend")
    assert cache.volume_of(obj).values.shape == (8, 7, 6)
    obj.leaflight.isovalue = 0.5 * isovalue
    assert_shows(obj, obj.leaflight.isovalue)


def check_large_volumes_are_halved_by_themselves(tmp_path, monkeypatch):
    monkeypatch.setattr(stored_facts, "MOST_VOXELS", 12 * 14 * 16 // 8)
    write_scan(tmp_path / "scan.nii")
    assert imported(tmp_path / "scan.nii").leaflight.downsample == 2
    assert imported(tmp_path / "scan.nii", resolution="FULL").leaflight.downsample == 1


def check_a_dataset_and_a_frame_are_read_again_as_they_were(tmp_path):
    path = tmp_path / "x.npz"
    h = np.random.default_rng(1).normal(size=(2, 6, 7, 8)).astype(np.float32)
    np.savez(path, g=h[0], h=h)
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path))
    assert "g, h" in sentence
    obj = imported(path, dataset="h", frame=1, use_spacing=True, spacing=(1, 2, 3))
    close(cache.volume_of(obj).values, h[1], 0)
    obj = open_saved(tmp_path / "scene.blend")
    volume = cache.volume_of(obj)
    close(volume.values, h[1], 0)
    close(np.diag(volume.index_to_world), [1, 2, 3, 1], 0)


def check_a_voxel_size_of_the_file_counts_unless_it_is_given(tmp_path):
    header = "NDims = 3\nDimSize = 8 7 6\nElementSpacing = 1 2 4\nCompressedData = True\n"
    header += "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    values = np.random.default_rng(1).integers(0, 255, (6, 7, 8)).astype(np.uint8)
    (tmp_path / "x.mha").write_bytes(header.encode() + zlib.compress(values.tobytes()))
    obj = imported(tmp_path / "x.mha", spacing=(3, 3, 3))
    close(np.linalg.norm(cache.volume_of(obj).index_to_world[:3, :3], axis=0), [1, 2, 4], 0)


def check_the_dialog_shows_the_facts_of_the_header(tmp_path):
    path = tmp_path / "scan.nii"
    write_scan(path, (12, 14, 16, 3))
    stored, problem = stored_facts.read_facts(str(path), CHOICES)
    assert not problem and stored.frames == 3
    facts = stored_facts.lines(str(path), stored, 2)
    assert facts[0] == "NIfTI file" and facts[1] == "12 x 14 x 16 voxels, float32"
    assert "mm" in facts[2] and facts[3] == "Read as 6 x 7 x 8 voxels" and facts[4].endswith("MB")
    path.write_bytes(b"text")
    stored, problem = stored_facts.read_facts(str(path), CHOICES)
    assert stored is None and "NIfTI" in problem
    assert stored_facts.read_facts(str(tmp_path), CHOICES) == (None, "")


def check_a_word_with_numbers_is_translated(tmp_path):
    """Checks that a text with numbers is translated before the numbers are inserted."""
    view = bpy.context.preferences.view
    german = {"de_DE", "de"} & set(bpy.app.translations.locales)
    if not german:
        pytest.skip("this Blender has no languages")
    before = view.language
    view.language = german.pop()
    try:
        write_scan(tmp_path / "scan.nii")
        stored = source_files.probe(str(tmp_path / "scan.nii"), **CHOICES)
        facts = stored_facts.lines(str(tmp_path / "scan.nii"), stored, 1)
        assert facts[1] == "12 x 14 x 16 Voxel, float32"
        translated = bpy.app.translations.pgettext_iface
        assert translated("Import Volume", "Operator") == "Volumen importieren"
        assert translated("Isovalue") == "Isowert"
        assert translated(EXAMPLES["water"].label) == "Spritzer"
        assert "Laserpuls" in bpy.app.translations.pgettext_tip(EXAMPLES["water"].text)
    finally:
        view.language = before


def check_an_absent_package_is_reported_in_words_of_blender(tmp_path, monkeypatch):
    # A separate process reads HDF5 with its own h5py. This process reads MINC.
    path = tmp_path / "x.mnc"
    path.write_bytes(b"")
    monkeypatch.setitem(sys.modules, "nibabel", None)
    monkeypatch.delitem(sys.modules, "leaflight.io.readers.minc", raising=False)
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path))
    remedy = "apt install python3-nibabel" if sys.prefix == "/usr" else "another program"
    assert "nibabel" in sentence and remedy in sentence


def check_the_histogram_has_every_voxel_and_the_picture_its_marks(bumps):
    found = distribution.look_now(bumps)
    volume = cache.volume_of(bumps)
    assert found.counts.sum() == volume.values.size
    assert (found.low, found.high) == volume.field().range
    settings = bumps.leaflight
    settings.isovalue = 0.5 * (settings.low + settings.high)
    picture = data_picture.paint(found, settings.low, settings.high, settings.isovalue)
    orange = np.all(
        np.abs(picture[: data_picture.HISTOGRAM, :, :3] - data_picture.ISOVALUE) < 1e-6, axis=-1
    )
    marked = np.flatnonzero(orange.all(axis=0))
    expected = found.place_of(settings.isovalue) * (data_picture.SIDE - 1)
    assert len(marked) == 2 and abs(marked.mean() - expected) < 1.5
    # Higher bars are more frequent values.
    heights = data_picture.bars(found.counts)
    assert np.all(np.diff(heights[np.argsort(found.counts, kind="stable")]) >= 0)

    # The picture tints the inside of the isosurface, which grows at a lower isovalue.
    def tinted(isovalue):
        pixels = data_picture.paint(found, settings.low, settings.high, isovalue)
        above = pixels[data_picture.HISTOGRAM + 4 :]
        return (above[..., 0] > above[..., 2] + 0.1).sum()

    assert tinted(100.0) > tinted(150.0) > 0
    close(picture.shape, (data_picture.SIDE, data_picture.SIDE, 4), 0)


@pytest.mark.parametrize("highest, bins", [(200, 201), (1000, 251)])
def check_the_histogram_of_integers_has_no_gaps(tmp_path, highest, bins):
    """Checks that each bar counts the same number of integers, and is centered on them."""
    values = np.arange(14 * 12 * 16).reshape(14, 12, 16) % (highest + 1)
    np.save(tmp_path / "x.npy", values.astype(np.uint16))
    found = distribution.look_now(imported(tmp_path / "x.npy"))
    assert len(found.counts) == bins and found.counts.sum() == values.size
    assert found.counts[:-1].max() < 2 * found.counts[:-1].min()
    assert (found.low, found.high - 0.5 >= highest) == (-0.5, True)


def check_a_picture_is_painted_once(bumps, monkeypatch):
    distribution.look_now(bumps)
    painted = []
    original = data_picture.paint
    monkeypatch.setattr(data_picture, "paint", lambda *a: painted.append(1) or original(*a))
    for _ in range(3):
        # Without a window icons have no number.
        data_picture.icon_of(bumps)
        assert len(painted) == 1
    bumps.leaflight.isovalue += 0.3 * (bumps.leaflight.high - bumps.leaflight.isovalue)
    data_picture.icon_of(bumps)
    assert len(painted) == 2


def check_the_next_file_has_its_own_part():
    properties = bpy.ops.leaflight.import_volume.get_rna_type().properties
    for name in ("dataset", "frame", "channel", "level"):
        assert properties[name].is_skip_save, name
    assert not properties["dims"].is_skip_save


def check_a_volume_without_its_file_keeps_its_place(tmp_path):
    """Checks an import beside a volume whose file is gone."""
    for name in ("a.npy", "b.npy"):
        np.save(tmp_path / name, np.random.default_rng(0).normal(size=(9, 8, 7)))
    first = imported(tmp_path / "a.npy")
    (tmp_path / "a.npy").unlink()
    low, _ = isosurfaces.world_box(imported(tmp_path / "b.npy"))
    assert (np.array(first.matrix_world) @ [*first.bound_box[6], 1.0])[0] < low[0]
