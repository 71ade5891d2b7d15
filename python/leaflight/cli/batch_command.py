# SPDX-License-Identifier: GPL-3.0-or-later
"""The command batch: bakes of a list or of a folder, each by one worker. The same command resumes
them.

Workers run `bake_line` of this module. Workers of a scheduler need the same shared files.
"""

import csv
import os
import shlex
import uuid
from argparse import Namespace
from collections.abc import Sequence
from concurrent.futures import CancelledError
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .._core import Cancelled, LeaflightError, Progress
from ..bake.bake import bake, task_of
from ..bake.baked import Bake
from ..bake.load_bake import load_bake
from ..bake.provenance import Provenance
from ..cluster.frames import at_workers
from ..io.output import check_writable, replaced
from ..io.readers.formats import format_of
from ..progress_bar import run_with_progress
from ..words import by
from .bake_command import bake_settings, checkpoint_of, path_anywhere
from .lighting import source_anywhere, to_light, workers_of
from .output import Output

if TYPE_CHECKING:
    from distributed import Future

    from ..cluster.workers import Workers


# Columns of the table of results.
COLUMNS = (
    *("file", "nodes", "texels", "seconds", "estimated_error_percent"),
    *("output", "failure"),
)


class Listed(NamedTuple):
    """A bake of the batch: the place that errors name, and the options of `leaflight bake`."""

    place: str
    options: Namespace


def run_batch(options: Namespace) -> Output:
    if options.table is not None:
        check_writable(options.table, ".csv", options.list)
    bakes = _read_folder(options) if os.path.isdir(options.list) else _read_list(options)

    def work(progress: Progress) -> list[dict[str, Any]]:
        with workers_of(options, progress, least=1) as workers:
            assert workers is not None
            return _bake_all(bakes, workers, progress)

    goes_on = "cancelled; run the same command to continue."
    done = run_with_progress(work, "batch", writes=True, cancelled=goes_on)
    if options.table is not None:
        _write_table(options.table, done)
    failed = [k for k, one in enumerate(done) if "failure" in one]
    if failed:
        first = bakes[failed[0]].place
        raise LeaflightError(
            f"{options.list}: {len(failed)} of {len(done)} bakes failed, the first of them on "
            f"{first}: {done[failed[0]]['failure']}"
        )
    baked = [one for one in done if not one["was_complete"]]
    return {"bakes": done, "baked": len(baked)}, [
        *(f"{one['output']}: {one['seconds']:.1f} s" for one in baked),
        f"{len(baked)} baked, {len(done) - len(baked)} already complete",
    ]


def bake_line(key: str, options: Namespace, threads: int) -> dict[str, Any]:
    """Bakes a line of the list in a worker, unless its file is complete. Returns its results.

    key: Key for end_batch().
    """
    progress = Progress()
    _under_way.append((key, progress))
    try:
        return _bake_line(options, threads, progress)
    finally:
        _under_way.remove((key, progress))


def _bake_line(options: Namespace, threads: int, progress: Progress) -> dict[str, Any]:
    volumes, scene = to_light(options, ".vdb")
    settings = {**bake_settings(options), "threads": threads}
    asked = task_of(volumes, scene, **settings).provenance
    complete = _complete(options.out, asked)
    if complete is not None:
        return _results(complete, was_complete=True)
    checkpoint = checkpoint_of(options, resumed=True)
    try:
        checkpoint.arguments(asked)
    except LeaflightError:
        checkpoint = checkpoint_of(options, resumed=False)
    baked = bake(volumes, scene, progress=progress, checkpoint=checkpoint, **settings)
    baked.save(options.out, progress)
    checkpoint.remove()
    return _results(baked, was_complete=False)


_under_way: list[tuple[str, Progress]] = []  # the bakes of this worker


def end_batch(key: str) -> None:
    """Ends the bakes of a batch in this worker; their checkpoints stay."""
    for other, progress in list(_under_way):
        if other == key:
            progress.cancel()


def _results(baked: Bake, was_complete: bool) -> dict[str, Any]:
    statistics = baked.statistics
    return {
        "was_complete": was_complete,
        "nodes": by(baked.volumes[0].values.shape[::-1]),
        "texels": statistics.texels,
        "seconds": statistics.seconds,
        "estimated_error_percent": statistics.estimated_error_percent,
    }


def _bake_all(
    bakes: Sequence[Listed], workers: "Workers", progress: Progress
) -> list[dict[str, Any]]:
    """Returns the results of all bakes, in their order."""
    progress.begin("Bakes")
    progress.expect(len(bakes))
    key = uuid.uuid4().hex
    tasks = [(k, bake_line, (key, one.options, workers.threads)) for k, one in enumerate(bakes)]
    done: list[dict[str, Any]] = [{}] * len(bakes)
    with at_workers(workers, tasks, progress, end_batch, key) as finished:
        for k, future in finished:
            options = bakes[k].options
            names = {"file": " ".join(options.volumes) or options.scene, "output": options.out}
            done[k] = {**names, **_outcome(future)}
            progress.advance(1)
    return done


def _write_table(path: str, done: Sequence[dict[str, Any]]) -> None:
    with replaced(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        table.writeheader()
        # A bake that failed has no output.
        table.writerows({**one, "output": ""} if "failure" in one else one for one in done)


def _outcome(future: "Future") -> dict[str, Any]:
    try:
        done: dict[str, Any] = future.result()
        return done
    except (LeaflightError, MemoryError) as error:
        return {"failure": str(error) or "there is not enough memory."}
    except (Cancelled, CancelledError):
        return {"failure": "its worker was cancelled; run the command again."}
    except Exception as error:  # Dask's own error: the worker died repeatedly
        return {"failure": f"its worker died ({type(error).__name__}); run the command again."}


def _complete(path: str, asked: Provenance) -> Bake | None:
    """Returns the bake of a file if it is complete and of this Provenance."""
    try:
        baked = load_bake(path)
        return baked if baked.provenance.alike(asked) else None
    except LeaflightError:
        return None


def _read_list(options: Namespace) -> list[Listed]:
    """Returns the bakes of a text file."""
    path = options.list
    if options.out or options.each:
        raise LeaflightError(
            f"{path}: --out and --each are for a folder; write them into the list."
        )
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise LeaflightError(f"{path}: cannot read it: {error}.") from None
    bakes = []
    for number, line in enumerate(text.splitlines(), 1):
        words = _words(line, f"{path}, line {number}", comments=True)
        if words:
            bakes.append(_listed(words, path, f"line {number}"))
    if not bakes:
        raise LeaflightError(
            f"{path}: it lists no bakes: give the arguments of one `leaflight bake` per line."
        )
    return _with_writable_outputs(bakes, path)


def _read_folder(options: Namespace) -> list[Listed]:
    """Returns a bake of each volume in a folder."""
    folder, out = Path(options.list), options.out
    if out is None or not os.path.isdir(out) or os.path.samefile(out, folder):
        raise LeaflightError(f"{folder}: give another folder for its bakes with --out.")
    words = _words(options.each or "", "--each")
    bakes = []
    for path in sorted(folder.iterdir()):
        try:
            suffixes = format_of(path).suffixes
        except LeaflightError:
            continue  # a file of another kind
        name = path.name
        known = max((each for each in suffixes if name.lower().endswith(each)), key=len, default="")
        output = Path(out, f"{name[: len(name) - len(known)]}.vdb")
        bakes.append(_listed([str(path), "--out", str(output), *words], str(folder), name))
    if not bakes:
        raise LeaflightError(f"{folder}: it holds no volumes: give another folder.")
    return _with_writable_outputs(bakes, str(folder))


def _words(text: str, place: str, comments: bool = False) -> list[str]:
    lexer = shlex.shlex(text, posix=True, punctuation_chars=False)
    lexer.whitespace_split = True
    if not comments:
        lexer.commenters = ""
    if os.name == "nt":
        lexer.escape = ""  # paths have backslashes
    try:
        return list(lexer)
    except ValueError as error:
        raise LeaflightError(f"{place}: {error}") from None


def _listed(words: Sequence[str], source: str, place: str) -> Listed:
    """Returns the bake with the arguments `words`. source: The list or the folder."""
    # Import these only here, because the package works without its command.
    from leaflight_command.parser import make_parser
    from leaflight_command.shared_options import UsageError

    try:
        options = make_parser().parse_args(["bake", *words])
    except UsageError as error:
        raise LeaflightError(f"{source}, {place}: {error}") from None
    if not options.out or options.previous or options.workers or options.scheduler:
        raise LeaflightError(
            f"{source}, {place}: give VOLUME and --out, but not --continue, --workers or "
            "--scheduler."
        )
    return Listed(place, _anywhere(options))


def _with_writable_outputs(bakes: list[Listed], source: str) -> list[Listed]:
    outs = [one.options.out for one in bakes]
    for place, options in bakes:
        check_writable(options.out, ".vdb")
        if outs.count(options.out) > 1:
            raise LeaflightError(
                f"{source}, {place}: another bake also writes {options.out}; name another file."
            )
    return bakes


def _anywhere(options: Namespace) -> Namespace:
    """Returns the options with absolute paths."""
    options.volumes = [path_anywhere(volume) for volume in options.volumes]
    options.color_by = source_anywhere(options.color_by)
    for name in ("scene", "out", "label_table"):
        value = getattr(options, name)
        setattr(options, name, value and os.path.abspath(value))
    return options
