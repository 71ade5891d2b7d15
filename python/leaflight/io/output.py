# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files: checked before long work begins, and written completely or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import leaflight._core as _core

from .._core import LeaflightError
from ..paths import AnyPath


def check_writable(path: AnyPath, suffix: str, *inputs: AnyPath) -> None:
    """Raises LeaflightError unless path can be written, has this suffix and is none of inputs."""
    path = Path(path)
    if path.suffix.lower() != suffix:
        raise LeaflightError(f"{path}: the suffix is wrong: the output file must end in {suffix}.")
    try:
        try:
            # Raises an OSError or a ValueError if no file can have this name.
            os.lstat(path)
        except FileNotFoundError:
            pass
        if path.is_dir():
            raise LeaflightError(f"{path}: this is a folder: give the name of a file.")
        exists = path.exists()
        for given in inputs:
            if exists and os.path.exists(given) and os.path.samefile(path, given):
                raise LeaflightError(
                    f"{path}: the output would overwrite an input: choose another name."
                )
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except (OSError, ValueError) as error:
        # A ValueError means that the name has a NUL or half a surrogate pair.
        why = getattr(error, "strerror", None) or "no file can have this name"
        raise LeaflightError(
            f"{_shown(path)}: cannot write into the folder {_shown(path.parent)}: {why}; "
            "choose another name or folder."
        ) from None


@contextmanager
def replaced(path: AnyPath) -> Iterator[Path]:
    """Yields a temporary path of the same suffix, which replaces path at the end.

    Raises LeaflightError and leaves path as it was if writing fails.
    """
    with replaced_together(path) as (temporary,):
        yield temporary


@contextmanager
def replaced_together(*paths: AnyPath) -> Iterator[list[Path]]:
    """Yields temporary paths for several files: all of them are replaced at the end, or none."""
    files = _core.ReplacedFiles([Path(path) for path in paths])
    temporaries = [files.temporary(index) for index in range(len(paths))]
    try:
        yield temporaries
        files.commit()
    except LeaflightError as error:
        sentence = str(error)
        for path, temporary in zip(paths, temporaries):
            sentence = sentence.replace(str(temporary), str(path))
        raise LeaflightError(sentence) from None
    except OSError as error:
        names = ", ".join(map(str, paths))
        why = error.strerror or "it fails halfway"
        raise LeaflightError(f"{names}: cannot write it: {why}.") from None
    finally:
        files.discard()


def _shown(path: Path) -> str:
    return str(path).encode("utf-8", "backslashreplace").decode()[:200]
