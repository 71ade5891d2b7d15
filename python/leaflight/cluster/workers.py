# SPDX-License-Identifier: GPL-3.0-or-later
"""Workers of a Dask cluster that compute parts of a bake, with the bits of one machine."""

import asyncio
import contextlib
import os
import shutil
import tempfile
import time
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
from . import part_tracer
from .part_tracer import Recipe, Sent, passed, received

# Seconds between two checks for a cancel while a bake waits for a part.
POLL_SECONDS = 0.1
# Number of times that a part is computed again after its worker died.
RETRIES = 3
# Errors of Dask if the scheduler or the workers are gone.
_GONE = (OSError, RuntimeError, ValueError, asyncio.TimeoutError)
# Settings of the core that parts depend on; each worker chooses its threads.
SETTINGS = ("resolution", "seed", "exposure", "error", "both_sides", "walls")


class Workers:
    """Processes that compute parts of bakes: bake(volume, workers=Workers(4)).

    count: Number of processes on this machine, which share its processors.
    scheduler: Address of a Dask scheduler instead, such as "tcp://10.0.0.1:8786". Its workers need
        the same Leaflight.
    patience_seconds: The longest wait for a first worker, and for others when all have left.
    Use it as a context manager, or call close(). `traced` is the number of parts that workers
    computed, `lost` the number that bakes had to compute themselves. Raises LeaflightError without
    Dask or without workers.
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
                # Disable the memory limit, which would kill workers. Parts cannot be smaller.
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                local_directory=self._folder.name,
                # Require a certificate, because any client of a scheduler can run code as this
                # user.
                security=True,
            )
        else:
            self.threads = 0
        self.patience_seconds = patience_seconds
        try:
            self.client: Any = Client(self._cluster or scheduler, timeout=patience_seconds)
            self.client.wait_for_workers(1, timeout=patience_seconds)
        except _GONE as error:
            self.close()
            if scheduler is None:
                raise LeaflightError(
                    f"The workers of this machine do not start: {error}; bake without workers."
                ) from None
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
        return len(self.client.nthreads())

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

    def new_folder(self) -> str | None:
        """Returns a folder for the files of a bake; None if workers may be elsewhere."""
        return None if self._cluster is None else tempfile.mkdtemp(dir=self._folder.name)

    def shared(self, values: Array, folder: str | None) -> Array | str:
        """Returns the entry of Recipe.arrays for a volume's values."""
        if folder is None:
            return np.ascontiguousarray(values)
        path = Path(folder) / f"{uuid.uuid4().hex}.npy"
        try:
            np.save(path, np.ascontiguousarray(values))
        except OSError as error:
            shutil.rmtree(folder, ignore_errors=True)
            raise LeaflightError(
                f"{path}: the copy of the volume for workers cannot be written: "
                f"{error.strerror or error}; free disk space, or bake without workers."
            ) from None
        return str(path)


def _is_there(future: Any) -> bool:
    """True if workers still have what was scattered to them."""
    return future is not None and bool(future.status == "finished")


class Tracing:
    """A context manager for the parts of one bake, with the methods that _core.bake() calls."""

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
        folder = workers.new_folder()
        self._workers, self._client, self._progress = workers, workers.client, progress
        self._recipe = Recipe(
            key=uuid.uuid4().hex,
            arrays=[workers.shared(volume.values, folder) for volume in volumes],
            matrices=[np.asarray(volume.index_to_world) for volume in volumes],
            smooth_normals=[volume.smooth_normals for volume in volumes],
            cuts=[volume.cuts for volume in volumes],
            scene=scene,
            isovalues=isovalues,
            settings={**given, "threads": settings.threads or workers.threads},
            folder=folder,
        )
        self._described: Any = None  # the recipe, at the workers
        self._data: dict[int, Sent] = {}  # what parts look up, by its kind
        self._sent: dict[int, Any] = {}  # the same, at the workers, unless it is small or in a file
        self._futures: dict[int, Any] = {}
        self._announced = 0
        self._is_over = False
        self._fetching = ThreadPoolExecutor(1, "leaflight parts")

    def __enter__(self) -> "Tracing":
        return self

    def __exit__(self, *_: object) -> None:
        """Ends all work that is left. A worker that is gone has none."""
        with contextlib.suppress(*_GONE):
            if self._is_connected():
                self._client.run(part_tracer.end, self._recipe.key, on_error="ignore")
        self._fetching.shutdown(wait=False)
        if self._recipe.folder is not None:
            shutil.rmtree(self._recipe.folder, ignore_errors=True)

    def send(self, kind: int, data: bytes) -> None:
        """Gives data to all workers, for the parts that are announced later."""
        if self._is_over or not self._is_connected():
            return self._end()
        self._forget(kind)
        self._data[kind] = Sent(uuid.uuid4().hex, kind, passed(data, self._recipe.folder))

    def announce(self, parts: Sequence[bytes]) -> int:
        """Starts computing parts; returns the number of the first."""
        first, self._announced = self._announced, self._announced + len(parts)
        if self._is_over or not self._is_connected():
            return first
        try:
            if not _is_there(self._described):
                self._described = self._scattered(self._recipe)
            sent = [self._at_workers(kind) for kind in self._data]
            for number, part in enumerate(parts, first):
                # The bake waits first for what it has announced last.
                self._futures[number] = self._client.submit(
                    part_tracer.trace,
                    self._described,
                    sent,
                    part,
                    pure=False,
                    retries=RETRIES,
                    priority=first,
                )
        except _GONE:
            self._end()
        return first

    def _end(self) -> None:
        """Stops sharing: all workers are gone, or the disk is full. The bake goes on alone."""
        self._is_over = True

    def _at_workers(self, kind: int) -> Any:
        """Returns data for a part: a Sent, or the future of one that all workers have."""
        data = self._data[kind]
        if len(data.data) < part_tracer.LEAST_FILE_BYTES:
            return data  # this, and names of files, travel with each part
        if not _is_there(self._sent.get(kind)):
            self._sent[kind] = self._scattered(data)
        return self._sent[kind]

    def _forget(self, kind: int) -> None:
        """Frees earlier data of a kind."""
        self._sent.pop(kind, None)
        data = self._data.pop(kind, None)
        if data is not None and isinstance(data.data, str):
            Path(data.data).unlink(missing_ok=True)

    def drop(self, first: int, count: int) -> None:
        """Ends parts that the bake does not take."""
        numbers = range(first, first + count)
        dropped = [self._futures.pop(number) for number in numbers if number in self._futures]
        if dropped and self._is_connected():
            with contextlib.suppress(*_GONE):
                self._client.cancel(dropped, force=True)

    def _scattered(self, data: Any) -> Any:
        return self._client.scatter(data, broadcast=True, hash=False)

    def _is_connected(self) -> bool:
        return bool(self._client.status == "running")

    def take(self, number: int) -> bytes:
        """Returns the result of a part, or b"" if the workers are gone or keep dying.

        Raises Cancelled, and LeaflightError for workers of another version.
        """
        future = self._futures.get(number)
        if future is not None:
            # Fetch in a thread: an interrupted transfer would start again after each poll.
            fetched = self._fetching.submit(future.result)
            self._wait(fetched)
            del self._futures[number]
            try:
                found = received(fetched.result(), last=True)
                self._workers.traced += 1
                return found
            except (Cancelled, part_tracer.OtherVersion):
                raise
            except Exception:
                # The part has the same bits when this process computes it.
                self._described = None
        self._workers.lost += 1
        return b""

    def _wait(self, fetched: Any) -> None:
        """Waits for a part. Cancels all parts if there are no workers for a long time.

        Raises Cancelled.
        """
        last_there = asked = time.monotonic()
        while not wait([fetched], timeout=POLL_SECONDS).done:
            self._progress.check()
            now = time.monotonic()
            if now < asked + self._workers.patience_seconds / 10:
                continue
            asked = now
            with contextlib.suppress(*_GONE):
                if self._workers.processes() > 0:
                    last_there = now
                elif now > last_there + self._workers.patience_seconds:
                    self._end()
                    self._client.cancel(list(self._futures.values()), force=True)
