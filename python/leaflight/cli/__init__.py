# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands. leaflight_command parses their options."""

from .commands import run

__all__ = ["run"]
