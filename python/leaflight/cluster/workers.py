# SPDX-License-Identifier: GPL-3.0-or-later
"""Workers of a Dask cluster that trace blocks of light for a bake, with the bits of one machine."""

import asyncio
import os
import tempfile
import uuid
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

import numpy as np

from .._core import BakeSettings, Cancelled, LeaflightError, Progress
from ..arrays import Array
from ..scene.scene import SceneDescription
from ..volume.volume import Volume
from . import block_tracer
from .block_tracer import LookedUp, Recipe

# Seconds between two checks for a cancel while a bake waits for a block.
POLL_SECONDS = 0.1
# Number of times that a block is traced again after its worker died.
RETRIES = 3
# Errors of Dask if the scheduler or the workers are gone.
_GONE = (OSError, RuntimeError, ValueError, asyncio.TimeoutError)
# Settings of the core that a block depends on; each worker chooses its threads.
SETTINGS = ("resolution", "seed", "exposure", "both_sides", "walls")


class Workers:
    """Processes that trace blocks for bakes: bake(volume, workers=Workers(4)).

    count: Number of processes on this machine, which share its processors.
    scheduler: Address of a Dask scheduler instead, such as "tcp://10.0.0.1:8786". Its workers need
        the same Leaflight.
    Use it as a context manager, or call close(). `traced` is the number of blocks that workers
    traced, `lost` the number that bakes had to trace themselves. Raises LeaflightError without Dask
    or without workers.
    """

    def __init__(
        self,
        count: int | None = None,
        scheduler: str | None = None,
        patience_seconds: float = 30,
    ) -> None:
        if (count is None) == (scheduler is None):
            raise LeaflightError("Give either a number of workers or the address of a scheduler.")
        if count is not None and count < 1:
            raise LeaflightError(f"The number of workers is {count}: give at least 1.")
        try:
            import cryptography  # noqa: F401 - for connections that nobody else can use
            from distributed import Client, LocalCluster
        except ImportError:
            raise LeaflightError(
                "Workers need Dask, which is not installed: pip install 'leaflight[cluster]', or "
                "apt-get install python3-distributed python3-cryptography."
            ) from None
        self.traced = self.lost = 0
        self._cluster: Any = None
        self._folder = tempfile.TemporaryDirectory(prefix="leaflight-")
        if count is not None:
            self.threads = max(1, (os.cpu_count() or 1) // count)
            self._cluster = LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                # Disable the memory limit, which would kill workers. Blocks cannot be smaller.
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                local_directory=self._folder.name,
                # Require a certificate, because any client of a scheduler can run code as this
                # user.
                security=True,
            )
        else:
            self.threads = 0
        try:
            self.client: Any = Client(self._cluster or scheduler, timeout=patience_seconds)
            self.client.wait_for_workers(1, timeout=patience_seconds)
        except _GONE as error:
            self.close()
            raise LeaflightError(
                f"{scheduler}: no Dask scheduler with workers answers: {error}; check the address."
            ) from None

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the workers of this machine; those of a scheduler stay."""
        for part in (getattr(self, "client", None), self._cluster):
            if part is not None:
                part.close()
        self._folder.cleanup()

    def processes(self) -> int:
        """Returns the number of processes now."""
        return len(self.client.scheduler_info()["workers"])

    def tracing(
        self,
        volumes: Sequence[Volume],
        scene: SceneDescription,
        isovalues: tuple[float, float],
        settings: BakeSettings,
        progress: Progress,
    ) -> "Tracing":
        """Returns the Tracing of a bake, which lit() gives to the core."""
        return Tracing(self, volumes, scene, isovalues, settings, progress)

    def shared(self, values: Array) -> Array | str:
        """Returns the entry of Recipe.arrays for a volume's values."""
        if self._cluster is None:
            return np.ascontiguousarray(values)
        path = Path(self._folder.name) / f"{uuid.uuid4().hex}.npy"
        try:
            np.save(path, np.ascontiguousarray(values))
        except OSError as error:
            raise LeaflightError(
                f"{path}: the copy of the volume for workers cannot be written: {error.strerror}; "
                "free disk space, or bake without workers."
            ) from None
        return str(path)


class Tracing:
    """A context manager for the blocks of one bake, with the methods that _core.bake() calls."""

    def __init__(
        self,
        workers: Workers,
        volumes: Sequence[Volume],
        scene: SceneDescription,
        isovalues: tuple[float, float],
        settings: BakeSettings,
        progress: Progress,
    ) -> None:
        given = {name: getattr(settings, name) for name in SETTINGS}
        self._workers, self._client, self._progress = workers, workers.client, progress
        self._recipe = Recipe(
            key=uuid.uuid4().hex,
            arrays=[workers.shared(volume.values) for volume in volumes],
            matrices=[np.asarray(volume.index_to_world) for volume in volumes],
            smooth_normals=[volume.smooth_normals for volume in volumes],
            cuts=[volume.cuts for volume in volumes],
            scene=scene,
            isovalues=isovalues,
            settings={**given, "threads": settings.threads or workers.threads},
        )
        self._sent: Any = None  # the recipe, at the workers
        self._futures: dict[int, Any] = {}
        self._fetching = ThreadPoolExecutor(1, "leaflight blocks")

    def __enter__(self) -> "Tracing":
        return self

    def __exit__(self, *_: object) -> None:
        """Ends all work that is left."""
        futures, self._futures = self._futures, {}
        try:
            if self._is_connected():
                if futures:
                    self._client.cancel(list(futures.values()), force=True)
                    self._client.run(block_tracer.cancel, self._recipe.key, on_error="ignore")
                self._client.run(block_tracer.forget, self._recipe.key, on_error="ignore")
        except _GONE:
            pass  # A worker that is gone has nothing to end.
        self._fetching.shutdown(wait=False)
        for array in self._recipe.arrays:
            if isinstance(array, str):
                Path(array).unlink(missing_ok=True)

    def begin(self, first: int, count: int, state: bytes) -> None:
        """Starts tracing blocks. state: The data that their lines look up."""
        if not self._is_connected():
            return
        try:
            if self._sent is None or self._sent.status != "finished":
                self._sent = self._client.scatter(self._recipe, broadcast=True, hash=False)
            looked_up = LookedUp(uuid.uuid4().hex, state)
            looked_up = self._client.scatter(looked_up, broadcast=True, hash=False)
            for number in range(first, first + count):
                self._futures[number] = self._client.submit(
                    block_tracer.trace, self._sent, looked_up, number, pure=False, retries=RETRIES
                )
        except _GONE:
            # All workers are gone; the bake continues in this process.
            self._sent = None

    def _is_connected(self) -> bool:
        return bool(self._client.status == "running")

    def take(self, number: int) -> bytes:
        """Returns a block, or b"" if the workers are gone or keep dying.

        Raises Cancelled, and LeaflightError for workers of another version.
        """
        future = self._futures.pop(number, None)
        if future is not None:
            # Fetch in a thread: an interrupted transfer would start again after each poll.
            fetched = self._fetching.submit(future.result)
            while not wait([fetched], timeout=POLL_SECONDS).done:
                if self._progress.cancelled:
                    self._futures[number] = future
                    self._progress.check()
            try:
                block: bytes = fetched.result()
                self._workers.traced += 1
                return block
            except (Cancelled, LeaflightError):
                raise
            except Exception:
                # The block has the same bits when this process traces it.
                self._sent = None
        self._workers.lost += 1
        return b""
