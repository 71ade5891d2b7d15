# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks cuts, removed parts and masks by labels: shown, baked, switched, saved and refused."""

import os

import bpy
import leaflight
import mathutils
import nibabel
import numpy as np
import pytest
from blends import reopened
from boxes import build_cornell_box
from leaflight_addon.bake import estimate_bake
from leaflight_addon.importing import regions, stored_facts
from leaflight_addon.importing.cropping import Crop
from leaflight_addon.show import data_faces, display, look, texture
from leaflight_addon.stage import camera, staleness
from leaflight_addon.store import cache, source_files
from leaflight_addon.ui import look_panel
from passes import drawn
from tools import close, colors_of, look_down, render_exr, vertices_of

N = 24


@pytest.fixture
def boxed_with_clip_box(boxed):
    """Returns the bump box and a clip box over the half towards +x."""
    bpy.ops.leaflight.add_clip_box()
    box = boxed.leaflight_look.box
    low, high = np.asarray(cache.volume_of(boxed).field().bounds)
    size = high - low
    box.matrix_world = boxed.matrix_world @ _matrix(0.5 * (low + high) + [size[0] / 2, 0, 0], size)
    # Half the size along x: from the middle to beyond the end.
    box.scale[0] *= 0.5
    bpy.context.view_layer.update()
    return boxed, box


def _matrix(middle, size):
    matrix = mathutils.Matrix.Diagonal((*(0.6 * size), 1.0))
    matrix.translation = middle
    return matrix


def _records(obj):
    return source_files.regions_of(obj.leaflight)


def check_a_cut_by_the_clip_box_is_flat_and_can_be_switched(boxed_with_clip_box):
    obj, _ = boxed_with_clip_box
    before, values = vertices_of(obj), cache.volume_of(obj).values
    assert bpy.ops.leaflight.cut_data(cut="capped") == {"FINISHED"}
    cut = vertices_of(obj)
    reach = cut[:, 0].max()
    assert reach < before[:, 0].max() - 0.2
    # Many vertices lie on the plane of the cut.
    assert np.sum(np.abs(cut[:, 0] - reach) < 1e-4) > 40
    assert look.note_on_backs(obj) == ""
    bpy.ops.leaflight.switch_region(index=0)
    close(vertices_of(obj), before, 0)
    assert not _records(obj)[0]["on"]
    bpy.ops.leaflight.switch_region(index=0)
    close(vertices_of(obj), cut, 0)
    bpy.ops.leaflight.switch_region(index=0, action="REMOVE")
    assert not _records(obj)
    np.testing.assert_array_equal(cache.volume_of(obj).values, values)


def check_buttons_of_regions_remember_no_click():
    properties = bpy.ops.leaflight.switch_region.get_rna_type().properties
    assert properties["index"].is_skip_save and properties["action"].is_skip_save


def _cuts_picture(obj):
    """Returns True if the clip box cuts the picture: the surface and its faces."""
    bpy.context.view_layer.update()
    faces = data_faces.cut_faces_of(obj)
    cuts = look.view_of(obj).cut is not None
    assert bool(len(faces.data.polygons)) == cuts
    nodes = obj.data.materials[0].node_tree.nodes
    boxes = [node.object for node in nodes if node.type == "TEX_COORD" and node.object]
    assert boxes == ([obj.leaflight_look.box] if cuts else [])
    return cuts


def check_the_box_cuts_either_the_picture_or_the_data(boxed_with_clip_box):
    obj, box = boxed_with_clip_box
    assert _cuts_picture(obj)
    bpy.ops.leaflight.cut_data(cut="capped")
    assert not _cuts_picture(obj)
    bpy.ops.leaflight.switch_region(index=0)
    assert _cuts_picture(obj)
    bpy.ops.leaflight.switch_region(index=0)
    assert not _cuts_picture(obj)
    # The data do not follow an animated box.
    box.keyframe_insert("location")
    obj.update_tag()
    assert _cuts_picture(obj)
    box.animation_data_clear()
    bpy.ops.leaflight.switch_region(index=0, action="REMOVE")
    assert _cuts_picture(obj)


def check_the_cut_follows_the_box(boxed_with_clip_box):
    obj, box = boxed_with_clip_box
    bpy.ops.leaflight.cut_data(cut="capped")
    first, whole = vertices_of(obj)[:, 0].max(), cache.volume_of(obj).values.size
    box.location[0] -= 0.1
    bpy.context.view_layer.update()
    assert len(_records(obj)) == 1
    moved = vertices_of(obj)[:, 0].max()
    assert abs(first - moved - 0.1 / obj.matrix_world.median_scale) < 0.01
    # The file, read with this cut, has the values that are shown.
    again = source_files.read(obj.leaflight)
    np.testing.assert_array_equal(again.values, cache.volume_of(obj).values)
    assert again.values.size < whole
    obj.leaflight_look.keep = "INSIDE"
    bpy.context.view_layer.update()
    assert _records(obj)[0]["keep"] == "inside" and vertices_of(obj)[:, 0].min() > 0
    # The cut stays with a volume that moves, and a switched-off cut stays as it is.
    records = _records(obj)
    obj.location[1] += 1.0
    bpy.context.view_layer.update()
    assert _records(obj) == records
    bpy.ops.leaflight.switch_region(index=0)
    box.location[0] += 0.2
    bpy.context.view_layer.update()
    assert _records(obj)[0]["place"] == records[0]["place"]


def check_the_cut_follows_the_name_of_the_box(boxed_with_clip_box):
    obj, box = boxed_with_clip_box
    bpy.ops.leaflight.cut_data(cut="capped")
    bpy.ops.leaflight.bake()
    obj = bpy.context.object
    first = vertices_of(obj)[:, 0].max()
    box.name = "Renamed"
    bpy.context.view_layer.update()
    assert _records(obj)[0]["object"] == "Renamed" and not _cuts_picture(obj)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    box.location[0] -= 0.1
    bpy.context.view_layer.update()
    assert len(_records(obj)) == 1
    moved = vertices_of(obj)[:, 0].max()
    assert abs(first - moved - 0.1 / obj.matrix_world.median_scale) < 0.01


def check_a_baked_cut_is_lit_and_stays_in_files(boxed_with_clip_box, tmp_path):
    obj, _ = boxed_with_clip_box
    obj.leaflight.shading = "ATTRIBUTE"
    bpy.ops.leaflight.cut_data(cut="capped")
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    vertices = vertices_of(obj)
    on_cut = np.abs(vertices[:, 0] - vertices[:, 0].max()) < 1e-4
    assert colors_of(obj, "radiance")[on_cut, :3].mean() > 0.02
    obj = reopened(tmp_path / "scene.blend")
    close(vertices_of(obj), vertices, 0)
    obj.leaflight.isovalue *= 1.001
    assert staleness.change_since_bake(bpy.context, obj) == ""
    bpy.ops.leaflight.switch_region(index=0)
    assert staleness.change_since_bake(bpy.context, obj) == staleness.CUT


def check_a_cut_that_moves_is_lit_by_an_estimate(boxed_with_clip_box, tmp_path):
    obj, box = boxed_with_clip_box
    obj.leaflight.shading = "ATTRIBUTE"
    bpy.ops.leaflight.cut_data(cut="capped")
    assert "leaflight.bake" in drawn(look_panel.LEAFLIGHT_PT_clip)
    bpy.ops.leaflight.bake()
    assert "leaflight.bake" not in drawn(look_panel.LEAFLIGHT_PT_clip)
    baked, before = colors_of(obj, "radiance")[:, :3], vertices_of(obj)
    box.location[0] -= 0.2
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, obj) == staleness.CUT
    texts = drawn(look_panel.LEAFLIGHT_PT_clip)
    assert "leaflight.bake" in texts and "Light near the cut is an estimate" in texts
    vertices, light = vertices_of(obj), colors_of(obj, "radiance")[:, :3]
    reach = vertices[:, 0].max()
    on_cut = vertices[:, 0] > reach - 1e-4
    far = vertices[:, 0] < reach - 0.2 / obj.matrix_world.median_scale
    assert on_cut.sum() > 40 and far.sum() > 40
    # The cut is lit, and what is far from it keeps its light.
    assert light[on_cut].mean(axis=1).min() > 0.1 * baked.mean()
    near = np.linalg.norm(before[:, None] - vertices[far][None, ::7], axis=2).argmin(axis=0)
    assert np.abs(baked[near] - light[far][::7]).mean() < 0.1 * baked.mean()
    # A reopened file shows the same estimate.
    obj = reopened(tmp_path / "scene.blend")
    close(vertices_of(obj), vertices, 0)
    close(colors_of(obj, "radiance")[:, :3], light, 1e-5)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    fresh = colors_of(obj, "radiance")[vertices_of(obj)[:, 0] > reach - 1e-4, :3]
    assert 0.5 < light[on_cut].mean() / fresh.mean() < 2


def check_a_cut_shows_a_slice(boxed_with_clip_box, tmp_path):
    obj, _ = boxed_with_clip_box
    settings = obj.leaflight
    settings.shading = "ATTRIBUTE"
    settings.texture_kind = "SLICES"
    assert not texture.is_colored(obj)
    bpy.ops.leaflight.cut_data(cut="capped")
    assert settings.texture_map == "CET_L1"
    vertices = vertices_of(obj)
    colors = texture.local_texture(obj).at(vertices)
    uncut = texture.own_volume(obj).field().sample(vertices)
    on_cut = np.abs(vertices[:, 0] - vertices[:, 0].max()) < 1e-4
    assert (np.diff(colors[on_cut][np.argsort(uncut[on_cut]), 0]) >= -1e-6).all()
    assert np.ptp(colors[on_cut, 0]) > 0.1
    assert (colors[vertices[:, 0] < 0] == 1).all()
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj = reopened(tmp_path / "scene.blend")
    np.testing.assert_array_equal(texture.local_texture(obj).at(vertices), colors)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    bpy.ops.leaflight.switch_region(index=0)
    assert not texture.is_colored(obj)


def check_undo_brings_the_data_back(boxed_with_clip_box):
    obj, _ = boxed_with_clip_box
    name, whole = obj.name, vertices_of(obj)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.leaflight.cut_data(cut="capped")
    cut = vertices_of(obj)
    bpy.ops.ed.undo_push(message="cut")
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    close(vertices_of(obj), whole, 0)
    assert not _records(obj) and cache.volume_of(obj).cuts is None
    bpy.ops.ed.redo()
    obj = bpy.data.objects[name]
    close(vertices_of(obj), cut, 0)
    assert len(_records(obj)) == 1 and cache.volume_of(obj).cuts is not None


def check_both_renders_show_the_slice(boxed_with_clip_box, tmp_path):
    obj, box = boxed_with_clip_box
    low, high = np.asarray(cache.volume_of(obj).field().bounds)
    middle, size = 0.5 * (low + high), high - low
    box.matrix_world = obj.matrix_world @ _matrix(middle + [0, 0, size[2] / 2], size)
    box.scale[2] *= 0.5
    bpy.context.view_layer.update()
    bpy.ops.leaflight.cut_data(cut="capped")
    obj.leaflight.texture_kind = "SLICES"
    obj.leaflight.shading = "ATTRIBUTE"
    bpy.ops.leaflight.bake()
    for other in bpy.context.scene.objects:
        # A hidden lamp is off.
        other.hide_render = other != obj and other.type != "LIGHT"
    look_down(5.0, 1.6)
    by_cycles, by_eevee = (
        render_exr(tmp_path / f"{engine}.exr", engine)[..., :3] for engine in ("CYCLES", "EEVEE")
    )
    seen = by_cycles.max(axis=-1) > 0.01
    assert seen.sum() > 50 and by_cycles[seen].std() > 0.02
    assert np.median(abs(by_eevee - by_cycles)[seen]) < 0.02 * by_cycles[seen].mean()


def check_an_open_cut_shows_the_inside(boxed_with_clip_box):
    obj, _ = boxed_with_clip_box
    bpy.ops.leaflight.cut_data(cut="open")
    assert np.isnan(cache.volume_of(obj).values).any()
    assert "Both Sides" in look.note_on_backs(obj) or not obj.leaflight.bake_id


@pytest.fixture
def balls(tmp_path):
    """Returns an object with a large and a small ball."""
    z, y, x = np.mgrid[:N, :N, :N]
    values = np.maximum(
        1 - np.sqrt((x - 8.0) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2) / 8,
        0.9 - np.sqrt((x - 20.0) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2) / 4,
    )
    np.save(tmp_path / "balls.npy", np.float32(np.maximum(0, 100 * values)))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "balls.npy"))
    obj = bpy.context.object
    obj.leaflight.isovalue = 40.0
    return obj


def check_only_the_largest_part_stays(balls):
    whole = vertices_of(balls)
    bpy.ops.leaflight.clean_data(kind="largest_part")
    left = vertices_of(balls)
    middle = 0.5 * (whole[:, 0].min() + whole[:, 0].max())
    assert 0 < len(left) < len(whole) and left[:, 0].max() < middle + 0.1 * np.ptp(whole[:, 0])
    bpy.ops.leaflight.switch_region(index=0, action="REMOVE")
    close(vertices_of(balls), whole, 0)
    bpy.ops.leaflight.clean_data(kind="dust", voxels=300)
    close(vertices_of(balls), left, 0)


def check_crops(balls, monkeypatch):
    # The small ball is no large part, but it is shown.
    monkeypatch.setattr(camera, "_SHARE", 0.5)
    whole, place = vertices_of(balls), balls.matrix_world.copy()
    before = cache.volume_of(balls).values
    bpy.ops.leaflight.crop_to_shown(margin=2)
    # The vertices have another order.
    close(np.sort(vertices_of(balls), axis=0), np.sort(whole, axis=0), 1e-5)
    cropped = cache.volume_of(balls).values
    assert cropped.size < 0.7 * before.size and cropped.dtype == before.dtype
    assert balls.matrix_world == place
    bpy.ops.leaflight.switch_region(index=0)
    np.testing.assert_array_equal(cache.volume_of(balls).values, before)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def check_a_clip_box_crops_and_the_bake_is_estimated_before(balls, turn):
    build_cornell_box()
    balls.leaflight.resolution, balls.leaflight.error = N, 20.0
    balls.rotation_euler.z = turn
    bpy.context.view_layer.update()
    bpy.ops.leaflight.estimate_bake()
    before = cache.volume_of(balls).values
    bpy.ops.leaflight.add_clip_box()
    balls.leaflight_look.keep = "INSIDE"
    bpy.ops.leaflight.cut_data(cut="open")
    cropped = cache.volume_of(balls).values
    # The box is an eighth of the volume, and cells at its faces keep their corners.
    assert cropped.size < 0.3 * before.size and cropped.dtype == before.dtype
    assert np.isfinite(cropped).all()
    assert estimate_bake.estimate_of(balls) is None
    assert bpy.ops.leaflight.estimate_bake() == {"FINISHED"}
    estimate = estimate_bake.estimate_of(balls)
    assert estimate.seconds > 0 and estimate.memory_bytes > 0


def check_an_import_crops(tmp_path):
    values = np.arange(20 * 21 * 22, dtype=np.int16).reshape(20, 21, 22)
    path = tmp_path / "ramp.npy"
    np.save(path, values)
    crop = {"crop": True, "crop_from": (0.0, 50.0, 0.0), "crop_to": (100.0, 100.0, 25.0)}
    bpy.ops.leaflight.import_volume(filepath=str(path), **crop)
    obj = bpy.context.object
    np.testing.assert_array_equal(cache.volume_of(obj).values, values[:6, 10:])
    np.testing.assert_array_equal(source_files.read(obj.leaflight).values, values[:6, 10:])
    stored = source_files.probe(str(path), **source_files.choices_of(obj.leaflight))
    known = stored_facts.lines(str(path), stored, 1, Crop((0, 50, 0), (100, 100, 25)))
    assert "Cropped to 22 x 11 x 6 voxels" in known
    bpy.ops.leaflight.switch_region(index=0)
    np.testing.assert_array_equal(cache.volume_of(obj).values, values)
    with pytest.raises(RuntimeError, match="the crop is empty: let it end after its start"):
        bpy.ops.leaflight.import_volume(filepath=str(path), crop=True, crop_to=(0, 100, 100))


def check_a_part_is_removed_by_a_point_on_it(balls):
    whole = vertices_of(balls)
    end = balls.matrix_world @ mathutils.Vector(whole[np.argmax(whole[:, 0])])
    bpy.ops.leaflight.remove_part(point=end)
    assert vertices_of(balls)[:, 0].max() < 0.5 * whole[:, 0].max()
    assert balls.leaflight.isovalue == pytest.approx(40.0)


def check_a_sphere_about_the_cursor_is_removed(balls):
    whole, name = vertices_of(balls), balls.name
    bpy.ops.ed.undo_push(message="whole")
    place = mathutils.Vector(whole[np.argmin(whole[:, 0])])
    bpy.context.scene.cursor.location = balls.matrix_world @ place
    bpy.ops.leaflight.remove_sphere(radius=3.0)
    bpy.ops.ed.undo_push(message="removed")
    left = vertices_of(balls)
    away = np.linalg.norm(left - place, axis=1)
    # The cap is within a voxel of the sphere.
    assert away.min() >= 3.0 and np.sum(away < 4.0) > 20
    assert regions.title(_records(balls)[0]) == "Removed Sphere"
    # The file, read with this region, has the values that are shown.
    again = source_files.read(balls.leaflight)
    np.testing.assert_array_equal(again.values, cache.volume_of(balls).values)
    assert again.source.endswith("balls.npy, ball")
    bpy.ops.ed.undo()
    balls = bpy.data.objects[name]
    close(vertices_of(balls), whole, 0)
    # An exploded part is cut where it is shown.
    balls.leaflight_look.explode_axis, balls.leaflight_look.explode_distance = "X", 30.0
    bpy.context.view_layer.update()
    end = vertices_of(balls)[:, 0].argmin()
    bpy.context.scene.cursor.location = balls.matrix_world @ balls.data.vertices[end].co
    bpy.ops.leaflight.remove_sphere(radius=3.0)
    balls.leaflight_look.explode_axis = "NONE"
    close(vertices_of(balls), left, 1e-4)
    bpy.context.scene.cursor.location = (9.0, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="from the 3D cursor: put the cursor on it"):
        bpy.ops.leaflight.remove_sphere()


def check_what_leaves_nothing_is_refused(balls, boxed_with_clip_box):
    obj, box = boxed_with_clip_box
    vertices = vertices_of(obj)
    box.scale = (9, 9, 9)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="the box leaves nothing of the volume"):
        bpy.ops.leaflight.cut_data(cut="capped")
    assert not _records(obj)
    close(vertices_of(obj), vertices, 0)
    with pytest.raises(RuntimeError, match="0 changes of its data: choose one of them"):
        bpy.ops.leaflight.switch_region(index=3)
    with pytest.raises(RuntimeError, match="nothing at or above the isovalue"):
        bpy.ops.leaflight.remove_part(point=(50.0, 0.0, 0.0))


def check_the_box_is_in_the_coordinates_of_the_file(boxed_with_clip_box):
    obj, _ = boxed_with_clip_box
    bpy.ops.leaflight.cut_data(cut="capped")
    values = cache.volume_of(obj).values
    obj.location[1] += 3.0
    bpy.context.view_layer.update()
    path, choices = source_files.path_of(obj.leaflight), source_files.choices_of(obj.leaflight)
    again = source_files.read_volume(path, **choices)
    np.testing.assert_array_equal(again.values, values)
    assert isinstance(again, leaflight.Volume) and again.cuts is not None


@pytest.fixture
def masks(balls, tmp_path):
    """Returns the balls, and a label map of twice their voxel size with a label for each."""
    z, y, x = np.mgrid[0:N:2, 0:N:2, 0:N:2] + 0.0
    labels = np.where(np.hypot(np.hypot(x - 8.0, y - 11.5), z - 11.5) < 8, 3, 0)
    labels[np.hypot(np.hypot(x - 20.0, y - 11.5), z - 11.5) < 4] = 5
    image = nibabel.Nifti1Image(labels.T.astype(np.uint8), np.diag([2.0, 2.0, 2.0, 1.0]))
    nibabel.save(image, tmp_path / "labels.nii")
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "labels.nii"))
    label_map = bpy.context.object.leaflight.texture_volume
    display.select(bpy.context, [balls], balls)
    return balls, label_map


def check_a_volume_is_masked_by_the_shown_labels(masks, tmp_path):
    obj, label_map = masks
    whole = vertices_of(obj)
    label_map.leaflight.labels[0].is_shown = False
    assert bpy.ops.leaflight.mask_data(label_map=label_map.name) == {"FINISHED"}
    (region,) = _records(obj)
    assert region["labels"] == [5] and regions.title(region).endswith(label_map.name)
    kept = vertices_of(obj)
    middle = 0.5 * (whole[:, 0].min() + whole[:, 0].max())
    assert len(kept) and kept[:, 0].min() > middle
    names, blend = (obj.name, label_map.name), str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.wm.open_mainfile(filepath=blend)
    obj, label_map = (bpy.data.objects[name] for name in names)
    display.select(bpy.context, [obj], obj)
    close(vertices_of(obj), kept, 0)
    # Another choice of labels takes the place of the first.
    label_map.leaflight.labels[0].is_shown = True
    bpy.ops.leaflight.mask_data(label_map=label_map.name)
    assert [region["labels"] for region in _records(obj)] == [[3, 5]]
    bpy.ops.leaflight.switch_region(index=0)
    close(vertices_of(obj), whole, 0)


def check_a_label_map_that_changes_is_noticed(masks, tmp_path):
    obj, label_map = masks
    path = tmp_path / "labels.nii"
    bpy.ops.object.light_add(type="SUN")
    display.select(bpy.context, [obj], obj)
    obj.leaflight.error = 20.0
    bpy.ops.leaflight.mask_data(label_map=label_map.name)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    image = nibabel.load(path)
    numbers = np.asarray(image.dataobj).copy()
    touched = path.stat().st_mtime_ns + 10**9

    def write(values):
        nibabel.save(nibabel.Nifti1Image(values, image.affine), path)
        os.utime(path, ns=(touched, touched))
        staleness.forget()
        return staleness.change_since_bake(bpy.context, obj)

    # The same labels, written again, are no change.
    assert write(numbers) == ""
    touched += 10**9
    numbers[10:] = 0
    assert "have changed since the bake" in write(numbers)
    vertices = vertices_of(obj)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    assert vertices_of(obj)[:, 0].max() < vertices[:, 0].max() - 0.1


def check_masks_that_cannot_be_are_refused(masks, tmp_path):
    obj, label_map = masks
    label_map.leaflight.labels.foreach_set("is_shown", [False, False])
    with pytest.raises(RuntimeError, match="All labels of .* are hidden: show one of them"):
        bpy.ops.leaflight.mask_data(label_map=label_map.name)
    label_map.leaflight.labels.foreach_set("is_shown", [True, True])
    (tmp_path / "labels.nii").unlink()
    with pytest.raises(RuntimeError, match="labels.nii: there is no such file"):
        bpy.ops.leaflight.mask_data(label_map=label_map.name)
    assert not _records(obj)
