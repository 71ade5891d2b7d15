# SPDX-License-Identifier: GPL-3.0-or-later
"""What an interrupted bake in passes leaves, and goes on from with the same bits."""

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import leaflight._core as _core

from .._core import LeaflightError
from .provenance import Provenance, provenance_from_json

# Between two checkpoints, at most, as long as a block of light takes no longer.
SECONDS = 25.0


def checkpoint_for(out: str | os.PathLike[str]) -> Path:
    """The path of the checkpoints of a bake that is to be written to a file."""
    return Path(f"{out}.checkpoint")


@dataclass(frozen=True)
class Checkpoint:
    """Where a bake in passes leaves its state; a bake of fixed work leaves none.

    path: of the file; recipe: what its caller needs to bake the same again, of anything that JSON
    holds; resume: whether to go on from the file that is there; seconds: between two of them,
    None for SECONDS.
    """

    path: Path
    recipe: dict[str, Any] = field(default_factory=dict)
    resume: bool = False
    seconds: float | None = None

    def arguments(self, provenance: Provenance) -> dict[str, Any]:
        """Those of _core.bake() for the bake of this Provenance. Raises LeaflightError."""
        text = json.dumps({"provenance": provenance.to_json(), "recipe": self.recipe})
        seconds = SECONDS if self.seconds is None else self.seconds
        arguments: dict[str, Any] = {"checkpoint": (self.path, text, seconds)}
        if self.resume:
            left = _read(self.path)["provenance"]
            # The source of a volume may have other words now, such as a whole path.
            if left.with_volumes(source="") != provenance.with_volumes(source=""):
                raise LeaflightError(
                    f"{self.path}: this is the checkpoint of another bake, or the volume, the "
                    "scene or the program has changed since; bake anew."
                )
            arguments["resumed"] = self.path
        return arguments

    def remove(self) -> None:
        """Once the bake is saved, or given up."""
        try:
            self.path.unlink(missing_ok=True)
        except OSError:
            pass  # It is in nobody's way.


def read_recipe(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The recipe of the bake that left a checkpoint. Raises LeaflightError."""
    recipe: dict[str, Any] = _read(path)["recipe"]
    return recipe


def _read(path: str | os.PathLike[str]) -> dict[str, Any]:
    try:
        text = json.loads(_core.read_checkpoint(path))
        if not isinstance(text["recipe"], dict):
            raise ValueError
        return {**text, "provenance": provenance_from_json(text["provenance"])}
    except (KeyError, TypeError, ValueError, RecursionError):
        raise LeaflightError(f"{path}: this is no checkpoint of a bake; bake anew.") from None
