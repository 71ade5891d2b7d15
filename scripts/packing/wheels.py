# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels of the package, and the sdist."""

import json
import re
import shutil
from pathlib import Path

from .private_libraries import make_private
from .tools import OUT, ROOT, VENV, PackageError, digest, environment, run

WORK = OUT / "work"
# A finished wheel also depends on these scripts.
_RECIPE = sorted(Path(__file__).parent.glob("*.py"))


def built(python):
    """Builds the wheel for an interpreter, for this machine only; returns its path."""
    python = environment(python)
    tag = _tag(python)
    raw_folder = WORK / tag
    shutil.rmtree(raw_folder, ignore_errors=True)
    # Use the build of the release preset for the system's Python, so that nothing is built twice.
    of_system = python.parent.parent == VENV
    options = (
        f"build-dir={'build/release' if of_system else f'build/{tag}'}",
        "cmake.define.CMAKE_COMPILE_WARNING_AS_ERROR=ON",
    )
    run(
        *(python, "-m", "pip", "wheel", ".", "--no-build-isolation", "--no-deps"),
        *("--wheel-dir", raw_folder),
        *(f"--config-settings={option}" for option in options),
    )
    (raw,) = raw_folder.glob("*.whl")
    return raw


def wheel(python):
    """Builds, repairs and finishes the wheel for an interpreter; returns its path.

    An unchanged build is not repaired again.
    """
    raw = built(python)
    stamp = WORK / f"{raw.parent.name}.stamp"
    wanted = digest(raw, *_RECIPE)
    if stamp.exists():
        name, made_of = stamp.read_text().split()
        if made_of == wanted and (OUT / name).exists():
            return OUT / name
    finished = _finish(raw)
    stamp.write_text(f"{finished.name} {wanted}\n")
    return finished


def _tag(python):
    return run(python, "-c", "import sys; print('cp%d%d' % sys.version_info[:2])").strip()


def _finish(raw):
    repaired = raw.parent / "repaired"
    run("auditwheel", "repair", "--wheel-dir", repaired, raw)
    (path,) = repaired.glob("*.whl")
    folder = unpack(path, raw.parent / "unpacked")
    make_private(folder)
    _add_licenses(folder)
    for old in OUT.glob(f"leaflight-*-{'-'.join(path.name.split('-')[2:3])}-*linux*.whl"):
        old.unlink()
    return pack(folder, OUT)


def _add_licenses(folder):
    """Adds the licenses of the copied libraries, from their Debian packages."""
    (info,) = folder.glob("*.dist-info")
    listed = json.loads((info / "sboms" / "auditwheel.cdx.json").read_text())
    packages = {
        match[1]
        for component in listed["components"]
        if (match := re.match(r"pkg:deb/debian/([^@?]+)", component.get("purl", "")))
    }
    if not packages:
        raise PackageError("auditwheel lists no package that a library came from; look into it.")
    for package in sorted(packages):
        text = Path("/usr/share/doc") / package / "copyright"
        shutil.copyfile(text, info / "licenses" / f"{package}.txt")


def unpack(path, folder):
    shutil.rmtree(folder, ignore_errors=True)
    run("wheel", "unpack", "--dest", folder, path)
    (unpacked,) = folder.iterdir()
    return unpacked


def pack(folder, out):
    """Packs an unpacked wheel, with a new RECORD; returns its path."""
    text = run("wheel", "pack", "--dest-dir", out, folder)
    return out / re.search(r"/([^/]+\.whl)\.\.\.OK", text)[1]


def sdist():
    for old in OUT.glob("leaflight-*.tar.gz"):
        old.unlink()
    call = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    run(VENV / "bin" / "python", "-c", call, OUT, cwd=ROOT)
    (path,) = OUT.glob("leaflight-*.tar.gz")
    return path
