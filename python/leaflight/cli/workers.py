# SPDX-License-Identifier: GPL-3.0-or-later
"""The workers that the options --workers and --scheduler ask for."""

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
    """Workers for as long as the context lasts; None where neither option was given.

    least: how many processes of this machine work where neither was, instead of none.
    """
    count = options.workers
    if options.scheduler is None and count is None:
        if least == 0:
            yield None
            return
        count = least
    # Not everywhere is Dask installed, and it takes a second to load.
    from ..cluster.workers import Workers

    progress.begin("Starting workers")
    with Workers(count, options.scheduler) as workers:
        yield workers
