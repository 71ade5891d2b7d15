# SPDX-License-Identifier: GPL-3.0-or-later
"""Reasons why work failed: a sentence for the user, and for bugs a report to copy."""

import platform
import sys
import traceback
from typing import Any

import bpy
import leaflight
from leaflight import LeaflightError

# Reason why the last work failed, for the panels, because reports disappear in seconds.
_sentence = ""
# Traceback of the last error that is a bug of Leaflight.
_traceback = ""


def record(error: BaseException) -> str:
    """Stores why work failed for the panels. Returns it as one sentence."""
    global _sentence
    _sentence = sentence_of(error)
    return _sentence


def sentence_of(error: BaseException) -> str:
    """Returns an error as one sentence. The traceback of a bug goes to the console and report()."""
    global _traceback
    if isinstance(error, LeaflightError):
        return str(error)
    _traceback = "".join(traceback.format_exception(type(error), error, error.__traceback__))
    print(_traceback, file=sys.stderr, flush=True)
    return (
        f"A bug in Leaflight ended this operation ({type(error).__name__}: {error}): please "
        "report it with the details of Copy Report in the panel Bake or in the preferences."
    )


def sentence() -> str:
    """Returns why the last work failed, or an empty text."""
    return _sentence


def forget() -> None:
    """Clears the sentence, after another file was opened or the scene has changed."""
    global _sentence
    _sentence = ""


def is_bug() -> bool:
    """True if a bug of Leaflight ended some work in this session."""
    return bool(_traceback)


def report() -> str:
    """Returns the versions and the last traceback as text for developers."""
    lines = [
        f"Leaflight {leaflight.__version__} in Blender {bpy.app.version_string}",
        f"Python {platform.python_version()}, {platform.platform()}",
        _traceback or "No error of Leaflight in this session.",
    ]
    return "\n".join(lines)


class LEAFLIGHT_OT_copy_report(bpy.types.Operator):
    bl_idname = "leaflight.copy_report"
    bl_label = "Copy Report"
    bl_description = "Copy the versions of all programs and the last error to the clipboard"

    def execute(self, context: bpy.types.Context) -> set[Any]:
        context.window_manager.clipboard = report()
        self.report({"INFO"}, "The report is in the clipboard")
        return {"FINISHED"}
