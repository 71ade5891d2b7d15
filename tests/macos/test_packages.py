# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the names and the contents of the packages for macOS."""

import base64
import csv
import hashlib
import io
import re
import tomllib
import zipfile

from delocate import delocating
from packing.macos.python import BUILDS as PYTHONS


def test_the_name_tells_the_python_and_the_system(wheel):
    tag = f"{wheel.tag}-{wheel.tag}-macosx_11_0_{wheel.processor}"
    assert re.fullmatch(rf"leaflight-[\d.]+-{tag}\.whl", wheel.path.name)
    with zipfile.ZipFile(wheel.path) as archive:
        (info,) = (n for n in archive.namelist() if n.endswith(".dist-info/WHEEL"))
        text = archive.read(info).decode()
    assert re.findall("^Tag: (.*)$", text, re.M) == [tag]
    assert "Root-Is-Purelib: false" in text


def test_delocate_finds_the_name_true(wheel, tmp_path):
    """Compares, by delocate, the name of a wheel with the system and processor of its modules."""
    with zipfile.ZipFile(wheel.path) as archive:
        archive.extractall(tmp_path)
    found, _ = delocating._calculate_minimum_wheel_name(wheel.path.name, tmp_path, None)
    assert found == wheel.path.name
    modest = wheel.path.name.replace("macosx_11_0", "macosx_10_9")
    found, _ = delocating._calculate_minimum_wheel_name(modest, tmp_path, None)
    assert found == wheel.path.name


def test_the_wheel_holds_the_package(wheel, root):
    with zipfile.ZipFile(wheel.path) as archive:
        found = archive.namelist()
    sources = root / "python" / "leaflight"
    for source in sources.rglob("*.py"):
        assert f"leaflight/{source.relative_to(sources).as_posix()}" in found
    assert {"leaflight/page/page.html", "leaflight/scenes/cornell.json"} <= set(found)
    assert [name for name in found if name.endswith((".so", ".dylib", ".pyd"))] == [wheel.module]
    assert not [name for name in found if "__pycache__" in name]
    licences = [name for name in found if "/licenses/" in name]
    for package in ("LICENSE", "libtbb", "libembree", "libopenvdb", "libblosc", "libcxx"):
        assert any(f"/licenses/{package}" in name for name in licences)


def test_the_record_is_right(wheel):
    with zipfile.ZipFile(wheel.path) as archive:
        (record,) = (n for n in archive.namelist() if n.endswith(".dist-info/RECORD"))
        rows = {row[0]: row for row in csv.reader(io.StringIO(archive.read(record).decode()))}
        files = [name for name in archive.namelist() if not name.endswith("/")]
        assert sorted(rows) == sorted(files)
        for name in set(files) - {record}:
            found = base64.urlsafe_b64encode(hashlib.sha256(archive.read(name)).digest())
            assert rows[name][1] == f"sha256={found.rstrip(b'=').decode()}", name


def test_the_extension_is_for_one_platform(extension, made):
    path, platform, processor = extension
    with zipfile.ZipFile(path) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        shipped = {name: archive.read(name) for name in archive.namelist() if ".whl" in name}
    # The manifest lists all platforms; in the part that Blender's program adds, it has only this
    # one.
    assert manifest["platforms"] == ["macos-arm64", "macos-x64"]
    generated = manifest["build"]["generated"]
    assert generated["platforms"] == [platform]
    assert sorted(generated["wheels"]) == sorted(f"./{name}" for name in shipped)
    assert set(generated["wheels"]) <= set(manifest["wheels"])
    for name in shipped:
        assert re.search(rf"-(any|macosx_\d+_\d+_{processor})\.whl$", name), name
    own = [p for p in made if p.suffix == ".whl" and p.name.endswith(f"_{processor}.whl")]
    assert len(own) == len(PYTHONS)
    for wheel in own:
        assert shipped[f"wheels/{wheel.name}"] == wheel.read_bytes()


def test_the_extension_has_the_readers_for_both_pythons(extension):
    path, _, _ = extension
    with zipfile.ZipFile(path) as archive:
        shipped = [name.split("/")[1] for name in archive.namelist() if ".whl" in name]
    for python in PYTHONS:
        tags = (f"-cp{python.replace('.', '')}-", "-py3-", "-py2.py3-")
        usable = {n.split("-")[0] for n in shipped if any(tag in n for tag in tags)}
        assert {"leaflight", "nibabel", "tifffile", "pydicom", "mrcfile", "pillow"} <= usable
        assert {"leaflight_readers", "leaflight_codecs"} <= usable
