# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels that are packed with ours: from PyPI, and for the process that reads files.

The packages of that process are in separate folders beside the package leaflight, on no import
path. So Blender's process never loads their libraries, which would clash with its own. Other
add-ons may have other versions.
"""

import shutil
import zipfile

from . import wheels
from .tools import ROOT, VENV, digest, run, version

SHARED = ROOT / "scripts" / "reader-wheels.txt"
PROCESS = ROOT / "scripts" / "reader-process.txt"
PLATFORM = "manylinux_2_28_x86_64"
# Blender's names of platforms, and the tags of the wheels that run there.
PLATFORMS = {
    "linux-x64": (PLATFORM, PLATFORM.replace("_2_28", "_2_27"), "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_11_0_arm64",),
    "macos-x64": ("macosx_11_0_x86_64",),
}
# Packages that PyPI lacks for a platform or a Python. Without FLIP the program reports an error.
WITHOUT = {"macos-x64": ("flip-evaluator",), "cp314": ("flip-evaluator",)}
# The folders (python/leaflight/io/reader_process.py): for one Python, and for all.
ONE, ALL = "leaflight_readers", "leaflight_codecs"
METADATA = """Metadata-Version: 2.1
Name: {name}
Version: {version}
Summary: Packages for the process by which Leaflight reads files: {packages}

Unmodified, each with its own metadata and licenses.
"""
WHEEL = """Wheel-Version: 1.0
Generator: scripts/package
Root-Is-Purelib: false
Tag: {tag}
"""


def reader_wheels(tags, platform="linux-x64"):
    """Returns the wheels of all readers' packages for some Pythons ("cp311")."""
    return [*_fetched(SHARED, tags, platform), *_of_process(tags, platform)]


def _fetched(listing, tags, platform):
    """Returns the packages of a list, unmodified from PyPI, fetched once."""
    folder = wheels.WORK / listing.stem / platform
    stamp = folder / "stamp"
    wanted = f"{digest(listing)} {' '.join(sorted(tags))}"
    if not stamp.exists() or stamp.read_text() != wanted:
        shutil.rmtree(folder, ignore_errors=True)
        lines = [line for line in listing.read_text().splitlines() if not line.startswith("#")]
        for tag in tags:
            without = (*WITHOUT.get(platform, ()), *WITHOUT.get(tag, ()))
            packages = [line for line in lines if line.partition("==")[0] not in without]
            python = f"{tag[2]}.{tag[3:]}"
            run(
                *(VENV / "bin" / "python", "-m", "pip", "download", "--no-deps", "--quiet"),
                *("--only-binary=:all:", "--implementation", "cp", "--python-version", python),
                *(f"--platform={tag}" for tag in PLATFORMS[platform]),
                *("--dest", folder, *packages),
            )
        stamp.write_text(wanted)
    return sorted(folder.glob("*.whl"))


def _of_process(tags, platform):
    """Returns one wheel for each Python and one for all Pythons; no file is in two wheels."""
    found = _fetched(PROCESS, tags, platform)
    folder = wheels.WORK / "reader-process-packed" / platform
    stamp = folder / "stamp"
    wanted = digest(*found, __file__) + version()
    if not stamp.exists() or stamp.read_text() != wanted:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for tag in tags:
            tagged = [path for path in found if path.name.split("-")[3] == tag]
            _packed(ONE, f"{tag}-{tag}-{PLATFORMS[platform][0]}", tagged, folder)
        others = [path for path in found if path.name.split("-")[3] not in tags]
        _packed(ALL, f"py3-none-{PLATFORMS[platform][0]}", others, folder)
        stamp.write_text(wanted)
    return sorted(folder.glob("*.whl"))


def _packed(name, tag, contents, out):
    """Returns a wheel with the unpacked contents of others in a folder of this name."""
    folder = out / f"{name}-{version()}"
    for path in contents:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder / name)
    info = folder / f"{folder.name}.dist-info"
    info.mkdir()
    packages = ", ".join(" ".join(path.name.split("-")[:2]) for path in contents)
    about = METADATA.format(name=name, version=version(), packages=packages)
    (info / "METADATA").write_text(about)
    (info / "WHEEL").write_text(WHEEL.format(tag=tag))
    wheels.pack(folder, out)
    shutil.rmtree(folder)
