# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line behind its options, which leaflight_command parses."""

from .commands import run

__all__ = ["run"]
