# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks on output files, made before the long work begins rather than after it."""

import os
import tempfile
from pathlib import Path

from ._core import LeaflightError


def check_writable(path, suffix, *inputs):
    """Raises LeaflightError unless path can be written, has this suffix and is none of inputs."""
    path = Path(path)
    if path.suffix.lower() != suffix:
        raise LeaflightError(f"{path}: the output file must end in {suffix}.")
    if path.is_dir():
        raise LeaflightError(f"{path}: this is a folder; give the name of a file to write.")
    for given in inputs:
        if path.exists() and os.path.exists(given) and os.path.samefile(path, given):
            raise LeaflightError(
                f"{path}: the output would overwrite the input; choose another name."
            )
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise LeaflightError(
            f"{path}: cannot write into the folder {path.parent}: {error.strerror}; "
            "choose another folder."
        ) from None
