# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of settings, in words that suit a script, a panel and the command line alike."""

from .._core import LeaflightError


class SettingError(LeaflightError):
    """A sentence about settings, which `settings` names: on the command line they are flags."""

    def __init__(self, sentence: str, *settings: str) -> None:
        super().__init__(sentence)
        self.settings = settings
