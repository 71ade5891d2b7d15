# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders, and a function that runs programs."""

import hashlib
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
OUT = ROOT / "build" / "package"
VENV = ROOT / "build" / "venv"
REQUIREMENTS = ROOT / "scripts" / "build-tools.txt"


class PackageError(Exception):
    """One sentence with the cause and the remedy."""


def version():
    text = (ROOT / "python" / "leaflight" / "version.py").read_text()
    return re.search(r'__version__ = "(.+)"', text)[1]


def run(*command, **options):
    """Runs a program with the tools of build/venv in its path; shows its output if it fails."""
    environment = {**os.environ, "PATH": f"{VENV / 'bin'}:{os.environ['PATH']}"}
    environment["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"
    # Fix the time stamps, so that the same files give the same archive.
    environment.setdefault("SOURCE_DATE_EPOCH", "1577836800")
    done = subprocess.run(
        list(map(str, command)),
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        **{"cwd": ROOT, **options},
    )
    if done.returncode != 0:
        shown = " ".join(map(str, command))
        raise PackageError(f"{done.stdout}\n'{shown}' failed; its output is above.")
    return done.stdout


def environment(python):
    """Returns the Python of a virtual environment with the build tools.

    It is build/venv for the system's Python.
    """
    if Path(python).resolve() == Path("/usr/bin/python3").resolve():
        if not (VENV / "build-tools.txt").exists():
            raise PackageError("The build tools are not installed; run scripts/setup first.")
        return VENV / "bin" / "python"
    tag = run(python, "-c", "import sys; print('cp%d%d' % sys.version_info[:2])").strip()
    folder = ROOT / "build" / f"venv-{tag}"
    stamp = folder / "build-tools.txt"
    wanted = REQUIREMENTS.read_text()
    if not stamp.exists() or stamp.read_text() != wanted:
        run(python, "-m", "venv", "--clear", folder)
        run(folder / "bin" / "python", "-m", "pip", "install", "--quiet", "-r", REQUIREMENTS)
        stamp.write_text(wanted)
    return folder / "bin" / "python"


def digest(*paths):
    """Returns a hash of the contents of files."""
    result = hashlib.sha256()
    for path in paths:
        result.update(Path(path).read_bytes())
    return result.hexdigest()
