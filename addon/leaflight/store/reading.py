# SPDX-License-Identifier: GPL-3.0-or-later
"""The reading of a bake or a volume from its file, in a thread."""

import threading
import traceback

import leaflight
from leaflight import LeaflightError
from leaflight.bake.load_bake import open_bake, with_walls


class StillReading(LeaflightError):
    """The reason why a bake or a volume is not there yet: a thread reads its file."""


class Reading:
    """The steps of reading a file, in a thread. Touches no Blender data.

    path, state: Path and state of the file (bake_files.state_of()).
    progress: A Progress.
    found: Result of the last step that has ended, None before the first.
    """

    def __init__(self, path, state, steps):
        """Starts the thread.

        steps: Generator function of the Progress, which yields the result of each step.
        """
        self.path, self.state, self._steps = path, state, steps
        self.progress, self.found, self._error = leaflight.Progress(), None, None
        # Number of ended steps, and of those that has_news() has reported.
        self._ended = self._reported = 0
        # Set after the first step or an error.
        self._is_open = threading.Event()
        self._thread = threading.Thread(target=self._run, name="Leaflight reading")
        self._thread.start()

    def _run(self):
        try:
            for self.found in self._steps(self.progress):
                self._end_step()
        except (LeaflightError, leaflight.Cancelled) as error:
            self._error = error
        except Exception as error:
            traceback.print_exc()
            self._error = LeaflightError(
                f"{self.path}: a bug in Leaflight ended the reading of this file "
                f"({type(error).__name__}: {error}): please report it."
            )
        self._end_step()

    def _end_step(self):
        self._ended += 1
        self._is_open.set()

    def is_alive(self):
        return self._thread.is_alive()

    def has_news(self):
        """True if a step has ended since the last call."""
        ended, before = self._ended, self._reported
        self._reported = ended
        return ended > before

    def cancel(self):
        self.progress.cancel()

    def wait_for_first(self):
        """Waits until there is a result, or an error."""
        self._is_open.wait()

    def result(self, progress=None):
        """Waits for the last result, and returns it.

        Raises LeaflightError, or Cancelled once one of the two Progress is canceled.
        """
        if progress is not None:
            progress.begin(self.progress.stage)
        while self.is_alive():
            self._thread.join(0.1)
            if progress is not None and progress.cancelled:
                raise leaflight.Cancelled
        if self._error is not None:
            raise self._error
        return self.found


def steps_of_bake(path):
    """Returns the steps of a Reading: the bake without the light of its walls, and with it."""

    def steps(progress):
        progress.begin("Reading the bake")
        bake, walls = open_bake(path, progress)
        yield bake
        if walls is not None:
            progress.begin("Lighting walls")
            yield with_walls(bake, walls, progress)

    return steps
