# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files: checked before the long work begins, and written as a whole or not at all."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

from .._core import LeaflightError


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


@contextmanager
def replaced(path):
    """A temporary path of the same suffix, renamed to path at the end. Raises LeaflightError."""
    path = Path(path)
    try:
        # The folder, not the file, is temporary: some writers recognise the format by the suffix.
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".leaflight-") as folder:
            temporary = Path(folder) / f"output{path.suffix}"
            yield temporary
            os.replace(temporary, path)
    except OSError as error:
        raise LeaflightError(f"{path}: cannot write it: {error.strerror}.") from None
