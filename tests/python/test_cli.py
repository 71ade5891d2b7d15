# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the command line as scripts use it: JSON on the last line, exit statuses, Ctrl-C."""

import json
import os
import select
import signal
import subprocess
import sys

import leaflight
import meshio
import numpy as np
import pytest
from leaflight import _core
from leaflight.io.readers import raw
from leaflight.io.sources import GENERATED
from leaflight_command import parser, shared_options
from PIL import Image
from waiting import HANG, package_folder, run_python, started

FLAT = ["--out", "OUT/x.exr", "--error", "50"]
BAKE = ["--isovalues", "30", "70", "--error", "5", "--resolution", "20"]


def last_json(outcome):
    assert outcome.status == 0, outcome.err
    return json.loads(outcome.out.splitlines()[-1])


def test_help_of_bake_fits_a_screen(script):
    """Checks that it fits a terminal of 24 lines and 80 columns; --help-all prints the rest."""
    short = script("bake", "--help").out.splitlines()
    assert len(short) <= 24 and max(map(len, short)) <= 80
    for option in ("--out", "--error", "--time", "--estimate", "--resolution", "--both-sides"):
        assert f"  {option} " in "\n".join(short)
    whole = script("bake", "--help-all").out
    assert "files:\n" in whole and "machines:\n" in whole
    for option in ("--dims", "--threads", "--scheduler", "--seed", "--memory"):
        assert f"  {option} " in whole and option not in "\n".join(short)
    assert "--help-all" not in script("surface", "--help").out
    assert "a picture of a lit isosurface" in script("--help").out


def test_passes_that_were_left_out_are_reported_on_demand(cli, tmp_path):
    bake = ["bake", "bump_box", "--dims", 12, "--out", tmp_path / "box.vdb", *BAKE]
    assert "skipped:" not in cli.runs(*bake)
    assert "skipped: radiance of the walls (it was not asked for)" in cli.runs(*bake, "--verbose")


def test_info(script):
    info = last_json(script("info", "bump_box", "--dims", "20", "--json"))
    assert info["dims"] == [20, 20, 20] and info["masked"] is False
    assert info["range"] == pytest.approx([0, 255], abs=1e-3)
    assert info["spacing"] == pytest.approx([1 / 19] * 3)
    lo, hi = info["isovalues"]
    assert lo < info["isovalue"] < hi


def test_info_of_colin27(cli, colin27):
    info = cli.json("info", colin27)
    assert info["dims"] == [181, 217, 181] and info["range"] == [0, 254]
    assert info["bounds"] == [[-90, -125, -71], [90, 91, 109]]


def test_pipeline(script, root, tmp_path):
    """Runs bake, surface and compare, each in a separate process."""
    bake, mesh = tmp_path / "box.vdb", tmp_path / "box.ply"
    scene = root / "scenes" / "bump_box.json"
    arguments = ["bump_box", "--dims", "20", "--out", bake, "--scene", scene, *BAKE]
    baked = last_json(script("bake", *arguments, "--seed", "3", "--threads", "1", "--json"))
    for key in ("seconds", "rays", "rays_per_second", "texels", "peak_memory_bytes"):
        assert baked[key] > 0
    assert isinstance(baked["skipped_passes"], list)
    assert baked["isovalues"] == [30, 70] and baked["resolution"] == [20, 20, 20]

    surface = last_json(script("surface", bake, "--isovalue", "47", "--out", mesh, "--json"))
    assert surface["triangles"] == len(meshio.read(mesh).cells_dict["triangle"])
    assert 0 < surface["seconds"]

    options = "--isovalue 47 --points 50 --spp 16 --json".split()
    comparison = last_json(script("compare", bake, *options))
    for key in ("rms_percent", "relative_rms", "bake_seconds", "reference_seconds"):
        assert comparison[key] > 0
    assert comparison["bake_seconds"] == pytest.approx(baked["seconds"])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["box.ply", "box.vdb"]


@pytest.mark.machine
def test_a_surface_is_soon_there(script, box_file, tmp_path):
    mesh = tmp_path / "box.ply"
    surface = last_json(script("surface", box_file, "--isovalue", "47", "--out", mesh, "--json"))
    assert 0 < surface["seconds"] < 5


def test_pipeline_of_several_volumes(cli, root, tmp_path):
    """The volumes come from the scene file; each shows its own isovalue at a common isovalue."""
    bake, mesh = tmp_path / "lapr.vdb", tmp_path / "water.ply"
    scene = root / "scenes" / "lapr.json"
    options = "--dims 16 --both-sides --walls --error 20 --capped --json".split()
    printed = cli.runs("bake", "--scene", scene, "--out", bake, *options)
    baked = json.loads(printed.splitlines()[-1])
    assert baked["isovalues"] == [0, 1]
    assert baked["volumes"] == [
        {"name": "dirt", "isovalues": [50, 200]},
        {"name": "water", "isovalues": [30, 150]},
    ]
    assert "--isovalue 0..1 shows volume 1 (water) at 30..150" in printed
    for side in ([], ["--back"]):
        options = ["--isovalue", "0.25", "--volume", "1", "--out", mesh, *side]
        assert "0.25 (60 of water)" in cli.runs("surface", bake, *options)
    options = "--isovalue 0.25 --volume 0 --points 20 --spp 4 --back".split()
    printed = cli.runs("compare", bake, *options)
    assert "0.25 (87.5 of dirt), all points" in printed and "seen from outside" not in printed


def test_volumes_on_the_command_line_win(cli, root, tmp_path):
    scene, out = root / "scenes" / "lapr.json", tmp_path / "two.vdb"
    options = "--dims 8 --error 50 --isovalues 0.2 0.8".split()
    result = cli.json("bake", "bump_box", "bump_box", "--scene", scene, "--out", out, *options)
    assert result["isovalues"] == [0.2, 0.8] and len(result["volumes"]) == 2


def test_flatland(script, tmp_path):
    out = tmp_path / "texture.exr"
    options = "--dims 40 --isolines 10 50 100 --error 10 --resolution 40 --json".split()
    result = last_json(script("flatland", "bump_box", "--out", out, *options))
    assert result["resolution"] == [40, 40] and result["isolines"] == [10, 50, 100]
    texture = _core.read_exr(str(out))
    # The top row comes first, and the lamp is at the bottom.
    assert texture[-10:].mean() > 2 * texture[:10].mean() > 0
    with Image.open(tmp_path / "texture.png") as picture:
        assert picture.mode == "RGB" and max(picture.size) == 1000
    image = tmp_path / "image.png"
    Image.fromarray(np.add.outer(np.arange(9), np.arange(12)).astype(np.uint8)).save(image)
    outcome = script("flatland", image, "--out", tmp_path / "image.exr", "--error", "10")
    assert outcome.status == 2 and "overwrite" in outcome.err
    outcome = script("flatland", image, "--out", tmp_path / "other.exr", "--error", "10")
    assert outcome.status == 0 and "45 x 33 texels" in outcome.out


def test_defaults_bake_a_cornell_box(cli, tmp_path):
    out = tmp_path / "box.vdb"
    result = cli.json("bake", "bump_box", "--dims", 8, "--out", out)
    assert result["scene"] == "Cornell box" and out.exists()


def test_plain_text(cli, box_file, tmp_path):
    for arguments in (
        ["info", "bump_box", "--dims", 9],
        # An isovalue is chosen if none is given.
        ["surface", box_file, "--out", tmp_path / "x.ply"],
        ["compare", box_file, "--points", 20, "--spp", 4],
    ):
        printed = cli.runs(*arguments)
        assert printed.strip() and "{" not in printed


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        ([], "COMMAND"),
        (["info"], "VOLUME"),
        (["paint", "bump_box"], "paint"),
        (["info", "bump_box", "--dims", "1"], "--dims"),
        (["info", "bump_box", "--dims", "8", "8"], "--dims"),
        (["info", "bump_box", "--frame", "1"], "--frame"),
        (["bake", "bump_box"], "--out"),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--isovalues", "9", "3"], "empty"),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--isovalues", "900", "901"], "outside"),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--samples", "4"], "--samples"),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--error", "0"], "(--error)."),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--estimate"], "--estimate"),
        (["bake", "bump_box", "--out", "OUT/x.vdb", "--scene", "OUT/no.json"], "no.json"),
        (["bake", "bump_box", "--out", "OUT/x.txt"], "must end in .vdb"),
        (["bake", "bump_box", "--out", "OUT/no/x.vdb"], "folder"),
        (["bake", "bump_box", "--out", "/dev/null/x.vdb"], "folder"),
        (["surface", "OUT/no.vdb", "--isovalue", "47", "--out", "OUT/x.ply"], "no such file"),
        (["surface", "BAKE", "--isovalue", "47", "--out", "OUT/x.obj"], "must end in .ply"),
        (["surface", "BAKE", "--isovalue", "7", "--out", "OUT/x.ply"], "range"),
        (["surface", "BAKE", "--isovalue", "nan", "--out", "OUT/x.ply"], "finite"),
        (["compare", "BAKE", "--isovalue", "700"], "range"),
        (["compare", "BAKE", "--isovalue", "47", "--points", "0"], "point"),
        (["compare", "BAKE", "--isovalue", "47", "--volume", "1"], "no volume 1"),
        (["surface", "BAKE", "--isovalue", "47", "--back", "--out", "OUT/x.ply"], "--both-sides"),
        (["bake", "--out", "OUT/x.vdb"], "name a VOLUME"),
        (["bake", "lapr:2", "--out", "OUT/x.vdb"], "no such file"),
        (["flatland", "bump_box"], "--out"),
        (["flatland", "bump_box", "--out", "OUT/x.png"], "must end in .exr"),
        (["flatland", "bump_box", "--dims", "1", "--out", "OUT/x.exr"], "at least 2 (--dims)."),
        (["flatland", "OUT/no.png", "--out", "OUT/x.exr"], "no such image"),
        (["flatland", "OUT/no.png", "--dims", "8", "--out", "OUT/x.exr"], "--dims"),
        (["flatland", "bump_box", "--dims", "8", "--isolines", "900", *FLAT], "range"),
    ],
)
def test_errors(cli, tmp_path, box_file, arguments, sentence):
    places = {"OUT": str(tmp_path), "BAKE": str(box_file)}
    for name, place in places.items():
        arguments = [argument.replace(name, place) for argument in arguments]
    outcome = cli(*arguments)
    assert outcome.status == 2 and outcome.out == "" and sentence in outcome.err
    assert outcome.err.startswith("leaflight: ") and outcome.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["surface BAKE", "photons bump_box --dims 9"])
def test_a_missing_library_of_ply_is_named(cli, tmp_path, box_file, monkeypatch, command):
    monkeypatch.setitem(sys.modules, "meshio", None)
    out = tmp_path / "x.ply"
    arguments = command.replace("BAKE", str(box_file)).split()
    cli.refuses("needs the Python package meshio", *arguments, "--out", out)
    assert not out.exists()


def test_exit_status_of_the_process(script):
    outcome = script("info", "nowhere.nii")
    assert outcome.status == 2 and outcome.err.count("\n") == 1


def test_output_never_replaces_the_input(cli, box_file):
    before = box_file.read_bytes()
    cli.refuses("overwrite", "bake", box_file, "--out", box_file)
    assert box_file.read_bytes() == before


def said_on(terminal, until=None):
    """Returns the output of a program in a terminal, up to some words or to its end."""
    said, part = b"", None
    while part != b"" and (until is None or until not in said):
        assert select.select([terminal], [], [], HANG)[0], "it hangs"
        try:
            part = os.read(terminal, 4096)
        except OSError:
            part = b""  # end of a terminal on Linux
        said += part
    return said


def test_ctrl_c_leaves_no_file(root, tmp_path):
    command = [root / "scripts" / "leaflight", "bake", "bump_box", "--out", tmp_path / "x.vdb"]
    terminal, of_program = os.openpty()
    with started(
        # This bake would take minutes.
        [*command, "--error", "0.01", "--resolution", "200"],
        stdout=subprocess.PIPE,
        stderr=of_program,
        text=True,
        # Shells ignore SIGINT for background jobs, and children inherit that, so restore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as process:
        os.close(of_program)
        assert b"bake [" in said_on(terminal, until=b"bake [")
        process.send_signal(signal.SIGINT)
        err = said_on(terminal)
        out, _ = process.communicate(timeout=HANG)
    os.close(terminal)
    assert process.returncode == 130
    assert out == "" and b"cancelled" in err and b"Traceback" not in err
    assert list(tmp_path.iterdir()) == []


def test_bake_goes_on_until_its_error(cli, tmp_path):
    out = tmp_path / "box.vdb"
    arguments = ["bake", "bump_box", "--dims", "10", "--isovalues", "30", "70", "--out", out]
    printed = cli.runs(*arguments, "--error", "4", "--json")
    result = json.loads(printed.splitlines()[-1])
    error, passes = result["estimated_error_percent"], result["passes"]
    assert passes >= 1 and 0 < error <= 4 and result["stopped"] is False
    for words in (f"estimated error {error:.2f} %", f" after {passes} pass", "(target 4 %)"):
        assert words in printed
    printed = cli.runs(*arguments, "--error", "0.001", "--time", "1e-9")
    assert "(target 0.001 %)" in printed and "would not end within 1e-09 s" in printed


def test_estimate_writes_nothing(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = cli.runs("bake", "bump_box", "--dims", "10", "--estimate", "--error", "3", "--json")
    cost = json.loads(printed.splitlines()[-1])
    assert cost["seconds"] > 0 and cost["memory_bytes"] > 2**20 and cost["error"] <= 3
    assert f"about {cost['seconds']:.0f} s and " in printed
    assert list(tmp_path.iterdir()) == []


# Program that compares the processor time of main() with that of an empty interpreter.
MEASURE = """
import sys, time
sys.path.insert(0, sys.argv.pop(1))
empty = time.process_time()
import leaflight_command
try:
    leaflight_command.main()
except SystemExit:
    pass
print(empty, time.process_time(), "leaflight" in sys.modules, "numpy" in sys.modules)
"""


def measured(*arguments):
    """Returns (seconds of an empty interpreter, of the program, True if it loaded modules)."""
    done = run_python("-c", MEASURE, package_folder(), *arguments, check=True)
    empty, whole, *loaded = done.stdout.splitlines()[-1].split()
    return float(empty), float(whole), "True" in loaded


HELP = pytest.mark.parametrize("arguments", [["--help"], ["bake", "--help"], ["bake", "--no-such"]])


@HELP
def test_help_loads_nothing_that_only_the_work_needs(arguments):
    assert not measured(*arguments)[2]


@pytest.mark.machine
@HELP
def test_help_is_soon_there(arguments):
    # Use the fastest of three runs, because other work on the machine only adds time.
    runs = [measured(*arguments) for _ in range(3)]
    empty, whole = min(empty for empty, _, _ in runs), min(whole for _, whole, _ in runs)
    # Importing NumPy and the compiled module takes ten times as long as an empty interpreter.
    assert whole < 6 * empty


def test_commands_load_what_they_need():
    """Checks that other commands do import these modules, so that the test above can fail."""
    assert measured("info", "bump_box", "--dims", "4")[2]


def test_the_parser_knows_what_the_package_knows():
    assert shared_options.TYPES == raw.TYPES and shared_options.ENDIANS == tuple(raw.ENDIANS)
    assert parser.GENERATED == GENERATED


def test_version(script):
    assert script("--version").out == f"leaflight {leaflight.__version__}\n"
