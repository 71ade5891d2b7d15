# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders frames of a .blend by workers in background Blenders, and makes a video of them.

It runs in the processes of workers. A frame's file is complete or absent.
"""

import contextlib
import json
import subprocess
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from .._core import Cancelled, LeaflightError
from ..paths import AnyPath

if TYPE_CHECKING:
    from .._core import Progress
    from .workers import Workers

# Number of last characters of Blender's output that an error quotes.
_LAST_WORDS = 300

_RENDER = """
import bpy, json, os, sys
work = json.loads(sys.argv[-1])
scene = bpy.context.scene
image = scene.render.image_settings
if hasattr(image, "media_type"):  # from 5.0 on
    image.media_type = "IMAGE"
image.file_format = "PNG"
scene.render.use_file_extension = False
for number, path in work:
    part = os.path.join(os.path.dirname(path), f".frame_{os.getpid()}.png")
    scene.frame_set(number)
    scene.render.filepath = part
    bpy.ops.render.render(write_still=True)
    os.replace(part, path)
"""

_ASSEMBLE = """
import bpy, json, os, sys
frames, out, fps, size = json.loads(sys.argv[-1])
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = size
scene.render.resolution_percentage = 100
scene.render.fps = fps
scene.view_settings.view_transform = "Standard"
editor = scene.sequence_editor_create()
strips = getattr(editor, "strips", None) or editor.sequences
strip = strips.new_image("frames", frames[0], 1, 1)
for path in frames[1:]:
    strip.elements.append(os.path.basename(path))
strip.frame_final_duration = len(frames)
scene.frame_start, scene.frame_end = 1, len(frames)
image = scene.render.image_settings
if hasattr(image, "media_type"):
    image.media_type = "VIDEO"
image.file_format = "FFMPEG"
scene.render.ffmpeg.format = "MPEG4"
scene.render.ffmpeg.codec = "H264"
scene.render.ffmpeg.constant_rate_factor = "HIGH"
scene.render.use_file_extension = False
scene.render.filepath = out
bpy.ops.render.render(animation=True)
"""

_ASK = """
import bpy, sys
scene = bpy.context.scene
render, share = scene.render, scene.render.resolution_percentage / 100
size = [int(render.resolution_x * share), int(render.resolution_y * share)]
print("FRAMES", [scene.frame_start, scene.frame_end, render.fps, *size])
"""


def ask(blender: AnyPath, blend: AnyPath) -> tuple[int, int, int, int, int]:
    """Returns (first frame, last frame, frames per second, width, height) of a .blend.

    Raises LeaflightError.
    """
    said = _run([blender, "--background", blend, "--python-expr", _ASK])
    line = next((line for line in said.splitlines() if line.startswith("FRAMES ")), None)
    if line is None:
        raise LeaflightError(
            f"{blend}: Blender cannot open this file; check that it is a .blend of this version "
            "or older."
        )
    return tuple(json.loads(line.partition(" ")[2]))


def render(key: str, blender: AnyPath, blend: AnyPath, work: Sequence[tuple[int, str]]) -> None:
    """Renders frames. work: (number, path of the .png) of each frame.

    key: Key for cancel().
    Raises LeaflightError, Cancelled.
    """
    _run([blender, "--background", blend, "--python-expr", _RENDER, "--", json.dumps(work)], key)
    missing = [path for _, path in work if not Path(path).exists()]
    if missing:
        raise LeaflightError(
            f"{missing[0]}: Blender did not render this frame; open the .blend and render it there."
        )


def assemble(
    blender: AnyPath, frames: Sequence[Path], out: Path, fps: int, size: Sequence[int]
) -> None:
    """Makes an .mp4 of pictures in one folder. Raises LeaflightError."""
    work = json.dumps([[str(path) for path in frames], str(out), fps, size])
    options = ["--background", "--factory-startup", "--python-expr", _ASSEMBLE, "--", work]
    _run([blender, *options])
    if not Path(out).exists():
        raise LeaflightError(
            f"{out}: this Blender cannot write videos; make one from the frames, which are "
            "complete."
        )


_lock = threading.Lock()
_running: dict[str | None, subprocess.Popen[str]] = {}  # Blenders, by key
_cancelled: set[str] = set()


def cancel(key: str) -> None:
    """Ends the Blender that this process started under a key, and starts no other."""
    with _lock:
        _cancelled.add(key)
        if key in _running:
            _running[key].kill()


def _run(command: Sequence[AnyPath], key: str | None = None) -> str:
    """Returns the output of Blender.

    Raises LeaflightError if it fails, Cancelled after cancel().
    """
    command = [
        *map(str, command[:1]),
        "-noaudio",
        "--python-exit-code",
        "1",
        *map(str, command[1:]),
    ]
    with _lock:
        if key in _cancelled:
            raise Cancelled("cancelled")
        try:
            process = subprocess.Popen(
                command,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                encoding="utf-8",
                errors="replace",
            )
        except OSError as error:
            raise LeaflightError(
                f"{command[0]}: this program cannot be started: {error.strerror}; give the path "
                "of Blender."
            ) from None
        _running[key] = process
    said, _ = process.communicate()
    with _lock:
        _running.pop(key, None)
        if key in _cancelled:
            raise Cancelled("cancelled")
    if process.returncode:
        raise LeaflightError(f"Blender failed: {' '.join(said[-_LAST_WORDS:].split())}")
    return said


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
