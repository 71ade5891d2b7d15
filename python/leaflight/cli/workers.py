# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts the workers for the options --workers and --scheduler."""

import contextlib
from argparse import Namespace
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .._core import Progress

if TYPE_CHECKING:
    from ..cluster.workers import Workers


@contextlib.contextmanager
def workers_of(
    options: Namespace, progress: Progress, least: int = 0
) -> Iterator["Workers | None"]:
    """Yields the workers; None without either option.

    least: Number of processes on this machine without either option; 0 gives None.
    """
    count = options.workers
    if options.scheduler is None and count is None:
        if least == 0:
            yield None
            return
        count = least
    # Import Dask only here: it may not be installed, and it takes a second to load.
    from ..cluster.workers import Workers

    progress.begin("Starting workers")
    with Workers(count, options.scheduler) as workers:
        yield workers
