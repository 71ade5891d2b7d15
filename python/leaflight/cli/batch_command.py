# SPDX-License-Identifier: GPL-3.0-or-later
"""The command batch: many bakes, each by one worker; the same command resumes them.

Workers run `bake_line` of this module. Workers of a scheduler need the same shared files.
"""

import os
import shlex
import time
from argparse import Namespace
from collections.abc import Sequence
from concurrent.futures import CancelledError
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._core import Cancelled, LeaflightError, Progress
from ..bake.bake import bake, task_of
from ..bake.load_bake import load_bake
from ..bake.provenance import Provenance
from ..cluster.frames import at_workers
from ..io.output import check_writable
from ..progress_bar import run_with_progress
from .bake_command import bake_settings, checkpoint_of, path_anywhere
from .lighting import source_anywhere, to_light, workers_of
from .output import Output

if TYPE_CHECKING:
    from distributed import Future

    from ..cluster.workers import Workers


def run_batch(options: Namespace) -> Output:
    bakes = _read_list(options.list)

    def work(progress: Progress) -> list[dict[str, Any]]:
        with workers_of(options, progress, least=1) as workers:
            assert workers is not None
            return _bake_all(bakes, workers, progress)

    goes_on = "cancelled; run the same command to continue."
    done = run_with_progress(work, "batch", writes=True, cancelled=goes_on)
    refused = [one for one in done if "error" in one]
    baked = [one for one in done if one.get("seconds") is not None]
    result = {"bakes": done, "baked": len(baked), "refused": len(refused)}
    if refused:
        raise LeaflightError(
            f"{options.list}: {len(refused)} of {len(done)} bakes failed, the first of them on "
            f"line {refused[0]['line']}: {refused[0]['error']}"
        )
    return result, [
        *(f"{one['out']}: {one['seconds']:.1f} s" for one in baked),
        f"{len(baked)} baked, {len(done) - len(baked)} already complete",
    ]


def bake_line(options: Namespace, threads: int) -> dict[str, Any]:
    """Bakes a line of the list in a worker: {"out", "seconds"}, None if the file is complete
    already.
    """
    global _under_way
    _under_way = progress = Progress()
    start = time.perf_counter()
    volumes, scene = to_light(options, ".vdb")
    settings = {**bake_settings(options), "threads": threads}
    asked = task_of(volumes, scene, **settings).provenance
    if _is_baked(options.out, asked):
        return {"out": options.out, "seconds": None}
    checkpoint = checkpoint_of(options, resumed=True)
    try:
        checkpoint.arguments(asked)
    except LeaflightError:
        checkpoint = checkpoint_of(options, resumed=False)
    baked = bake(volumes, scene, progress=progress, checkpoint=checkpoint, **settings)
    baked.save(options.out, progress)
    checkpoint.remove()
    return {"out": options.out, "seconds": time.perf_counter() - start}


_under_way: Progress | None = None


def cancel_bake() -> None:
    """Ends the bake of this worker; its checkpoint stays."""
    if _under_way is not None:
        _under_way.cancel()


def _bake_all(
    bakes: Sequence[tuple[int, Namespace]], workers: "Workers", progress: Progress
) -> list[dict[str, Any]]:
    progress.begin("Bakes")
    progress.expect(len(bakes))
    tasks = [(number, bake_line, (options, workers.threads)) for number, options in bakes]
    done = []
    with at_workers(workers, tasks, progress, cancel_bake) as finished:
        for number, future in finished:
            done.append({"line": number, **_outcome(future)})
            progress.advance(1)
    return sorted(done, key=lambda one: one["line"])


def _outcome(future: "Future") -> dict[str, Any]:
    try:
        done: dict[str, Any] = future.result()
        return done
    except (LeaflightError, MemoryError) as error:
        return {"error": str(error) or "there is not enough memory."}
    except (Cancelled, CancelledError):
        return {"error": "its worker was cancelled; run the command again."}
    except Exception as error:  # Dask's own error: the worker died repeatedly
        return {"error": f"its worker died ({type(error).__name__}); run the command again."}


def _is_baked(path: str, asked: Provenance) -> bool:
    """Returns True if a file is a complete bake of this Provenance."""
    try:
        return load_bake(path).provenance.alike(asked)
    except LeaflightError:
        return False


def _read_list(path: str) -> list[tuple[int, Namespace]]:
    """Returns the line numbers of the bakes of a list, and their options."""
    # Import these only here, because the package works without its command.
    from leaflight_command.parser import make_parser
    from leaflight_command.shared_options import UsageError

    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise LeaflightError(f"{path}: cannot read it: {error}.") from None
    bakes, parser = [], make_parser()
    for number, line in enumerate(text.splitlines(), 1):
        try:
            words = shlex.split(line, comments=True)
            options = parser.parse_args(["bake", *words]) if words else None
        except (ValueError, UsageError) as error:
            raise LeaflightError(f"{path}, line {number}: {error}") from None
        if options is None:
            continue
        if not options.out or options.previous or options.workers or options.scheduler:
            raise LeaflightError(
                f"{path}, line {number}: give VOLUME and --out, but not --continue, --workers or "
                "--scheduler."
            )
        bakes.append((number, _anywhere(options)))
    if not bakes:
        raise LeaflightError(
            f"{path}: it lists no bakes: give the arguments of one `leaflight bake` per line."
        )
    outs = [options.out for _, options in bakes]
    for number, options in bakes:
        check_writable(options.out, ".vdb")
        if outs.count(options.out) > 1:
            raise LeaflightError(
                f"{path}, line {number}: another line also writes {options.out}; name another file."
            )
    return bakes


def _anywhere(options: Namespace) -> Namespace:
    """Returns the options with absolute paths."""
    options.volumes = [path_anywhere(volume) for volume in options.volumes]
    options.color_by = source_anywhere(options.color_by)
    for name in ("scene", "out"):
        value = getattr(options, name)
        setattr(options, name, value and os.path.abspath(value))
    return options
