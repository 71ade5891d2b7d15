# SPDX-License-Identifier: GPL-3.0-or-later
"""A measurement of how long Blender's window is frozen, and in which function."""

import os
import re
import sys
import threading
import time
import traceback

import bpy

# The folder of these tests.
_HERE = os.path.dirname(__file__)
# Seconds between two beats, and of a freeze after which the stack is recorded.
_BEAT, _LONG = 0.01, 0.25


class Heartbeat:
    """The longest time between two calls of a timer of Blender's since start()."""

    def __init__(self):
        self._main = threading.main_thread().ident
        self._thread = threading.Thread(target=self._watch, name="heartbeat", daemon=True)
        self.start()
        bpy.app.timers.register(self._beat, persistent=True)
        self._thread.start()

    def start(self):
        self.seconds, self.where = 0.0, ""
        self._seen, self._last = "", time.perf_counter()

    def skip(self):
        """Ignores the time since the last beat, which the test itself has used."""
        self._seen, self._last = "", time.perf_counter()

    def _beat(self):
        now = time.perf_counter()
        if now - self._last > self.seconds:
            self.seconds, self.where = now - self._last, self._seen or "Blender itself"
        self._seen, self._last = "", now
        return _BEAT

    def _watch(self):
        while True:
            time.sleep(0.05)
            if time.perf_counter() - self._last > _LONG:
                self._seen = _place(sys._current_frames().get(self._main)) or self._seen


def _place(frame):
    """Returns the innermost functions of Leaflight in a stack; none during Blender's own work."""
    ours = [
        f"{re.sub('.*/leaflight(_addon)?/', '', part.filename)}:{part.name}"
        for part in traceback.extract_stack(frame)
        if "leaflight" in part.filename and not part.filename.startswith(_HERE)
    ]
    return " > ".join(ours[-2:])
