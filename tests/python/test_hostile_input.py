# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests malicious input: it is refused with one sentence, before any work."""

import bz2
import gzip
import json
import os
import subprocess
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight import LeaflightError, Volume, load_bake, read_volume
from outcomes import reads, refused, written
from same_bytes import saved_alike

SHARED = Path(__file__).resolve().parents[3] / "shared"
BAD_INPUTS = Path(os.environ.get("LEAFLIGHT_BAD_INPUTS", SHARED / "bad-inputs"))
NRRD = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 7 6\nencoding: raw\n"
DATA = np.random.default_rng(2).integers(0, 255, 8 * 7 * 6).astype(np.uint8).tobytes()


def test_nrrd_headers_that_no_one_closes(tmp_path):
    path = tmp_path / "x.nrrd"
    path.write_bytes(NRRD.replace("\n", "\n# " + "x" * 5000 + "\n").encode() + b"\n" + DATA)
    assert read_volume(path).values.shape == (6, 7, 8)
    for text in (
        NRRD.replace("raw", "raw" + "x" * 5000),
        NRRD.replace("8 7 6", "8 7 6 " * 1000),
        NRRD.replace("8 7 6", "8 7 " + "9" * 5000),
        NRRD + "space directions: " + "(1,0,0) " * 5000 + "\n",
        "NRRD0004" + "x" * 5000,
    ):
        path.write_bytes(text.encode() + b"\n" + DATA)
        assert len(refused(".", read_volume, path)) < 500
    # Without a blank line, the values would be read as part of the header.
    refused("does not end", read_volume, written(path, NRRD.encode() + b"x" * 4000))


@pytest.mark.parametrize(
    "more",
    [
        "data file: ../secret.raw\n",
        "# comment\n" * 1200 + "data file: ../secret.raw\n",
        "data file:=inside.raw\ndata file: ../secret.raw\n",
        "datafile: /etc/hostname\n",
        "data file: link.raw\n",
        "data file: inside.raw\ndata file: ../secret.raw\n",
    ],
)
def test_nrrd_data_stay_in_their_folder(tmp_path, more):
    folder = tmp_path / "scan"
    folder.mkdir()
    (tmp_path / "secret.raw").write_bytes(DATA)
    (folder / "inside.raw").write_bytes(DATA)
    (folder / "link.raw").symlink_to("../secret.raw")
    path = written(folder / "x.nhdr", NRRD + more)
    refused("outside .* folder|twice", read_volume, path)
    path.write_text(NRRD + "data file:=../secret.raw\ndata file: inside.raw\n")
    assert read_volume(path).values.tobytes() == DATA


def test_nrrd_encodings(tmp_path):
    """Checks that the actual encoding counts, and that no more bytes are unpacked than needed."""
    path = tmp_path / "x.nrrd"
    header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3000 2000 1000\nencoding:=gzip\n"
    path.write_bytes((header + "encoding: raw\n\n").encode() + bytes(82000))
    refused("holds only 82000 bytes", read_volume, path)
    values = np.frombuffer(DATA, np.uint8).reshape(6, 7, 8)
    packed = {
        "gzip": gzip.compress(DATA[:100]) + gzip.compress(DATA[100:]) + b"and more",
        "bzip2": bz2.compress(DATA + bytes(10**6)),
        "hex": DATA.hex().encode(),
        "ascii": " ".join(map(str, DATA)).encode(),
    }
    for encoding, data in packed.items():
        reads(values, written(path, NRRD.replace("raw", encoding).encode() + b"\n" + data))
        path.write_bytes(NRRD.replace("raw", encoding).encode() + b"\n" + data[:50])
        refused(".", read_volume, path)
    path.write_bytes(NRRD.encode() + b"line skip: 1\nbyte skip: 2\n\nskipped\nxx" + DATA)
    reads(values, path)
    reads(values, written(path, NRRD.encode() + b"byte skip: -1\n\nwhatever\n" + DATA))


LONG = 1 << 20
ARRAY = "\nLattice { byte Data } @1\n# Data section follows\n@1\n"
MRTRIX = "mrtrix image\ndim: 2,2,2\nvox: 1,1,1\ndatatype: Int8\nfile: x"


@pytest.mark.parametrize(
    "name, text",
    [
        ("x.nrrd", NRRD + "space directions: " + "(" * LONG + "\n\n"),
        ("x.mhd", "DimSize = 2 2 2\nElementType = MET_CHAR\nElementDataFile = %d" + " 1" * LONG),
        ("x.mif", MRTRIX + " " * LONG + "y\nEND"),
        ("x.am", "# AmiraMesh ASCII 2.0\n" + "\n" * LONG + ARRAY),
        ("x.am", "# AmiraMesh ASCII 2.0\ndefine Lattice 2 2 2\n" + "Units {" * (LONG // 8) + ARRAY),
        ("x.am", "# AmiraMesh ASCII 2.0\ndefine Lattice 2 2 2\nBoundingBox " + "1" * LONG + ARRAY),
    ],
    ids=range(6),
)
def test_long_headers_take_no_long_time(tmp_path, name, text):
    """Checks that no regular expression takes quadratic time or longer."""
    (tmp_path / name).write_text(text)
    assert len(refused(".", read_volume, tmp_path / name)) < 500


FAR = {"nan": np.nan, "infinite": np.inf, "beyond bounds": 1e19, "beyond any number": -1e308}


@pytest.mark.parametrize("far", FAR)
def test_points_are_in_bounds(box_bake, lapr_bake, far):
    points = np.full((3, 3), 0.5)
    points[1, 2] = FAR[far]
    calls = [
        lambda: box_bake.radiance(points),
        lambda: box_bake.radiance_error(points),
        lambda: box_bake.reference(points, 47.0, spp=1),
        lambda: lapr_bake.mesh_reference(0, ([0, 0, 0], np.full((3, 2), FAR[far])), 0.5),
    ]
    if abs(FAR[far]) < 1e30 or not np.isfinite(FAR[far]):
        calls.append(lambda: box_bake.radiance(points.astype(np.float32)))
    for call in calls:
        refused("1e18", call)


@pytest.mark.parametrize(
    "matrix",
    [
        np.diag([1e-308, 1, 1, 1]),
        np.diag([1e300, 1e300, 1e300, 1]),
        np.diag([1e-30, 1e-30, 1e-30, 1]),
        np.eye(4) + 1e19 * np.eye(4, k=3),
        np.diag([1e17, 1, 1, 1]),
        np.diag([np.nan, 1, 1, 1]),
        np.array([[1, 1, 0, 0], [1, 1 + 1e-14, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
    ],
)
def test_volumes_are_in_bounds(box_bake, matrix):
    volume = Volume(box_bake.volume.values, matrix, "x")
    refused("1e18|inverted", volume.field)


def test_scenes_are_in_bounds(cli, root, tmp_path):
    scene = json.loads((root / "scenes" / "bump_box.json").read_text())
    path = tmp_path / "scene.json"
    for change in (
        lambda s: s["lights"][0].update(corner=[0, 0, 4e18]),
        lambda s: s["meshes"][0]["vertices"].__setitem__(0, [0, 0, 4e18]),
        lambda s: s.update(name="\ud800"),
        lambda s: s["lights"][0].update(corner=[0, 0, 10**400]),
    ):
        bad = json.loads(json.dumps(scene))
        change(bad)
        path.write_text(json.dumps(bad))
        out = tmp_path / "x.vdb"
        cli.refuses("", "bake", "bump_box", "--dims", 8, "--scene", path, "--out", out)
        assert not out.exists()
    path.write_text("[" * 100_000)
    assert cli("bake", "bump_box", "--scene", path, "--out", tmp_path / "x.vdb").status == 2


def test_small_voxels_are_saved(small, tmp_path):
    """Checks 10 micrometers in meters, although OpenVDB accepts no cell of 1e-15."""
    box = leaflight.bump_box(12)
    small_box = Volume(box.values, np.diag([1e-5, 1e-5, 2e-5, 1.0]), "x")
    bake = leaflight.bake(small_box, **small)
    bake.save(tmp_path / "x.vdb")
    again = load_bake(tmp_path / "x.vdb")
    np.testing.assert_array_equal(again.volume.index_to_world, small_box.index_to_world)
    assert again.id == bake.id
    points = bake.surface(50.0).vertices
    np.testing.assert_allclose(again.radiance(points), bake.radiance(points), rtol=2e-3, atol=1e-5)


@pytest.fixture
def foreign(box_bake, tmp_path):
    """Returns a .vdb without our seal, as other programs write it."""
    path = tmp_path / "foreign.vdb"
    path.write_bytes(saved_alike(box_bake, path))
    return path


def test_foreign_vdb_files_cannot_end_this_process(foreign, box_bake):
    reads(box_bake.volume.values, foreign)
    good = foreign.read_bytes()
    rng = np.random.default_rng(11)
    for _ in range(6):
        bad = bytearray(good)
        for place in rng.integers(400, len(bad), 8):
            bad[place] = rng.choice([0, 1, 127, 128, 255])
        foreign.write_bytes(bad)
        for read in (read_volume, load_bake):
            try:
                read(foreign)
            except LeaflightError as error:
                assert str(foreign) in str(error) and "\n" not in str(error)


@pytest.mark.skipif(not BAD_INPUTS.is_dir(), reason="the files that broke it are not here")
@pytest.mark.parametrize("name", ["own_segv_lookup", "openvdb_segv_destructor"])
def test_vdb_files_that_ended_it(script, tmp_path, name):
    path = tmp_path / f"{name}.vdb"
    path.write_bytes(gzip.decompress((BAD_INPUTS / f"{name}.vdb.gz").read_bytes()))
    outcome = script("surface", path, "--isovalue", "47", "--out", tmp_path / "x.ply")
    assert outcome.status == 2 and outcome.err.count("\n") == 1
    assert not (tmp_path / "x.ply").exists()


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        (["--seed", "4294967296"], "32 bits"),
        (["--seed", "9" * 5000], "whole number"),
        (["--threads", "-9999999999"], "32 bits"),
        (["--resolution", "1e3"], "whole number"),
        (["--error", "nan"], "finite"),
        (["--time", "inf"], "finite"),
    ],
)
def test_numbers_of_options(cli, tmp_path, arguments, sentence):
    out = tmp_path / "x.vdb"
    said = cli.refuses(sentence, "bake", "bump_box", "--dims", 8, "--out", out, *arguments)
    assert len(said) < 300


@pytest.mark.parametrize("name", ["x" * 300 + ".vdb", "\udcff\udcfe.vdb", "\ud800.vdb", "a\0.vdb"])
def test_names_of_files(cli, tmp_path, name):
    """Checks that invalid file names are refused at once, and that all others are written."""
    out = tmp_path / name
    arguments = ["--error", "50", "--json"]
    outcome = cli("bake", "bump_box", "--dims", 8, "--out", out, *arguments)
    if outcome.status == 0:
        assert "\udcff" in name
        assert json.loads(outcome.out.splitlines()[-1])["out"] == str(out)
        assert len(load_bake(out).id) == 32
        assert cli("info", out).status == 0
        assert cli("surface", out, "--isovalue", "100", "--out", f"{out}.ply").status == 0
    else:
        assert outcome.status == 2 and outcome.err.count("\n") == 1
    assert cli("info", tmp_path / ("y" + name)).status == 2
    assert cli("surface", f"y{name}", "--isovalue", "1", "--out", tmp_path / "x.ply").status == 2


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "> /dev/full", "| true"])
def test_nobody_listens(root, tmp_path, closed):
    """Checks that the bake is saved although the reader of the output has gone."""
    out = tmp_path / "x.vdb"
    bake = f"{root}/scripts/leaflight bake bump_box --dims 8 --error 50 --json"
    done = subprocess.run(
        ["bash", "-c", f"{bake} --out {out} {closed}; exit ${{PIPESTATUS[0]}}"],
        capture_output=True,
        text=True,
    )
    assert load_bake(out) and "Traceback" not in done.stderr and "ignored" not in done.stderr
    lines = [line for line in done.stderr.splitlines() if not line.startswith("bake: ")]
    assert done.returncode in (0, 2) and len(lines) == (done.returncode == 2)


def test_info_prints_json(cli, tmp_path):
    np.save(tmp_path / "x.npy", np.arange(27.0).reshape(3, 3, 3))
    outcome = cli("info", tmp_path / "x.npy", "--spacing", "1e17", "--json")

    def refuse(constant):
        raise AssertionError(constant)

    assert outcome.status == 0
    json.loads(outcome.out.splitlines()[-1], parse_constant=refuse)


@pytest.mark.slow
@pytest.mark.parametrize("limit", [300_000, 500_000, 700_000, 1_000_000, 1_300_000, 1_800_000])
def test_little_memory(root, tmp_path, limit):
    """Checks that a memory limit ends in one sentence without a traceback."""
    # Test the finest texels on a machine with little memory, too.
    bake = f"{root}/scripts/leaflight bake bump_box --dims 200 --out {tmp_path}/x.vdb"
    done = subprocess.run(
        ["bash", "-c", f"ulimit -v {limit}; {bake} --memory 64GiB"],
        capture_output=True,
        text=True,
        # The program needs more memory with more threads, so use one.
        preexec_fn=lambda: os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2]),
    )
    lines = [line for line in done.stderr.splitlines() if not line.startswith("bake: ")]
    assert done.returncode == 2 and len(lines) == 1, done.stderr
    if limit < 1 << 20:
        assert lines[0].endswith("raise the limit (ulimit -v).")
    else:
        assert "There is not enough memory" in lines[0]
    # A slow machine may have reached a checkpoint, which the first line then mentions.
    resumable = "--resume" in lines[0]
    assert os.listdir(tmp_path) == (["x.vdb.checkpoint"] if resumable else [])
