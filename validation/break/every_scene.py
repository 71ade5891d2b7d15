# SPDX-License-Identifier: GPL-3.0-or-later
"""Every kind of scene bakes alike: error, time, passes, kills, threads, workers and settings.

    validation/run every_scene [NAME ...] [--error PERCENT] [--time SECONDS] [--nodes N]

Prints a table and exits with 1 if a scene breaks one of these rules.

- A bake reaches its error, or a sentence says that it did not. So does one that its time ends.

- on_pass is given a bake with light after each pass but the last.

- A bake that SIGKILL ended goes on from its checkpoint, to the bits of an uninterrupted one.

- One and two threads give the same bits. So do two workers, or they are refused.

- Each setting has its effect, is refused, or is named in a warning before the first pass.
"""

import argparse
import hashlib
import json
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import leaflight
import numpy as np
from leaflight import LeaflightError, flatland
from leaflight.bake.checkpoint import Checkpoint
from leaflight.bake.statistics import outcome
from leaflight.cluster.workers import Workers
from leaflight.io.sources import open_volume
from leaflight.scene.scene import Mesh
from volume_recipes import COLIN27

ROOT = Path(__file__).resolve().parents[2]
RUN = ROOT / "validation" / "run"

COLUMNS = (
    *("scene", "error asked for, estimated", "passes", "seconds", "ended by time"),
    *("killed, resumed", "1 and 2 threads", "2 workers", "settings"),
)
# Target errors of bakes whose bits are compared, and of bakes that show a setting's effect.
BITS, ROUGH = 4.0, 50.0
# Target error that no bake reaches, so that the time ends the bake.
NO_ERROR = 0.001


@dataclass(frozen=True)
class Case:
    """A kind of scene. make: returns (volumes, scene) for bake(), given the nodes per axis."""

    name: str
    make: Callable
    settings: dict = field(default_factory=dict)
    bake: Callable = leaflight.bake


def from_file(name):
    """Returns the scene of a file, with the generated volumes that it names."""

    def make(nodes):
        scene = leaflight.load_scene(ROOT / "scenes" / name)
        sources = [isosurfaces.source for isosurfaces in scene.isosurfaces]
        return [open_volume(source, dims=[nodes]) for source in sources], scene

    return make


def brain(nodes):
    """Returns Colin27, with about this many nodes per axis, in the Cornell box."""
    downsample = max(step for step in (1, 2, 4, 8) if 200 / step >= min(nodes, 200))
    return leaflight.read_volume(COLIN27, downsample=downsample), leaflight.cornell_box()


def mirror_ball(nodes):
    """Returns the brain with a mirror ball beside it."""
    volume, scene = brain(nodes)
    vertices, triangles = ball(center=(-1.1, -1.4, -0.79), radius=0.35)
    mesh = Mesh("ball", vertices, triangles, (0.9, 0.9, 0.9), scattering="mirror")
    return volume, replace(scene, meshes=[*scene.meshes, mesh])


def ball(center, radius, steps=24):
    """Returns (vertices, triangles) of a sphere."""
    polar, around = np.meshgrid(
        np.linspace(0, np.pi, steps), np.linspace(0, 2 * np.pi, 2 * steps, False), indexing="ij"
    )
    x, y, z = np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3) * radius + center
    i, j = np.meshgrid(np.arange(steps - 1), np.arange(2 * steps), indexing="ij")
    right = (j + 1) % (2 * steps)
    a, b, c, d = (
        row * 2 * steps + column for row, column in ((i, j), (i + 1, j), (i + 1, right), (i, right))
    )
    faces = np.concatenate(
        [np.stack(one, axis=-1).reshape(-1, 3) for one in ((a, b, c), (a, c, d))]
    )
    corners = vertices[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return vertices.astype(np.float32), faces[area > 1e-9].astype(np.uint32)


def flat(nodes):
    return flatland.bump_box_2d(4 * nodes), None


CASES = (
    Case("brain", brain),
    Case("two nucleons", from_file("nucleons.json")),
    Case("LAPR", from_file("lapr.json")),
    Case("glass isosurface", from_file("glass_isosurface.json"), {"walls": True}),
    Case("mirror ball beside a brain", mirror_ball),
    Case("Flatland", flat, bake=flatland.bake_flatland),
)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [case.name for case in CASES]
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"scenes among {', '.join(names)} (all)"
    )
    parser.add_argument("--error", type=float, default=1.5, help="percent (1.5)")
    parser.add_argument("--time", type=float, default=20.0, help="seconds (20)")
    parser.add_argument("--nodes", type=int, default=32, help="nodes of a volume per axis (32)")
    parser.add_argument(
        "--killed", nargs=2, metavar=("CHECKPOINT", "RESULT"), help=argparse.SUPPRESS
    )
    options = parser.parse_args()
    unknown = set(options.names) - set(names)
    if unknown:
        parser.error(f"there is no scene {', '.join(sorted(unknown))}")
    chosen = [case for case in CASES if not options.names or case.name in options.names]
    if options.killed:
        return leave_checkpoints(chosen[0], options.nodes, *map(Path, options.killed))
    broken = []
    print(f"| {' | '.join(COLUMNS)} |")
    print(f"{'|---' * len(COLUMNS)}|", flush=True)
    for case in chosen:
        row = Row(case, options.nodes)
        print(row.text(options.error, options.time), flush=True)
        broken += [f"{case.name}: {sentence}" for sentence in row.broken]
    for sentence in broken:
        print(sentence, file=sys.stderr)
    return 1 if broken else 0


# Words of outcome() for a missed target: one of them is in each of its reasons.
MISSED = ("not reached", "did not reach", "but not more passes")


class Row:
    """The bakes of one scene. broken: sentences about the rules that it breaks."""

    def __init__(self, case, nodes):
        self.case, self.nodes, self.broken = case, nodes, []
        self.volumes, self.scene = case.make(nodes)

    def text(self, error, seconds):
        cells = [*self.to_error(error), self.to_time(seconds)]
        whole = digest(self.coarse(BITS, threads=1))
        cells += [self.killed(whole), self.threads(whole), self.workers(whole), self.settings()]
        return f"| {' | '.join([self.case.name, *cells])} |"

    def bake(self, **options):
        settings = {**self.case.settings, "progress": False, **options}
        return self.case.bake(self.volumes, self.scene, **settings)

    def coarse(self, error, **options):
        """Returns a bake whose texels are at least as wide as voxels."""
        return self.bake(error=error, **{"resolution": self.nodes, **options})

    def check(self, holds, sentence):
        if not holds:
            self.broken.append(sentence)
        return "same bits" if holds else "NO"

    def to_error(self, error):
        passes = []
        start = time.perf_counter()
        baked = self.bake(error=error, on_pass=passes.append)
        seconds = time.perf_counter() - start
        known = baked.statistics
        reached = known.estimated_error_percent <= error
        said = outcome(baked)
        is_said = reached or any(words in said for words in MISSED)
        self.check(is_said, f"misses its error without a word: {said}")
        self.check(not known.stopped, "stopped before its error, though it had no time limit")
        self.check(len(passes) == known.passes - 1, f"{len(passes)} of {known.passes} passes shown")
        for one in passes:
            self.check(light_of(one) > 0, "a pass shows no light")
        miss = "" if reached else " (finer)" if "finer" in said else " (not reached)"
        errors = f"{error:g} %, {known.estimated_error_percent:.2f} %{miss}"
        return errors, f"{known.passes}", f"{seconds:.1f}"

    def to_time(self, seconds):
        start = time.perf_counter()
        baked = self.bake(error=NO_ERROR, time=seconds)
        taken = time.perf_counter() - start
        known, said = baked.statistics, outcome(baked)
        is_said = not known.stopped or any(words in said for words in MISSED)
        self.check(is_said, f"ends by its time without a word: {said}")
        self.check(light_of(baked) > 0, "no light within its time")
        ended = "" if known.stopped else ", all passes"
        return f"{taken:.1f} s of {seconds:g}, {known.estimated_error_percent:.2f} %{ended}"

    def killed(self, whole):
        with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
            checkpoint, result = Path(folder) / "checkpoint", Path(folder) / "result"
            command = [RUN, "every_scene", self.case.name, "--nodes", str(self.nodes)]
            command += ["--killed", str(checkpoint), str(result)]
            process = subprocess.Popen(command)
            while process.poll() is None and not checkpoint.exists():
                time.sleep(0.002)
            process.send_signal(signal.SIGKILL)
            died = process.wait() == -signal.SIGKILL and checkpoint.exists()
            if not self.check(died and not result.exists(), "left no checkpoint to be killed at"):
                return "NO"
            subprocess.run(command, check=True)
            same = json.loads(result.read_text()) == whole
        return self.check(same, "resumed after a kill it has other bits")

    def threads(self, whole):
        same = digest(self.coarse(BITS, threads=2)) == whole
        return self.check(same, "two threads give other bits than one")

    def workers(self, whole):
        if self.case.bake is not leaflight.bake:
            return "no such setting"
        passes = []
        with Workers(2) as workers:
            try:
                baked = self.coarse(BITS, workers=workers, on_pass=passes.append)
            except LeaflightError as error:
                self.check("orkers share" in str(error) and not passes, f"workers: {error}")
                return "refused"
            self.check(workers.traced > 0, "the workers traced nothing")
        return self.check(digest(baked) == whole, "workers give other bits")

    def settings(self):
        """Tries each setting; returns the names of those that are refused or warned about."""
        rough = self.coarse(ROUGH)
        (lo, hi), plain = rough.isovalues, digest(rough)
        middle = (lo + 0.4 * (hi - lo), lo + 0.6 * (hi - lo))
        shown = {
            "isovalues": (middle, lambda baked: baked.isovalues == middle),
            "resolution": (13, lambda baked: max(grids_of(baked)[0].resolution) == 13),
            "seed": (7, lambda baked: digest(baked) != plain),
            "both_sides": (True, lambda baked: any(grid.has_back for grid in grids_of(baked))),
            "walls": (True, lambda baked: baked.walls is not None),
        }
        named = []
        for name, (value, is_honoured) in shown.items():
            with warnings.catch_warnings(record=True) as warned:
                warnings.simplefilter("always")
                try:
                    honoured = is_honoured(self.coarse(ROUGH, **{name: value}))
                except LeaflightError:
                    named.append(f"{name} refused")
                    continue
            if warned:
                named.append(f"{name} warned of")
            self.check(honoured != bool(warned), f"{name} is ignored, or warned of in vain")
        return ", ".join(named) or "all honoured"


def leave_checkpoints(case, nodes, checkpoint, result):
    """Bakes and writes the digest, in the process that is killed and in the one that resumes."""
    row = Row(case, nodes)
    if checkpoint.exists():
        baked = row.coarse(BITS, checkpoint=Checkpoint(checkpoint, resume=True))
        result.write_text(json.dumps(digest(baked)))
        return 0
    # After a checkpoint, the next pass waits to be killed.
    row.coarse(
        BITS,
        checkpoint=Checkpoint(checkpoint, seconds=0.0),
        on_pass=lambda _: time.sleep(600 * checkpoint.exists()),
    )
    result.write_text("whole")
    return 0


def grids_of(baked):
    return baked.grids if hasattr(baked, "grids") else [baked.grid]


def light_of(baked):
    """Returns the sum of all radiance."""
    light = sum(float(grid.dense("radiance").sum()) for grid in grids_of(baked))
    walls = getattr(baked, "walls", None)
    if walls is not None:
        c = sum(baked.isovalues) / 2
        light += sum(float(walls.radiance(mesh, c, False).sum()) for mesh in range(walls.count))
    return light


def digest(baked):
    """Returns a digest, which is different for bakes with different bits."""
    found = hashlib.sha256(baked.id.encode())
    for grid in grids_of(baked):
        names = ["radiance", "radiance_indirect", "radiance_error"]
        for name in names + ["radiance_back"] * grid.has_back:
            found.update(np.ascontiguousarray(grid.dense(name)).data)
    walls = getattr(baked, "walls", None)
    if walls is not None:
        for c in baked.isovalues:
            for mesh in range(walls.count):
                for back in (False, True):
                    found.update(np.ascontiguousarray(walls.radiance(mesh, c, back)).data)
    return found.hexdigest()
