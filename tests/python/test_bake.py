# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes: for any number of threads, read back, cancelled, and refused."""

import ast
import inspect
import json
import threading
import time
from dataclasses import replace
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight import Cancelled, Progress, _core, load_bake
from leaflight.bake.provenance import provenance_from_json, read_bake_id, values_sha256
from leaflight.bake.settings import UnusedSetting
from outcomes import refused, written
from same_bytes import assert_same_bake, assert_same_light, saved_alike
from waiting import HANG, wait_for

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def test_threads_do_not_matter(tmp_path, bump_scene, small):
    paths = [tmp_path / "one.vdb", tmp_path / "two.vdb"]
    for threads, path in zip((1, 2), paths):
        leaflight.bake(leaflight.bump_box(16), bump_scene, threads=threads, **small).save(path)
    assert_same_bake(*paths)


def test_seed_matters(box_bake, bump_scene, small):
    other = leaflight.bake(leaflight.bump_box(20), bump_scene, seed=1, **small)
    assert not np.array_equal(other.grid.dense("radiance"), box_bake.grid.dense("radiance"))
    np.testing.assert_array_equal(other.grid.mask(), box_bake.grid.mask())


def test_result(box_bake):
    radiance, mask = box_bake.grid.dense("radiance"), box_bake.grid.mask().astype(bool)
    assert radiance.shape == (20, 20, 20, 3) and radiance.dtype == np.float32
    assert np.isfinite(radiance).all() and (radiance >= 0).all()
    assert 0 < mask.sum() < mask.size and mask.sum() == box_bake.grid.texels
    assert (radiance[~mask] == 0).all()
    assert radiance[mask].mean() > 0.01
    statistics = box_bake.statistics
    assert statistics.texels == box_bake.grid.texels
    assert statistics.rays > 0 and statistics.seconds > 0
    assert statistics.peak_memory_bytes > radiance.nbytes
    for name, reason in statistics.skipped_passes:
        assert name and reason


def test_settings_without_effect_are_named_before_the_first_pass(bump_scene):
    alone = replace(bump_scene, meshes=[])
    settings = {"error": 50.0, "resolution": 8, "both_sides": True, "walls": True}
    with pytest.warns(UnusedSetting) as warned:
        baked = leaflight.bake(leaflight.nucleons(16)[0], alone, isovalues=(60, 120), **settings)
    walls, back = sorted((str(one.message) for one in warned), reverse=True)
    assert walls.startswith("No walls")
    assert back.startswith("No backs")
    assert baked.walls is None and not baked.grid.has_back


def test_the_command_line_names_settings_without_effect(cli, tmp_path):
    scene = json.loads((SCENES / "bump_box.json").read_text())
    bare = written(tmp_path / "bare.json", json.dumps({**scene, "meshes": []}))
    options = ("--scene", bare, "--dims", 12, "--resolution", 8, "--error", 50, "--walls")
    done = cli("bake", "bump_box", *options, "--out", tmp_path / "bare.vdb")
    assert done.status == 0 and "leaflight: No walls" in done.err


def test_provenance(box_bake):
    known = box_bake.provenance
    assert known.leaflight_version == leaflight.__version__ and known.seed == 0
    (volume,) = known.volumes
    assert len(volume.values_sha256) == 64 and volume.resolution == (20, 20, 20)
    assert volume.name == volume.source == "bump_box" and volume.capped is False
    assert known.both_sides is known.walls is False
    assert provenance_from_json(known.to_json()) == known
    for wrong in ({"seed": "0"}, {"scene": 1}, {"isovalues": [1]}, {"more": 1}, {"volumes": [{}]}):
        with pytest.raises((KeyError, TypeError, ValueError)):
            provenance_from_json(json.dumps({**json.loads(known.to_json()), **wrong}))


def test_ids_of_bakes_differ_and_is_read_from_the_first_bytes(small, bump_scene, tmp_path):
    volume = leaflight.bump_box(12)
    first, same = (leaflight.bake(volume, bump_scene, **small) for _ in range(2))
    other = leaflight.bake(volume, bump_scene, **{**small, "seed": 1})
    moved = leaflight.Volume(volume.values, np.diag([1.0, 1.0, 1.001, 1.0]), "bump_box", "bump_box")
    elsewhere = leaflight.bake(moved, bump_scene, **small)
    assert first.id == same.id and len({first.id, other.id, elsewhere.id}) == 3
    path = tmp_path / "any name.vdb"
    first.save(path)
    assert read_bake_id(path) == load_bake(path).id == first.id
    path.write_bytes(path.read_bytes()[:2000])
    assert read_bake_id(path) == first.id
    refused("any name.vdb", load_bake, path)


def test_the_hash_of_values_is_that_of_the_file(small, bump_scene, tmp_path):
    values = leaflight.bump_box(12).values.copy()
    values[:2] = 0.0
    values[0, 3] = -0.0
    values[5, 5, 5] = np.frombuffer(b"\x01\x00\xc0\xff", "<f4")[0]  # a NaN with a payload
    volume = leaflight.Volume(values, np.eye(4), "odd")
    leaflight.bake(volume, bump_scene, **small).save(tmp_path / "odd.vdb")
    loaded = load_bake(tmp_path / "odd.vdb")
    (record,) = loaded.provenance.volumes
    assert np.isnan(loaded.volume.values).sum() == 1
    assert values_sha256(loaded.volume) == record.values_sha256 == values_sha256(volume)
    values[6, 6, 6] += 1.0
    assert values_sha256(leaflight.Volume(values, np.eye(4), "odd")) != record.values_sha256


def test_edited_metadata_are_refused(box_file, box_bake, tmp_path):
    # Leave out the seal at the end, which would not match.
    data, known = box_file.read_bytes()[:-24], box_bake.id.encode()
    assert data.count(known) == 1
    forged = written(tmp_path / "forged.vdb", data.replace(known, b"0" * 32))
    assert read_bake_id(forged) == "0" * 32
    refused("metadata were edited", load_bake, forged)
    no_text = written(tmp_path / "damaged.vdb", data.replace(b"texels", b"te\xffels"))
    refused("damaged.vdb: .*damaged", load_bake, no_text)


@pytest.mark.parametrize("name, isovalue", [("box", 47.0), ("lapr", 0.5)])
def test_a_loaded_bake_is_the_saved_one(name, isovalue, request, tmp_path):
    """Checks each bit of the light that is stored, and of the light that is derived."""
    bake = request.getfixturevalue(f"{name}_bake")
    loaded = load_bake(request.getfixturevalue(f"{name}_file"))
    assert loaded.isovalues == bake.isovalues and loaded.scene.exposure == bake.scene.exposure
    assert loaded.statistics == bake.statistics
    assert [mesh.name for mesh in loaded.scene.meshes] == [m.name for m in bake.scene.meshes]
    assert_same_light(bake, loaded)
    for ours, theirs in zip(bake.volumes, loaded.volumes, strict=True):
        assert ours.name == theirs.name
        np.testing.assert_array_equal(ours.values, theirs.values)
    for volume, (mine, theirs) in enumerate(zip(bake.grids, loaded.grids, strict=True)):
        np.testing.assert_array_equal(mine.mask(), theirs.mask())
        for point in range(len(mine.direct.lights) if mine.direct else 0):
            np.testing.assert_array_equal(*(g.direct.codes(point) for g in (mine, theirs)))
        surfaces = [one.surface(isovalue, volume, mine.has_back) for one in (bake, loaded)]
        np.testing.assert_array_equal(*(surface.radiance for surface in surfaces))
    for mesh in range(bake.walls.count if bake.walls else 0):
        for mine, theirs in zip(bake.walls.mesh(mesh), loaded.walls.mesh(mesh), strict=True):
            np.testing.assert_array_equal(mine, theirs)
    assert saved_alike(loaded, tmp_path / "again.vdb") == saved_alike(bake, tmp_path / "once.vdb")


@pytest.mark.parametrize("has_id", [False, True])
def test_a_bake_without_provenance_is_of_an_earlier_version(box_bake, tmp_path, has_id):
    path = tmp_path / "old.vdb"
    fields = [volume.field() for volume in box_bake.volumes]
    metadata = {"statistics": json.dumps(box_bake.statistics.record())}
    metadata |= {"id": box_bake.id} if has_id else {}
    _core.write_bake(str(path), fields, box_bake.grids, None, metadata)
    refused("old.vdb: .*an earlier version of Leaflight; bake", load_bake, path)
    refused("not an OpenVDB file", read_bake_id, written(path, "This is no bake."))


@pytest.mark.parametrize(
    "resolution, texels", [(None, (33, 45, 57)), (10, (6, 8, 10)), ((4, 5, 6), (4, 5, 6))]
)
def test_resolution(resolution, texels):
    z, y, x = np.mgrid[0:15, 0:12, 0:9]
    values = (x + y + z).astype(np.float32)
    volume = leaflight.Volume(values, np.eye(4), "ramp")
    baked = leaflight.bake(volume, resolution=resolution, isovalues=(10.0, 20.0), error=20.0)
    assert tuple(baked.grid.resolution) == texels


def test_surface(box_bake):
    surface = box_bake.surface(47.0)
    count = len(surface.vertices)
    assert count > 100 and len(surface.triangles) > 100
    assert surface.vertices.shape == surface.normals.shape == surface.radiance.shape == (count, 3)
    assert surface.triangles.min() == 0 and surface.triangles.max() == count - 1
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1, atol=1e-3)
    heights = box_bake.volume.field().sample(surface.vertices)
    np.testing.assert_allclose(heights, 47, atol=0.05)
    assert (surface.radiance >= 0).all() and surface.radiance.mean() > 0.01
    # The field increases towards y = 1, and the outside has lower values.
    assert surface.normals[:, 1].mean() < -0.2


@pytest.mark.parametrize("isovalue", [29.0, 71.0, float("nan"), float("inf")])
def test_isovalue_outside_the_range(box_bake, isovalue):
    refused(r"30\.\.70", box_bake.surface, isovalue)
    refused(r"30\.\.70", box_bake.reference, np.zeros((1, 3)), isovalue)


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        ({"isovalues": (70, 30)}, "empty"),
        ({"isovalues": (50, 50)}, "empty"),
        ({"isovalues": (float("nan"), 50)}, "empty"),
        ({"isovalues": (300, 400)}, "outside the data"),
        ({"isovalues": (-20, -10)}, "outside the data"),
        ({"isovalues": (1, 2, 3)}, "two numbers"),
        ({"seed": -1}, "seed"),
        ({"seed": 2.5}, "seed"),
        ({"threads": -2}, "threads"),
        ({"resolution": 0}, "resolution"),
        ({"resolution": (8, 8)}, "resolution"),
        ({"resolution": 40_000}, "."),
    ],
)
def test_bad_settings(bump_scene, small, arguments, sentence):
    refused(sentence, leaflight.bake, leaflight.bump_box(8), bump_scene, **{**small, **arguments})


@pytest.fixture
def endless(bump_scene):
    """Yields (Progress, thread, its exception) of a bake in progress that would take minutes."""
    progress, outcome = Progress(), []
    settings = {"error": 0.01, "resolution": 200, "progress": progress}

    def work():
        try:
            leaflight.bake(leaflight.bump_box(100), bump_scene, **settings)
        except Cancelled as error:
            outcome.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        assert wait_for(lambda: progress.fraction > 0, thread.is_alive)
        yield progress, thread, outcome
    finally:
        progress.cancel()
        thread.join()


def test_progress_and_cancel(endless):
    progress, thread, outcome = endless
    fractions = []

    def rises():
        fractions.append(progress.fraction)
        return len(set(fractions)) > 2

    assert wait_for(rises, thread.is_alive)
    assert all(0 < f < 1 for f in fractions) and fractions == sorted(fractions)
    assert progress.stage
    assert not progress.cancelled
    progress.cancel()
    thread.join(HANG)
    assert len(outcome) == 1 and progress.cancelled


@pytest.mark.machine
def test_a_cancelled_bake_ends_soon(endless):
    progress, thread, outcome = endless
    progress.cancel()
    start = time.monotonic()
    thread.join(HANG)
    # The documented limit is 0.5 s; allow more for a busy machine.
    assert time.monotonic() - start < 5
    assert len(outcome) == 1


def test_load_refuses_what_is_no_bake(tmp_path, box_file):
    refused("no such file", load_bake, tmp_path / "nowhere.vdb")
    refused("text.vdb", load_bake, written(tmp_path / "text.vdb", "This is no bake. " * 100))
    data = box_file.read_bytes()
    for share in (0.01, 0.3, 0.7, 0.99):
        refused("cut.vdb", load_bake, written(tmp_path / "cut.vdb", data[: int(share * len(data))]))


def test_save_leaves_no_file_when_it_cannot(tmp_path, box_bake):
    for path in (tmp_path / "nowhere" / "x.vdb", tmp_path / "x.txt", tmp_path):
        refused(".", box_bake.save, path)
    assert list(tmp_path.iterdir()) == []


(_CLASS,) = (
    node
    for node in ast.parse(inspect.getsource(leaflight.Bake)).body
    if isinstance(node, ast.ClassDef)
)
(_BLOCK,) = (node for node in _CLASS.body if isinstance(node, ast.If))
DECLARED = {node.name: node.args for node in _BLOCK.body if isinstance(node, ast.FunctionDef)}


def test_all_are_declared():
    assert set(DECLARED) == {"moved", "export_page", "show", "still", "to_xarray", "widget"}


@pytest.mark.parametrize("name", DECLARED)
def test_declarations_are_those_of_the_functions(name):
    declared, real = DECLARED[name], inspect.signature(getattr(leaflight.Bake, name)).parameters
    names = [one.arg for one in (*declared.args, *declared.kwonlyargs)]
    names += [declared.kwarg.arg] if declared.kwarg else []
    assert names[1:] == list(real)[1:]
    defaults = [*declared.defaults, *filter(None, declared.kw_defaults)]
    assert [ast.literal_eval(one) for one in defaults] == [
        one.default for one in real.values() if one.default is not one.empty
    ]
