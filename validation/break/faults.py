# SPDX-License-Identifier: GPL-3.0-or-later
"""Interrupts Leaflight: kills it, fills disks, limits memory and removes input; then looks for
losses.

A trial is lost unless the old file is unchanged or a complete new one has replaced it. It is
unclean if the next run leaves other files behind. It is also unclean if a process that was not
killed fails without exactly one sentence. All other trials survive.
"""

import argparse
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import driver
import leaflight
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "build" / "release" / "python"

# Program that saves a checkpoint after each block, so that there are some when it is killed. It
# reports if the package refuses to load.
HURRIED = """
import sys
from leaflight_command import main
try:
    from leaflight.bake import checkpoint
    checkpoint.SECONDS = 0.1
except (ImportError, MemoryError):
    pass
sys.exit(main(sys.argv[1:]))
"""
SAVE = "import sys, leaflight; b = leaflight.load_bake(sys.argv[1])\n"
SAVE += "while True: b.save(sys.argv[2])"
SURFACE = "import sys, leaflight; from leaflight.export.ply import write_ply\n"
SURFACE += "s = leaflight.load_bake(sys.argv[1]).surface(47.0)\n"
SURFACE += "while True: write_ply(sys.argv[2], s, 1.0)"
BLENDER_MAKE = """
import bpy, sys, leaflight.blender as lb
obj = lb.import_volume(sys.argv[-2], spacing=(0.1, 0.1, 0.1))
lb.stage(obj)
lb.bake(obj, error=8.0)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""
# Program that saves as if for the first time, each time, so that the bake moves with the file.
BLENDER_SAVE = """
import bpy, os
from leaflight_addon.store import atlases, bake_files
print("READY", flush=True)
number = 0
while True:
    number += 1
    bpy.context.scene["number"] = number
    for obj in [obj for obj in bpy.data.objects if obj.leaflight.bake_id]:
        path, folder = bake_files.locate(obj), bake_files.session_folder()
        folder.mkdir(parents=True, exist_ok=True)
        for file in (*atlases.beside(path), path):
            os.rename(file, folder / file.name)
        bake_files.remember(obj, folder / path.name)
    bpy.ops.wm.save_mainfile()
"""
BLENDER_LOOK = """
import bpy
from leaflight.bake.load_bake import load_bake
from leaflight_addon.store import bake_files
lit = [obj for obj in bpy.data.objects if obj.leaflight.bake_id]
assert lit
for obj in lit:
    assert load_bake(bake_files.locate(obj)).id == obj.leaflight.bake_id
print("WHOLE", bpy.context.scene.get("number", 0), flush=True)
"""


def environment(**more):
    return {**os.environ, "PYTHONPATH": str(PACKAGE), **more}


class Workplace:
    """A folder with a small volume, a bake of it, and the two files that a bake may leave."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.volume = self.folder / "box.npy"
        np.save(self.volume, leaflight.bump_box(28).values)
        self.out = self.folder / "out" / "x.vdb"
        self.out.parent.mkdir()
        self.options = ["bake", str(self.volume), "--isovalues", "30", "70"]
        self.good = self.folder / "good.vdb"
        self.command(*self.options, "--error", "8", "--out", str(self.good))
        self.before = self.good.read_bytes()
        self.final = leaflight.load_bake(self._final()).id

    def _final(self):
        path = self.folder / "final.vdb"
        start = time.monotonic()
        self.command(*self.bake(path))
        self.seconds = time.monotonic() - start
        return path

    def bake(self, out):
        return [*self.options, "--error", "1", "--out", str(out)]

    def command(self, *arguments):
        line = [sys.executable, "-c", HURRIED, *arguments]
        subprocess.run(line, env=environment(), check=True, capture_output=True)

    def reset(self, out=None):
        out = out or self.out
        shutil.rmtree(out.parent)
        out.parent.mkdir()
        out.write_bytes(self.before)

    def judge(self, out=None, of_any=False):
        """Judges the state of the bake. of_any: True if another name of the volume changes
        the id.
        """
        out = out or self.out
        if not out.exists():
            return "lost"
        if out.read_bytes() == self.before:
            return "survived"
        try:
            identifier = leaflight.load_bake(out).id
            return "survived" if of_any or identifier == self.final else "lost"
        except leaflight.LeaflightError:
            return "lost"


def start(code, *arguments, **options):
    line = [sys.executable, "-c", code, *map(str, arguments)]
    null = subprocess.DEVNULL
    return subprocess.Popen(line, env=environment(), stdout=null, stderr=null, **options)


def kill_after(process, seconds):
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.wait()


def left_behind(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(".leaflight-")]


def kill_bake(place, chance):
    """Kills a bake over an older one at a random moment. Half of those with a checkpoint are
    resumed.
    """
    place.reset()
    kill_after(start(HURRIED, *place.bake(place.out)), chance.uniform(0.2, 1.1) * place.seconds)
    found = place.judge()
    if found == "survived" and Path(f"{place.out}.checkpoint").exists() and chance.random() < 0.5:
        done = subprocess.run(
            [sys.executable, "-c", HURRIED, "bake", "--resume", str(place.out)],
            env=environment(),
            capture_output=True,
        )
        resumed = place.out.read_bytes() != place.before and place.judge() == "survived"
        if done.returncode or not resumed or left_behind(place.out.parent):
            return "unclean"
    return found


def kill_save(place, chance):
    place.reset()
    process = start(SAVE, place.folder / "final.vdb", place.out)
    wait_for(lambda: place.out.read_bytes() != place.before or process.poll() is not None)
    kill_after(process, chance.uniform(0, 0.3))
    found = place.judge()
    leaflight.load_bake(place.good).save(place.out)
    return "unclean" if left_behind(place.out.parent) else found


def kill_surface(place, chance):
    import meshio

    path = place.out.parent / "x.ply"
    process = start(SURFACE, place.good, path)
    wait_for(lambda: path.exists() or process.poll() is not None)
    kill_after(process, chance.uniform(0, 0.2))
    mesh, right = meshio.read(path), leaflight.load_bake(place.good).surface(47.0)
    whole = len(mesh.points) == len(right.vertices) and "red" in mesh.point_data
    return "survived" if whole else "lost"


def wait_for(condition):
    end = time.monotonic() + 120
    while not condition() and time.monotonic() < end:
        time.sleep(0.002)


def limited(place, arguments, out, **limits):
    """Runs a command with limits of the system over a good bake at `out`."""

    def lower():
        for name, value in limits.items():
            resource.setrlimit(getattr(resource, name), (value, value))

    done = subprocess.run(
        [sys.executable, "-c", HURRIED, *map(str, arguments)],
        env=environment(),
        capture_output=True,
        text=True,
        preexec_fn=lower,
    )
    return judged(done, place.judge(out))


def judged(done, found):
    """Checks that a process which ends by itself prints one sentence. A warning about a checkpoint
    that cannot be written may precede it; it does not end a bake.
    """
    lines = [line for line in done.stderr.splitlines() if not line.startswith("bake: ")]
    if len(lines) == 2 and ".checkpoint' cannot be written" in lines[0]:
        lines = lines[1:]
    ended = done.returncode == 0 or (done.returncode == 2 and len(lines) == 1)
    if found == "survived" and not ended:
        print(f"  ended with {done.returncode}: {' | '.join(lines)[-300:]}")
        return "unclean"
    return found


def full_disk(place, chance):
    """Returns a disk with room for part of the bake: a small file system for root, else a limit."""
    room = chance.randrange(1 << 10, 2 * len(place.before))
    if os.geteuid():
        place.reset()
        return limited(place, place.bake(place.out), place.out, RLIMIT_FSIZE=room)
    disk = place.folder / "disk"
    disk.mkdir(exist_ok=True)
    size = (len(place.before) + 4096 + room) // 4096 * 4096
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk], check=True)
    try:
        out = disk / "x.vdb"
        out.write_bytes(place.before)
        found = limited(place, place.bake(out), out)
        return "unclean" if left_behind(disk) else found
    finally:
        subprocess.run(["umount", disk], check=True)


def read_only(place, _chance):
    place.reset()
    if os.geteuid():
        place.out.parent.chmod(0o555)
    else:
        mount = ["mount", "--bind", place.out.parent, place.out.parent]
        subprocess.run(mount, check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", place.out.parent], check=True)
    try:
        return limited(place, place.bake(place.out), place.out)
    finally:
        if os.geteuid():
            place.out.parent.chmod(0o755)
        else:
            subprocess.run(["umount", place.out.parent], check=True)


def little_memory(place, chance):
    """Limits the memory at random, from too little for a start to more than enough."""
    place.reset()
    bytes = chance.randrange(100, 2000) << 20
    return limited(place, place.bake(place.out), place.out, RLIMIT_AS=bytes)


def lost_input(place, chance):
    """Truncates, empties or removes the volume while the program starts to read it."""
    place.reset()
    volume = place.folder / "lost.npy"
    shutil.copyfile(place.volume, volume)
    arguments = [str(volume) if a == str(place.volume) else a for a in place.bake(place.out)]
    process = subprocess.Popen(
        [sys.executable, "-c", HURRIED, *arguments],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(chance.uniform(0, 0.5 * place.seconds))
    if chance.random() < 0.5:
        volume.unlink()
    else:
        os.truncate(volume, chance.randrange(0, 80_000))
    out, err = process.communicate()
    done = subprocess.CompletedProcess(arguments, process.returncode, out, err)
    return judged(done, place.judge(of_any=True))


class BlenderSaves:
    """A Blender that saves a lit .blend repeatedly, until it is killed."""

    def __init__(self):
        self.blender = None

    def prepare(self, place):
        folder = place.folder / "blender"
        self.blender = driver.with_addon(folder)
        self.blend = place.folder / "x.blend"
        self.blender.run("--python-expr", BLENDER_MAKE, "--", place.volume, self.blend)
        assert self.blend.exists()

    def __call__(self, place, chance):
        if self.blender is None:
            self.prepare(place)
        script = "--python-expr", BLENDER_SAVE
        with self.blender.start(self.blend, *script, stderr=subprocess.DEVNULL) as process:
            while "READY" not in (process.stdout.readline() or "READY"):
                pass
            time.sleep(chance.uniform(0, 0.5))
            process.kill()
        try:
            whole = "WHOLE" in self.blender.run(self.blend, "--python-expr", BLENDER_LOOK)
        except driver.BlenderFailed as problem:
            print(problem)
            whole = False
        return "survived" if whole else "lost"


FAULTS: dict[str, tuple[Callable, float]] = {
    "kill a bake": (kill_bake, 1.0),
    "kill a save": (kill_save, 1.0),
    "kill a surface": (kill_surface, 1.0),
    "kill a Blender that saves": (BlenderSaves(), 0.1),
    "full disk": (full_disk, 0.3),
    "read-only folder": (read_only, 0.02),
    "little memory": (little_memory, 0.3),
    "lost input": (lost_input, 0.3),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--tries",
        type=int,
        default=100,
        help="trials per kind of kill, fewer of others (100)",
    )
    parser.add_argument("--only", action="append", choices=FAULTS, help="(all)")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="(the time)")
    options = parser.parse_args()
    print(f"seed {options.seed}")
    print(f"{'fault':26} {'tried':>6} {'survived':>9} {'unclean':>8} {'lost':>5}")
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        place = Workplace(folder)
        for name in options.only or FAULTS:
            fault, share = FAULTS[name]
            found = {"survived": 0, "unclean": 0, "lost": 0}
            tries = max(1, round(share * options.tries))
            for number in range(tries):
                found[fault(place, random.Random(f"{options.seed} {name} {number}"))] += 1
            bad += tries - found["survived"]
            print(
                f"{name:26} {tries:6} {found['survived']:9} {found['unclean']:8} {found['lost']:5}",
                flush=True,
            )
    sys.exit(1 if bad else 0)
