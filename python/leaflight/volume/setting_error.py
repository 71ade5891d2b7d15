# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of settings, in words that suit scripts, panels and the command line."""

from .._core import LeaflightError
from ..words import figures


class SettingError(LeaflightError):
    """An error about `settings`. The command line shows these names as flags."""

    def __init__(self, sentence: str, *settings: str) -> None:
        super().__init__(sentence)
        self.settings = settings


def check_is_baked(isovalue: float, isovalues: tuple[float, float]) -> None:
    """Raises SettingError for an isovalue outside the isovalue range of a bake."""
    low, high = isovalues
    if not low <= isovalue <= high:
        shown, least, most = figures(isovalue, low, high)
        raise SettingError(
            f"Isovalue {shown} is outside the baked range {least}..{most}: choose one inside, or "
            "bake again with a wider range.",
            "isovalues",
        )
