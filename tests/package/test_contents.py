# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the contents of the packages, and that they lack other files."""

import ast
import base64
import csv
import hashlib
import io
import re
import tarfile
import tomllib
import zipfile
from email import message_from_bytes
from pathlib import PurePosixPath

import pytest
from packaging.requirements import Requirement

BLENDER_PYTHONS = ("3.11", "3.13")


def names(path):
    with zipfile.ZipFile(path) as archive:
        return archive.namelist()


def parts(data):
    """Returns (name of its metadata, open archive) of a wheel, and of each wheel in its folders."""
    archive = zipfile.ZipFile(io.BytesIO(data))
    infos = {
        name.rpartition("/")[0] for name in archive.namelist() if name.endswith("-info/RECORD")
    }
    return [(info, archive) for info in sorted(infos)]


def top(name):
    return PurePosixPath(name).parts[0]


@pytest.fixture(scope="module")
def version(root):
    text = (root / "python" / "leaflight" / "version.py").read_text()
    return re.search('__version__ = "(.+)"', text)[1]


@pytest.fixture(scope="module")
def extension(made):
    """Returns the manifest of the extension, and its wheels by project."""
    with zipfile.ZipFile(made["extension"]) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        wheels = {name: archive.read(name) for name in archive.namelist() if ".whl" in name}
    assert sorted(manifest["wheels"]) == sorted(f"./{name}" for name in wheels)
    return manifest, {name.split("/")[1].split("-")[0]: data for name, data in wheels.items()}


def test_the_name_has_the_python_and_the_glibc(made, version):
    assert re.fullmatch(
        rf"leaflight-{re.escape(version)}-cp311-cp311-manylinux_2_\d\d_x86_64\.whl",
        made["wheel"].name,
    )


def test_one_version_everywhere(made, version, extension, root):
    assert extension[0]["version"] == version
    tree = ast.parse((root / "addon" / "leaflight" / "__init__.py").read_text())
    (info,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    assert ".".join(map(str, info["version"])) == version
    assert f"-{version}" in made["sdist"].name and f"-{version}-" in made["legacy"].name


def test_the_wheel_holds_the_package_and_its_libraries(made, root):
    found = names(made["wheel"])
    sources = root / "python" / "leaflight"
    for source in sources.rglob("*.py"):
        assert f"leaflight/{source.relative_to(sources).as_posix()}" in found
    for scene in (root / "scenes").iterdir():
        assert f"leaflight/scenes/{scene.name}" in found
    assert {"leaflight/page/page.html", "leaflight/py.typed", "leaflight/_core.pyi"} <= set(found)
    for library in ("tbb", "embree", "openvdb", "OpenEXR"):
        assert any(re.match(rf"leaflight\.libs/lib{library}", name) for name in found)
    # Each library must have its license.
    licences = [name for name in found if "/licenses/" in name]
    for package in ("LICENSE", "libtbb", "libembree", "libopenvdb", "libblosc"):
        assert any(f"/licenses/{package}" in name for name in licences)


def test_the_long_description_leads_out_of_pypi(made, root):
    with zipfile.ZipFile(made["wheel"]) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        metadata = message_from_bytes(archive.read(name))
    text = metadata.get_payload()
    site = tomllib.loads((root / "pyproject.toml").read_text())["project"]["urls"]["Homepage"]
    targets = re.findall(r"\]\(([^)]+)\)", text)
    assert len(targets) > 15 and all(target.startswith("https://") for target in targets)
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)
    assert pictures and all(target.startswith(f"{site}/raw/main/docs/") for target in pictures)
    for target in targets:
        path = re.sub(rf"{re.escape(site)}/(raw|blob)/main/", "", target).partition("#")[0]
        assert (root / path).exists(), target


def test_the_extension_names_what_it_bundles(made, extension, root):
    manifest, wheels = extension
    site = tomllib.loads((root / "pyproject.toml").read_text())["project"]["urls"]["Homepage"]
    assert manifest["website"] == site
    texts = {name for name in names(made["extension"]) if name.startswith("licenses/")}
    bundled = {name.rpartition("/")[2] for data in wheels.values() for name, _ in parts(data)}
    for info in bundled:
        project = info.removesuffix(".dist-info").rpartition("-")[0]
        if project in ("leaflight_readers", "leaflight_codecs"):
            continue  # folders for the packages of others
        assert any(name.startswith(f"licenses/{project}/") for name in texts), info
    listed = "\n".join(manifest["copyright"])
    for holder in ("Leaflight", "Intel", "DreamWorks", "Industrial Light", "Gohlke", "Brett"):
        assert holder in listed


@pytest.mark.parametrize("kind", ["wheel", "extension", "legacy"])
def test_no_bytecode_and_no_tests_of_ours(made, kind):
    found = names(made[kind])
    assert found and not [name for name in found if "__pycache__" in name or ".pyc" in name]
    assert not [name for name in found if name.startswith(("tests/", "leaflight/tests"))]


@pytest.mark.parametrize("kind", ["wheel", "legacy"])
def test_no_methods_of_the_thesis(made, kind):
    """Checks files, and a message of core/thesis in the compiled module."""
    with zipfile.ZipFile(made[kind]) as archive:
        found = archive.namelist()
        (module,) = (name for name in found if "leaflight/_core." in name and ".pyi" not in name)
        code = archive.read(module)
    assert not [name for name in found if "thesis" in name]
    assert b"LeaflightError" in code and b"There is no estimator named" not in code


def test_blender_gets_the_package_without_numpy(made, extension):
    assert extension[1]["leaflight"] == made["wheel"].read_bytes()
    assert "numpy" not in extension[1]
    legacy = names(made["legacy"])
    assert "modules/leaflight/bake/bake.py" in legacy
    every = [*legacy, *(name for data in extension[1].values() for name in names(io.BytesIO(data)))]
    assert not [name for name in every if "numpy" in PurePosixPath(name).parts]


def test_compiled_readers_are_beside_the_package(made, extension):
    """Checks their folders: the process that reads files finds them, but Blender and other add-ons
    do not.
    """
    folders = {
        "leaflight_readers": ("h5py", "numcodecs", "crc32c", "gemmi", "openjpeg", "libjpeg"),
        "leaflight_codecs": ("imagecodecs", "pylibjpeg", "liffile", "nd2"),
    }
    legacy = names(made["legacy"])
    for folder, packages in folders.items():
        wheel = extension[1][folder]
        own = names(io.BytesIO(wheel))
        assert all(name.startswith((f"{folder}/", f"{folder}-")) for name in own)
        for package in packages:
            assert any(name.startswith(f"{folder}/{package}/") for name in own)
            assert any(name.startswith(f"modules/{folder}/{package}/") for name in legacy)
            assert not any(name.startswith(f"modules/{package}/") for name in legacy)
        infos = [info for info, _ in parts(wheel) if "/" in info]
        assert len(infos) >= len(packages)
        for info in infos:
            terms = rf"{re.escape(info)}/(licenses/)?LICEN[CS]E"
            assert any(re.match(terms, name) for name in own), info


def test_the_legacy_zip_installs_two_things(made):
    found = names(made["legacy"])
    assert {top(name) for name in found} == {"leaflight_addon", "modules"}
    assert "leaflight_addon/__init__.py" in found and "leaflight_addon/LICENSE" in found
    for module in ("leaflight", "leaflight.libs", "nibabel", "tifffile", "PIL", "packaging"):
        assert any(name.startswith(f"modules/{module}/") for name in found), module


def test_every_record_is_right(made, extension):
    """Checks the records, which show that files of PyPI's packages are unchanged."""
    for data in [made["wheel"].read_bytes(), *extension[1].values()]:
        listed = {}
        for info, archive in parts(data):
            folder = info.rpartition("/")[0]
            rows = csv.reader(io.StringIO(archive.read(f"{info}/RECORD").decode()))
            own = {f"{folder}/{row[0]}".lstrip("/"): row[1:] for row in rows}
            for name, (digest, size) in own.items():
                if name == f"{info}/RECORD":
                    continue
                content = archive.read(name)
                algorithm, _, value = digest.partition("=")
                found = base64.urlsafe_b64encode(hashlib.new(algorithm, content).digest())
                assert found.rstrip(b"=").decode() == value and int(size) == len(content), name
            listed.update(own)
        files = [name for name in archive.namelist() if not name.endswith("/")]
        assert sorted(listed) == sorted(files)


# Dependencies that reading does not need. tests/blender/test_packed_files.py reads without them.
LEFT_OUT = {"nd2": {"dask", "ome-types", "pydantic-core", "resource-backed-dask-array"}}


def test_the_extension_holds_all_that_its_wheels_need(extension):
    """Checks the requirements for both Pythons of Blender. NumPy is Blender's own."""
    have = {}
    for data in extension[1].values():
        for info, archive in parts(data):
            metadata = message_from_bytes(archive.read(f"{info}/METADATA"))
            have[metadata["Name"].lower().replace("_", "-")] = metadata
    for python in BLENDER_PYTHONS:
        for metadata in have.values():
            for text in metadata.get_all("Requires-Dist", []):
                need = Requirement(text)
                about = {"python_version": python, "extra": ""}
                if need.name == "numpy" or (need.marker and not need.marker.evaluate(about)):
                    continue
                if need.name in LEFT_OUT.get(metadata["Name"], ()):
                    continue
                found = have[need.name.lower().replace("_", "-")]["Version"]
                assert need.specifier.contains(found), f"{metadata['Name']} needs {need}"


def test_the_sdist_has_the_sources_alone(made):
    with tarfile.open(made["sdist"]) as archive:
        members = archive.getmembers()
    found = {member.name.partition("/")[2] for member in members}
    sources = ("core/src/bake/driver/bake.cpp", "python/leaflight/bake/bake.py")
    for name in ("CMakeLists.txt", *sources):
        assert name in found
    assert {"LICENSE", "README.md", "PKG-INFO", "scenes/cornell.json"} <= found
    assert not [name for name in found if name.startswith(("build/", "addon/", "docs/", "."))]
    assert all(member.isfile() for member in members)
