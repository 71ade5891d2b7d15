# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake that was read from its file, but for the light of its walls."""

import threading

import leaflight
from leaflight.bake.load_bake import open_bake, with_walls


class Reading:
    """The bake without walls at once; a thread gives the walls their light, for up to a minute.

    Touches no Blender data. Raises LeaflightError.
    """

    def __init__(self, path):
        self.path = path
        self.bake, self._walls = open_bake(path)
        self._progress, self._whole, self._error = leaflight.Progress(), None, None
        self._thread = threading.Thread(target=self._run, name="Leaflight walls")
        self._thread.start()

    def _run(self):
        try:
            self._whole = with_walls(self.bake, self._walls, self._progress)
        except BaseException as error:  # result() raises it again, in the main thread
            self._error = error

    def is_alive(self):
        return self._thread.is_alive()

    def cancel(self):
        self._progress.cancel()

    def result(self):
        """Waits for the whole bake. Raises LeaflightError."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._whole
