# SPDX-License-Identifier: GPL-3.0-or-later
"""The command render: renders the frames of a .blend by workers, and makes a video of them.

The .blend has keyframes of the isovalue, the camera or anything else. Workers of a scheduler need
the same shared files and a Blender with the add-on.
"""

import os
import uuid
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._core import Cancelled, LeaflightError, Progress
from ..cluster import frames
from ..cluster.frames import at_workers
from ..io.output import check_writable, replaced
from ..progress_bar import run_with_progress
from .lighting import workers_of
from .output import Output

if TYPE_CHECKING:
    from distributed import Future

    from ..cluster.workers import Workers

# Starting Blender and opening the file takes as long as some small frames.
FRAMES_A_TASK = 4
VIDEO = ".mp4"


def run_render(options: Namespace) -> Output:
    blend, out = Path(options.blend).absolute(), Path(options.out).absolute()
    if not blend.is_file():
        raise LeaflightError(f"{blend}: there is no such file; give a saved .blend.")
    is_video = out.suffix.lower() == VIDEO
    if is_video:
        check_writable(out, VIDEO)
    folder = out.with_name(f"{out.stem}_frames") if is_video else out
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LeaflightError(f"{folder}: cannot make this folder: {error.strerror}.") from None

    def work(progress: Progress) -> dict[str, Any]:
        progress.begin("Opening the .blend")
        first, last, fps, *size = frames.ask(options.blender, blend)
        first, last = options.frames or (first, last)
        if first > last:
            raise LeaflightError(
                f"The frame range {first}..{last} is empty: give the first frame first."
            )
        paths = {number: folder / f"{number:04}.png" for number in range(first, last + 1)}
        left = [number for number, path in paths.items() if not _is_rendered(path, blend)]
        progress.expect(len(paths))
        progress.advance(len(paths) - len(left))
        if left:
            with workers_of(options, progress, least=1) as workers:
                assert workers is not None
                _render_all(workers, options.blender, blend, paths, left, progress)
        for part in folder.glob(".frame_*.png"):
            part.unlink(missing_ok=True)  # a killed Blender left it
        if is_video:
            progress.begin("Video")
            with replaced(out) as temporary:
                frames.assemble(options.blender, list(paths.values()), temporary, fps, size)
        return {"out": str(out), "frames": len(paths), "rendered": len(left)}

    goes_on = "cancelled; run the same command to continue."
    result = run_with_progress(work, "render", writes=True, cancelled=goes_on)
    there = result["frames"] - result["rendered"]
    return result, [
        f"{out}: {result['frames']} frames, {there} of them already complete"
        + (f"; they are in {folder}" if is_video else "")
    ]


def _is_rendered(path: Path, blend: Path) -> bool:
    """Returns True if a frame exists and is newer than the .blend."""
    try:
        return path.stat().st_mtime > blend.stat().st_mtime
    except OSError:
        return False


def _render_all(
    workers: "Workers",
    blender: str,
    blend: Path,
    paths: Mapping[int, Path],
    left: Sequence[int],
    progress: Progress,
) -> None:
    progress.begin("Frames")
    key = uuid.uuid4().hex
    parts = [left[i : i + FRAMES_A_TASK] for i in range(0, len(left), FRAMES_A_TASK)]
    tasks = []
    for part in parts:
        work = [(number, os.fspath(paths[number])) for number in part]
        tasks.append((len(part), frames.render, (key, blender, os.fspath(blend), work)))
    with at_workers(workers, tasks, progress, frames.cancel, key) as finished:
        for count, future in finished:
            _raise_what_failed(future)
            progress.advance(count)


def _raise_what_failed(future: "Future") -> None:
    try:
        future.result()
    except (LeaflightError, Cancelled):
        raise
    except Exception as error:  # Dask's own error: the worker died repeatedly
        raise LeaflightError(
            f"A worker died ({type(error).__name__}): run the same command to continue."
        ) from None
