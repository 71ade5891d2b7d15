# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the contents of the packages for Windows, and the libraries that the module loads."""

import re
import subprocess
import tomllib
import zipfile

import pytest

# Libraries that every Windows has. The module also loads Python's library.
SYSTEM = {
    "kernel32.dll",
    "msvcrt.dll",
    "advapi32.dll",
    "user32.dll",
    "shell32.dll",
}


@pytest.fixture(scope="module")
def wheel(made, python_version):
    return made[0][python_version]


@pytest.fixture(scope="module")
def module(tag):
    return f"leaflight/_core.{tag}-win_amd64.pyd"


@pytest.fixture(scope="module")
def listed(wheel, module, tmp_path_factory):
    """Returns the headers of the module, by binutils."""
    folder = tmp_path_factory.mktemp("module")
    with zipfile.ZipFile(wheel) as archive:
        path = archive.extract(module, folder)
    command = ("x86_64-w64-mingw32-objdump", "--private-headers", path)
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def test_the_name_tells_the_python_and_the_system(wheel, tag):
    assert re.fullmatch(rf"leaflight-[\d.]+-{tag}-{tag}-win_amd64\.whl", wheel.name)
    with zipfile.ZipFile(wheel) as archive:
        (tags,) = (n for n in archive.namelist() if n.endswith(".dist-info/WHEEL"))
        assert re.findall("^Tag: (.*)$", archive.read(tags).decode(), re.M) == [
            f"{tag}-{tag}-win_amd64"
        ]


def test_the_module_takes_libraries_of_the_system_alone(listed, tag):
    """Checks that it needs no other library, because another program's library of the same name
    could replace it.
    """
    taken = {name.lower() for name in re.findall(r"DLL Name: (\S+)", listed)}
    own = f"python{tag[2:]}.dll"
    assert {"kernel32.dll", own} <= taken <= {*SYSTEM, own}


def test_the_module_exports_its_entry(listed):
    """Checks the exports: the module's entry, and oneTBB's functions, which Windows resolves only
    on request.
    """
    table = listed.partition("[Ordinal/Name Pointer] Table")[2].partition("\n\n")[0]
    exported = re.findall(r"\[\s*\d+\].*?(\w+)$", table, re.M)
    others = [name for name in exported if not re.match(r"TBB_|_Z\w*3tbb6detail", name)]
    assert others == ["PyInit__core"]


def test_the_wheel_holds_the_package(wheel, module, root):
    with zipfile.ZipFile(wheel) as archive:
        found = archive.namelist()
    sources = root / "python" / "leaflight"
    for source in sources.rglob("*.py"):
        assert f"leaflight/{source.relative_to(sources).as_posix()}" in found
    assert {"leaflight/page/page.html", "leaflight/scenes/cornell.json", module} <= set(found)
    assert not [name for name in found if name.endswith(".so") or "__pycache__" in name]
    licences = [name for name in found if "/licenses/" in name]
    for package in ("LICENSE", "libtbb", "libembree", "libopenvdb", "libblosc", "gcc-mingw-w64"):
        assert any(f"/licenses/{package}" in name for name in licences)


def test_the_extension_is_for_windows(made):
    with zipfile.ZipFile(made[1]) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        shipped = [name for name in archive.namelist() if name.endswith(".whl")]
        for wheel in made[0].values():
            assert archive.read(f"wheels/{wheel.name}") == wheel.read_bytes()
    assert manifest["platforms"] == ["windows-x64"]
    assert sorted(manifest["wheels"]) == sorted(f"./{name}" for name in shipped)
    assert all(name.endswith(("-win_amd64.whl", "-any.whl")) for name in shipped)
