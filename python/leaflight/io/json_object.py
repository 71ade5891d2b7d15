# SPDX-License-Identifier: GPL-3.0-or-later
"""Checked reading of JSON objects. Errors name the object and the fault."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..paths import AnyPath
from ..scene.lights import Color, Vector
from ..scene.scene import Ramp


def read_text(path: AnyPath) -> str:
    """Returns the text of a scene file. Raises LeaflightError."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise LeaflightError(f"{path}: cannot read the scene file: {reason}.") from None


def parse(text: str, source: str) -> "JsonObject":
    """Returns the JsonObject of a file's text. source: The file's name in errors.

    Raises LeaflightError.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        detail = (
            f"{error.msg}, line {error.lineno}"
            if isinstance(error, json.JSONDecodeError)
            else "malformed"
        )
        raise LeaflightError(f"{source}: this is not valid JSON ({detail}).") from None
    return JsonObject(data, source)


class JsonObject:
    """One object {...} and its name in errors. Every method raises LeaflightError."""

    def __init__(self, data: Any, where: str) -> None:
        self.data: dict[str, Any] = data
        self.where = where
        self.name = ""
        if not isinstance(data, dict):
            raise self.error("it must be a JSON object {...}")

    def __contains__(self, key: str) -> bool:
        return key in self.data

    def error(self, what: str) -> LeaflightError:
        return LeaflightError(f"{self.where}: {what}.")

    def only(self, *keys: str) -> None:
        """Raises LeaflightError for every other key."""
        for key in self.data:
            if key not in keys:
                raise self.error(
                    f'the key "{key[:40]}" is unknown; choose one of {", ".join(keys)}'
                )

    def get(self, key: str) -> Any:
        if key not in self.data:
            raise self.error(f'the key "{key}" is missing')
        return self.data[key]

    def text(self, key: str, default: str | None = None) -> str:
        value = self.get(key) if default is None else self.data.get(key, default)
        if not isinstance(value, str):
            raise self.error(f'"{key}" must be text')
        if any("\ud800" <= letter <= "\udfff" for letter in value):
            raise self.error(f'"{key}" holds an incomplete Unicode character; write it again')
        return value

    def choice(self, key: str, choices: Sequence[str], default: str | None = None) -> str:
        value = self.text(key, default)
        if value not in choices:
            allowed = ", ".join(f'"{choice}"' for choice in choices[:-1])
            raise self.error(f'"{key}" must be {allowed} or "{choices[-1]}", not "{value[:40]}"')
        return value

    def flag(self, key: str) -> bool:
        """Returns true or false; false if the key is missing."""
        value = self.data.get(key, False)
        if not isinstance(value, bool):
            raise self.error(f'"{key}" must be true or false')
        return value

    def items(self, key: str) -> list[Any]:
        value = self.get(key)
        if not isinstance(value, list):
            raise self.error(f'"{key}" must be a list')
        return value

    def child(self, key: str) -> "JsonObject":
        """Returns the object under a key."""
        return JsonObject(self.get(key), f"{self.where}: {key}")

    def named(self, key: str, kind: str) -> list["JsonObject"]:
        """Returns the objects of a list. Errors call each by its "name"."""
        children = []
        for i, data in enumerate(self.items(key)):
            child = JsonObject(data, f"{self.where}: {kind} {i + 1}")
            child.name = child.text("name")
            child.where = f'{self.where}: {kind} "{child.name[:60]}"'
            children.append(child)
        return children

    def array(self, key: str) -> Array:
        """Returns finite numbers in rows of equal length, float64."""
        try:
            array = np.array(self.get(key), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise self.error(f'"{key}" must hold numbers only, in rows of equal length') from None
        if not np.isfinite(array).all():
            raise self.error(f'"{key}" must hold finite numbers')
        return array

    def number(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """Returns a number in low..high."""
        if default is not None and key not in self:
            return default
        value = self.array(key)
        if value.shape != () or not low <= value <= high:
            allowed = f"in {low:g}..{high:g}" if high < np.inf else f"of at least {low:g}"
            raise self.error(f'"{key}" must be a number {allowed}')
        return float(value)

    def positive(self, key: str) -> float:
        value = self.array(key)
        if value.shape != () or not value > 0:
            raise self.error(f'"{key}" must be a positive number')
        return float(value)

    @overload
    def vector(self, key: str, length: Literal[3] = 3) -> Vector: ...
    @overload
    def vector(self, key: str, length: Literal[2]) -> tuple[float, float]: ...
    def vector(self, key: str, length: int = 3) -> tuple[float, ...]:
        array = self.array(key)
        if array.shape != (length,):
            count = {2: "two", 3: "three"}[length]
            raise self.error(f'"{key}" must be {count} numbers')
        return tuple(array.tolist())

    def points(self, key: str, least: int, axes: str = "xyz") -> Array:
        """Returns at least this many points, float32 (n, axes)."""
        array = self.array(key)
        if array.ndim != 2 or array.shape[1] != len(axes) or len(array) < least:
            point = ", ".join(axes)
            raise self.error(f'"{key}" must be a list of at least {least} points [{point}]')
        # Values beyond single precision become infinite, which meshes refuse.
        with np.errstate(over="ignore"):
            return array.astype(np.float32)

    def faces(self, key: str, lengths: Sequence[int], count: int) -> list[list[int]]:
        """Returns a list that is not empty, of lists of indices in 0..count - 1.

        lengths: The allowed lengths of a list of indices.
        """
        faces = self.items(key)
        if not faces:
            raise self.error(f'"{key}" is empty, so the mesh is invisible: leave it out')
        for face in faces:
            if (
                not isinstance(face, list)
                or len(face) not in lengths
                or not all(isinstance(i, int) and 0 <= i < count for i in face)
            ):
                sizes = " or ".join(str(length) for length in lengths)
                raise self.error(
                    f'"{key}" must hold lists of {sizes} vertex indices in 0..{count - 1}'
                )
        return faces

    def direction(self, key: str) -> Color:
        """Returns a vector of length 1; normalizes any other."""
        vector = np.array(self.vector(key))
        length = np.linalg.norm(vector)
        if not length > 0:
            raise self.error(f'"{key}" must be a direction, but its length is zero')
        # Keep a vector of length 1 bit by bit.
        unit = vector if abs(length - 1) < 1e-12 else vector / length
        return tuple(unit.tolist())

    def color(self, key: str, largest: float = np.inf, default: Color | None = None) -> Color:
        """Returns three linear numbers in 0..largest."""
        if default is not None and key not in self:
            return default
        color = self.vector(key)
        if min(color) < 0 or max(color) > largest:
            allowed = f"between 0 and {largest:g}" if largest < np.inf else "not negative"
            raise self.error(f'"{key}" must be three numbers {allowed}')
        return color

    def ramp(self, key: str, largest: float = np.inf, default: Color | None = None) -> Ramp:
        """Returns a color, or stops()."""
        if default is not None and key not in self:
            return default
        value = self.get(key)
        if not isinstance(value, list) or not any(isinstance(item, list) for item in value):
            return self.color(key, largest)
        return self.stops(key, largest)

    def stops(self, key: str, largest: float = np.inf) -> list[tuple[float, Color]]:
        """Returns a list of pairs (isovalue, color) in ascending order."""
        stops = []
        for i, item in enumerate(self.items(key)):
            if not isinstance(item, list) or len(item) != 2:
                raise self.error(f'"{key}" must be [r, g, b] or a list of [isovalue, [r, g, b]]')
            stop = JsonObject(
                {"isovalue": item[0], "color": item[1]}, f'{self.where}: stop {i + 1} of "{key}"'
            )
            stops.append((stop.number("isovalue", -np.inf, np.inf), stop.color("color", largest)))
        positions = [position for position, _ in stops]
        if any(high <= low for low, high in zip(positions, positions[1:])):
            raise self.error(f'the isovalues of the stops of "{key}" must ascend')
        return stops
