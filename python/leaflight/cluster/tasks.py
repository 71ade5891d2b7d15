# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs tasks on the workers of a cluster until all are done or cancelled."""

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from .._core import Progress
    from .workers import Workers

_Name = TypeVar("_Name")

POLL_SECONDS = 0.2
# Number of times that a task is repeated after its worker died.
RETRIES = 3


@contextlib.contextmanager
def at_workers(
    workers: "Workers",
    tasks: Iterable[tuple[_Name, Callable[..., object], Sequence[object]]],
    progress: "Progress",
    stop: Callable[..., object],
    *of_stop: object,
) -> Iterator[Iterator[tuple[_Name, Any]]]:
    """Gives tasks to Workers. Yields an iterator over (name, future), in the order of completion.

    tasks: (name, function, arguments) of each task.
    If the context ends before all tasks are done, stop(*of_stop) ends the others in each worker.
    The iterator raises Cancelled.
    """
    left = {
        workers.client.submit(function, *arguments, pure=False, retries=RETRIES): name
        for name, function, arguments in tasks
    }

    def finished() -> Iterator[tuple[_Name, Any]]:
        while left:
            progress.check()
            for future in [future for future in left if future.done()]:
                yield left.pop(future), future
            time.sleep(POLL_SECONDS)

    try:
        yield finished()
    finally:
        if left:
            workers.client.cancel(list(left), force=True)
            workers.client.run(stop, *of_stop, on_error="ignore")
