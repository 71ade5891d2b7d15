# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake whose file is read and whose walls get their light in a thread."""

import threading

import leaflight
from leaflight.bake.load_bake import with_walls


class Reading:
    """A bake without walls; a thread gives these their light, for up to a minute.

    Touches no Blender data.
    """

    def __init__(self, path, bake, walls):
        self.path, self.bake, self._walls = path, bake, walls
        self.progress, self._whole, self._error = leaflight.Progress(), None, None
        self.progress.begin("Lighting walls")
        self._thread = threading.Thread(target=self._run, name="Leaflight walls")
        self._thread.start()

    def _run(self):
        try:
            self._whole = with_walls(self.bake, self._walls, self.progress)
        except BaseException as error:  # result() raises it in the caller's thread
            self._error = error

    def is_alive(self):
        return self._thread.is_alive()

    def cancel(self):
        self.progress.cancel()

    def result(self, progress=None):
        """Waits for the bake with lit walls, and returns it.

        Raises LeaflightError, or Cancelled once the progress is canceled.
        """
        if progress is not None:
            progress.begin("Lighting walls")
        while self.is_alive():
            self._thread.join(0.1)
            if progress is not None and progress.cancelled:
                raise leaflight.Cancelled
        if self._error is not None:
            raise self._error
        return self._whole
