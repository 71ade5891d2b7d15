# SPDX-License-Identifier: GPL-3.0-or-later
"""The error for a missing package of a format, with the command that installs it."""

import os
import shlex
import shutil
import sys
import sysconfig
from pathlib import Path

from ..._core import LeaflightError

# Import names of packages that Debian 12 has, as python3-NAME.
_OF_DEBIAN = {"crc32c", "gdcm", "gemmi", "h5py", "lz4", "mrcfile", "nibabel", "numcodecs", "PIL"}
_OF_DEBIAN |= {"pydicom", "tifffile"}
# Import name -> name for pip, if they differ.
_OF_PIP = {"PIL": "pillow"}
# Dependencies that reading needs in addition to NumPy. Metadata of some packages list more, even
# CMake.
_NEEDS = {"pylibCZIrw": "validators xmltodict"}
_ENVIRONMENT = "~/leaflight-python"


class MissingPackage(LeaflightError):
    """A Python package that a format needs is not installed.

    package: Its name.
    of_debian: Its package in Debian, or None.
    """

    def __init__(self, path: Path, kind: str, package: str) -> None:
        self.path, self.kind = path, kind
        self.package = _OF_PIP.get(package, package)
        self.of_debian = f"python3-{package.lower()}" if package in _OF_DEBIAN else None
        self._wanted = " ".join([self.package, *_NEEDS.get(package, "").split()])
        super().__init__(
            f"{path}: reading this {kind} needs the Python package {self.package}, which is not "
            f"installed; {self._remedy()}."
        )

    def _remedy(self) -> str:
        """Returns the command for this interpreter and system."""
        python = shlex.quote(sys.executable)
        if not _is_managed():
            return f"run '{python} -m pip install {self.package}'"
        if self.of_debian and shutil.which("apt"):
            return f"run 'apt install {self.of_debian}' as root"
        # pip installs only into virtual environments there. It would add newer versions of system
        # packages, which may not fit compiled ones of the system.
        started = f"{_ENVIRONMENT}/bin/python -m leaflight"
        root = str(Path(__file__).parents[3])
        if root in os.environ.get("PYTHONPATH", "").split(os.pathsep):
            started = f"PYTHONPATH={shlex.quote(root)} {started}"
        return (
            f"this system's pip needs a virtual environment: run '{python} -m venv "
            f"--system-site-packages {_ENVIRONMENT} && {_ENVIRONMENT}/bin/pip install --no-deps "
            f"{self._wanted}', and start Leaflight by '{started}'"
        )


def _is_managed() -> bool:
    """Returns True if pip refuses to install for this interpreter (PEP 668), as on Debian."""
    if sys.prefix != sys.base_prefix:
        return False
    return Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED").is_file()
