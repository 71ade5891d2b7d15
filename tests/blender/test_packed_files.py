# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that Blender with only the package imports files that compiled libraries read."""

import json
import subprocess
from pathlib import Path

import microscope_files
import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
TOOLS = HERE.parents[1] / "build" / "tools-venv" / "bin" / "python"
# Packages that may be installed beside Blender, or by another add-on.
HIDDEN = ("h5py", "numcodecs", "crc32c", "imagecodecs", "pylibjpeg", "openjpeg", "libjpeg", "gdcm")
HIDDEN += ("nd2", "liffile", "dask", "ome_types")
IMPORT = """
import json, sys
from pathlib import Path
import numpy as np
hidden, folder = sys.argv[-2:]
sys.path.insert(0, hidden)
import bpy
from leaflight.io.reader_process import ReaderProcess
from leaflight_addon.store import source_files
for kind in json.loads((Path(folder) / "kinds.json").read_text()):
    path = Path(folder) / kind
    bpy.ops.leaflight.import_volume(filepath=str(path))
    obj = bpy.context.object
    assert len(obj.data.vertices) > 100, kind
    values = source_files.read(obj.leaflight).values
    right = np.load(f"{path}.npy")
    assert values.shape == right.shape, kind
    # JPEG decoders differ in rounding.
    difference = np.abs(values.astype(np.float64) - right).max()
    assert difference <= (1 if kind == "jpeg.tif" else 0), f"{kind}: {difference}"
    print("RIGHT", kind)
loaded = sorted(set(sys.modules) & set(json.loads((Path(hidden) / "names.json").read_text())))
print("LOADED", loaded)
with ReaderProcess(path, "module", "where_they_are", "places") as process:
    print("PLACES", json.dumps(process.answer()))
"""
PLACES = """
import importlib
def places(path):
    names = ("h5py", "numcodecs", "imagecodecs", "pylibjpeg", "openjpeg", "libjpeg", "nd2")
    return {name: importlib.import_module(name).__file__ for name in names}, ()
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    if not TOOLS.exists():
        pytest.skip("scripts/setup --tests has not made build/tools-venv")
    folder = tmp_path_factory.mktemp("packed")
    done = subprocess.run(
        [TOOLS, HERE / "write_packed_files.py", folder], stdout=subprocess.PIPE, check=True
    )
    kinds = json.loads(done.stdout)
    pixels = np.load(folder / f"{kinds[0]}.npy")
    microscope_files.lif(folder / "x.lif", {"a": ("ZYX", pixels)})
    microscope_files.nd2(folder / "x.nd2", "ZYXC", pixels[..., None])
    for name in ("x.lif", "x.nd2"):
        np.save(folder / f"{name}.npy", pixels)
    (folder / "kinds.json").write_text(json.dumps([*kinds, "x.lif", "x.nd2"]))
    return folder


def test_nothing_must_be_installed(blender, folder, tmp_path):
    if blender.about["windows"]:
        pytest.skip("the files lie on Linux")
    for name in HIDDEN:
        (tmp_path / f"{name}.py").write_text("raise ImportError('of another add-on')")
    (tmp_path / "where_they_are.py").write_text(PLACES)
    (tmp_path / "names.json").write_text(json.dumps(HIDDEN))
    output = blender.run(
        *("--python", HERE / "name_the_addon.py", "--python-expr", IMPORT, "--", tmp_path, folder)
    )
    kinds = json.loads((folder / "kinds.json").read_text())
    assert [line.split()[1] for line in output.splitlines() if line.startswith("RIGHT ")] == kinds
    # Blender's process has loaded none of them, and the reading process only those of the package.
    assert "LOADED []" in output
    places = next(line for line in output.splitlines() if line.startswith("PLACES "))
    for name, place in json.loads(places.removeprefix("PLACES ")).items():
        assert "/leaflight_readers/" in place or "/leaflight_codecs/" in place, (name, place)
        assert blender.environment["BLENDER_USER_RESOURCES"] in place
