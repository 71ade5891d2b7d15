# SPDX-License-Identifier: GPL-3.0-or-later
"""On what something was measured, and of which source."""

import os
import platform
import subprocess
from pathlib import Path

from leaflight.version import __version__

HERE = Path(__file__).resolve()


def machine():
    """Returns a dict: processor, cores, system, python, and load, the mean of the last minute.

    Figures that the system does not have are None.
    """
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def commit():
    """Returns the commit of the source, followed by "-dirty" if files differ; else the version."""
    tracked = ("ls-files", "--error-unmatch", HERE.name)
    described = ("describe", "--always", "--dirty", "--exclude", "*")
    if _git(*tracked) and (found := _git(*described)):
        return found
    return f"version {__version__}"


def _processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or None
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or None)


def _git(*arguments):
    """Returns the output of git in this file's folder; empty without git or a repository."""
    try:
        done = subprocess.run(
            ["git", *arguments], cwd=HERE.parent, capture_output=True, text=True, timeout=10
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
