# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on as an extension for Blender 4.2 and later, and as a legacy zip for 3.4 to 4.1."""

import json
import os
import re
import shutil
import zipfile

from . import licenses, wheels
from .readers import PLATFORM, reader_wheels
from .tools import OUT, ROOT, VENV, PackageError, run, version

ADDON = ROOT / "addon" / "leaflight"
# The oldest Blender with extensions; its own program builds the extension.
BPY = "4.2.23"
# The first copyright of the manifest; those of the wheels follow.
OURS = "2026 The Leaflight authors"
# Compress quickly. Most of the zip is one library of 120 MB, and scripts/demo waits for it.
LEGACY_LEVEL = 1


def extension(built, *platforms):
    """Makes the zips for Blender 4.2 and later, one per platform, with wheels for its Pythons."""
    folder = wheels.WORK / "extension" / "-".join(platforms)
    shutil.rmtree(folder, ignore_errors=True)
    _copy_addon(folder)
    (folder / "wheels").mkdir()
    tags = sorted({path.name.split("-")[2] for path in built})
    # The wheels without compiled modules are the same for every platform.
    readers = {path.name: path for name in platforms for path in reader_wheels(tags, name)}
    shipped = [*built, *readers.values()]
    for path in shipped:
        shutil.copyfile(path, folder / "wheels" / path.name)
    manifest = folder / "blender_manifest.toml"
    listed = "".join(f'    "./wheels/{path.name}",\n' for path in shipped)
    named = ", ".join(f'"{name}"' for name in platforms)
    texts = licenses.license_texts(shipped)
    for name, content in texts.items():
        path = folder / "licenses" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    holders = "".join(f"    {json.dumps(line)},\n" for line in (OURS, *licenses.copyrights(texts)))
    manifest.write_text(
        f"{manifest.read_text()}copyright = [\n{holders}]\n"
        f"platforms = [{named}]\nwheels = [\n{listed}]\n"
    )
    # Name zips as Blender's own program does for several platforms. A zip for Linux alone has no
    # suffix.
    split = len(platforms) > 1
    suffixes = [f"-{name.replace('-', '_')}" for name in platforms]
    if not split and platforms[0] == "linux-x64":
        suffixes = [""]
    plain = OUT / f"leaflight-{version()}.zip"
    targets = [plain.with_stem(plain.stem + suffix) for suffix in suffixes]
    for old in OUT.glob("leaflight-*.zip"):
        if any(re.fullmatch(rf"leaflight-[\d.]+{suffix}\.zip", old.name) for suffix in suffixes):
            old.unlink()
    cli = blender_ext()
    python = VENV / "bin" / "python"
    run(python, cli, "validate", folder)
    output = (
        ("--split-platforms", "--output-filepath", plain)
        if split
        else ("--output-filepath", targets[0])
    )
    run(python, cli, "build", "--source-dir", folder, *output)
    for target in targets:
        run(python, cli, "validate", target)
    return targets


def blender_ext():
    """Returns Blender's own program for extensions, from its module on PyPI."""
    path = wheels.WORK / "blender_ext" / BPY / "blender_ext.py"
    if not path.exists():
        fetched = wheels.WORK / "bpy"
        try:
            run(
                *(VENV / "bin" / "python", "-m", "pip", "download", "--no-deps", "--quiet"),
                *("--only-binary=:all:", "--python-version", "3.11"),
                *("--platform", PLATFORM, "--dest", fetched, f"bpy=={BPY}"),
            )
        except PackageError as error:
            raise PackageError(
                f"{error}\nBlender's program that builds extensions comes with bpy {BPY} from "
                "PyPI, which cannot be fetched; check the network, or leave the extension out."
            ) from None
        (wheel,) = fetched.glob("*.whl")
        with zipfile.ZipFile(wheel) as archive:
            (name,) = (n for n in archive.namelist() if n.endswith("bl_pkg/cli/blender_ext.py"))
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(archive.read(name))
        shutil.rmtree(fetched)
    return path


def legacy(built):
    """Makes the zip for Blender 3.4 to 4.1: the add-on, and unpacked wheels in modules/."""
    target = OUT / f"leaflight-{version()}-legacy.zip"
    tags = sorted(path.name.split("-")[2] for path in built)
    partial = target.with_suffix(".partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED, compresslevel=LEGACY_LEVEL) as archive:
        for path in _addon_files():
            archive.write(path, f"leaflight_addon/{path.relative_to(ADDON).as_posix()}")
        archive.write(ROOT / "LICENSE", "leaflight_addon/LICENSE")
        for path in [*built, *reader_wheels(tags)]:
            with zipfile.ZipFile(path) as wheel:
                for name in wheel.namelist():
                    archive.writestr(f"modules/{name}", wheel.read(name))
    os.replace(partial, target)
    return target


def _addon_files():
    """Returns the add-on's files, without those that only extensions have."""
    files = (path for path in ADDON.rglob("*") if path.is_file())
    return sorted(path for path in files if path.suffix in (".py", ".png"))


def _copy_addon(folder):
    shutil.copytree(ADDON, folder, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")
