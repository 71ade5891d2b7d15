# SPDX-License-Identifier: GPL-3.0-or-later
"""Checkpoints: an interrupted bake in passes resumes from one and gives the same bits."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import leaflight._core as _core

from .._core import LeaflightError
from ..paths import AnyPath
from .provenance import Provenance, provenance_from_json

# Longest time between two checkpoints, unless a block of light takes longer.
SECONDS = 25.0


def checkpoint_for(out: AnyPath) -> Path:
    """Returns the path of the checkpoint of a bake that will be written to a file."""
    return Path(f"{out}.checkpoint")


@dataclass(frozen=True)
class Checkpoint:
    """The file in which a bake in passes saves its state; a bake of fixed work writes none.

    path: Path of the file.
    recipe: Data in JSON's types from which the caller can start the same bake again.
    resume: True continues from the existing file.
    seconds: Time between two checkpoints. None is SECONDS.
    """

    path: Path
    recipe: dict[str, Any] = field(default_factory=dict)
    resume: bool = False
    seconds: float | None = None

    def arguments(self, provenance: Provenance) -> dict[str, Any]:
        """Returns the arguments of _core.bake() for the bake of this Provenance.

        Raises LeaflightError.
        """
        text = json.dumps({"provenance": provenance.to_json(), "recipe": self.recipe})
        seconds = SECONDS if self.seconds is None else self.seconds
        arguments: dict[str, Any] = {"checkpoint": (self.path, text, seconds)}
        if self.resume:
            left = _read(self.path)["provenance"]
            # The same source may be written in another way now, such as with its full path.
            if left.with_volumes(source="") != provenance.with_volumes(source=""):
                raise LeaflightError(
                    f"{self.path}: this checkpoint belongs to another bake, or the volume, the "
                    "scene or Leaflight has changed since: start the bake again."
                )
            arguments["resumed"] = self.path
        return arguments

    def remove(self) -> None:
        """Removes the file, after the bake is saved or abandoned."""
        try:
            self.path.unlink(missing_ok=True)
        except OSError:
            pass  # A file that is left does no harm.


def read_recipe(path: AnyPath) -> dict[str, Any]:
    """Returns the recipe of the bake that wrote a checkpoint. Raises LeaflightError."""
    recipe: dict[str, Any] = _read(path)["recipe"]
    return recipe


def _read(path: AnyPath) -> dict[str, Any]:
    try:
        text = json.loads(_core.read_checkpoint(path))
        if not isinstance(text["recipe"], dict):
            raise ValueError
        return {**text, "provenance": provenance_from_json(text["provenance"])}
    except (KeyError, TypeError, ValueError, RecursionError):
        raise LeaflightError(
            f"{path}: this is not a checkpoint of a bake: start the bake again."
        ) from None
