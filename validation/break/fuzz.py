# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads damaged files of every kind and looks for crashes and other failures.

Half of the time files are damaged at random. The seed is printed, so that a run can be repeated.
The other half is Atheris (libFuzzer), if pip can install it into build/venv-fuzz. Targets core-...
test only the C++ core: libFuzzer with sanitizers. They need Clang (Debian's package clang). Files
that break the program are stored in build/fuzz/failures.
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core_targets import CORE_TARGETS, CoreTarget
from targets import TARGETS, missing_library, seeds_of

ROOT = Path(__file__).resolve().parents[2]
FUZZ = ROOT / "tests" / "fuzz"
FAILURES = ROOT / "build" / "fuzz" / "failures"
VENV = ROOT / "build" / "venv-fuzz"
PACKAGE = ROOT / "build" / "release" / "python"
CORE = ROOT / "build" / "fuzz" / "tests" / "fuzz" / "core"
LEAKS = ROOT / "tests" / "core" / "lsan.supp"
# Seconds of a process that tries file after file. The next process starts with fresh memory.
BATCH_SECONDS = 60


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=1, help="for each target (1)")
    parser.add_argument("--target", action="append", help="one of them, may be repeated (all)")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="(the time)")
    parser.add_argument("--jobs", type=int, default=1, help="targets tried at once (1)")
    parser.add_argument("--no-atheris", action="store_true", help="damage at random alone")
    parser.add_argument("--no-core", action="store_true", help="the command line's targets alone")
    options = parser.parse_args()
    known = {target.name: target for target in (*TARGETS, *CORE_TARGETS)}
    unknown = set(options.target or ()) - known.keys()
    if unknown:
        parser.error(f"there is no target {unknown.pop()}; known: {', '.join(known)}")
    chosen = [known[name] for name in options.target or known]
    of_core = [target for target in chosen if isinstance(target, CoreTarget)]
    if of_core and (options.no_core or not core_is_built()):
        chosen = [target for target in chosen if target not in of_core]
    guided = None if options.no_atheris else atheris_python()
    print(f"seed {options.seed}, {'with' if guided else 'without'} Atheris", flush=True)
    print(f"{'target':15} {'tried':>8} {'accepted':>8} {'guided':>8} {'slowest':>8}  failures")

    def tried(target):
        if target in of_core:
            return fuzz_core(target, 60 * options.minutes, options.seed)
        why = missing_library(target)
        if why:
            print(f"{target.name:15} left out: {why}", flush=True)
            return 0
        return fuzz(target, 60 * options.minutes, options.seed, guided)

    with ThreadPoolExecutor(options.jobs) as at_once:
        failures = sum(at_once.map(tried, chosen))
    sys.exit(1 if failures else 0)


def fuzz(target, seconds, seed, guided):
    """Tries one target for this many seconds; prints a line and returns the number of failures."""
    end = time.monotonic() + (seconds / 2 if guided else seconds)
    tried = accepted = failures = batch = 0
    slowest = 0.0
    while time.monotonic() < end:
        batch += 1
        with tempfile.TemporaryDirectory() as folder:
            left = min(BATCH_SECONDS, end - time.monotonic())
            command = [sys.executable, FUZZ / "worker.py", target.name, folder]
            done = run([*command, f"{seed}.{batch}", str(left), "1000000000"], 3 * BATCH_SECONDS)
            if done.returncode == 0:
                found = json.loads(done.stdout.splitlines()[-1])
                tried, accepted = tried + found["tried"], accepted + found["accepted"]
                slowest = max(slowest, found["slowest"])
            else:
                failures += 1
                keep(target, Path(folder, "trying"), done.stderr)
    runs = 0
    if guided:
        with tempfile.TemporaryDirectory() as folder:
            command = [guided, FUZZ / "guided.py", target.name, folder]
            runs, found = libfuzzer(target, command, folder, seconds / 2)
            failures += found
    print(
        f"{target.name:15} {tried:8} {accepted:8} {runs:8} {slowest:7.1f}s  {failures}", flush=True
    )
    return failures


def fuzz_core(target, seconds, seed):
    """Fuzzes a target of the core; see fuzz()."""
    with tempfile.TemporaryDirectory() as folder:
        corpus = Path(folder, "corpus")
        corpus.mkdir()
        for number, data in enumerate(seeds_of(target, folder)):
            (corpus / f"seed{number}").write_bytes(data)
        command = [CORE / f"fuzz_{target.file}", corpus, f"-seed={seed % 2**32 or 1}"]
        runs, failures = libfuzzer(target, command, folder, seconds)
    print(f"{target.name:15} {'':8} {'':8} {runs:8} {'':8}  {failures}", flush=True)
    return failures


def libfuzzer(target, command, folder, seconds):
    """Runs a libFuzzer program for this many seconds; returns its tries and its failures."""
    limits = [f"-max_total_time={int(max(1, seconds))}", "-timeout=60", "-rss_limit_mb=3000"]
    limits += ["-report_slow_units=60"]
    # Memory that is allocated but not used does not count.
    limits += ["-malloc_limit_mb=6000", "-max_len=200000", f"-artifact_prefix={folder}/bad-"]
    done = run([*command, *limits], seconds + 150, TMPDIR=folder)
    count = re.findall(r"(?:Done |#)(\d+)", done.stderr)
    files: list[Path | None] = list(Path(folder).glob("bad-*"))
    if done.returncode and not files:
        files = [None]
    for file in files:
        keep(target, file, done.stderr)
    return int(count[-1]) if count else 0, len(files)


def core_is_built():
    """Builds the targets of the core; prints one sentence if there is no Clang."""
    if shutil.which("clang++") is None:
        print("The targets of the core are left out: there is no clang++, of Debian's clang.")
        return False
    print("building the targets of the core", flush=True)
    for command in (["cmake", "--preset", "fuzz"], ["cmake", "--build", "--preset", "fuzz"]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return True


def run(command, seconds, **more):
    environment = {**os.environ, "PYTHONPATH": f"{PACKAGE}:{FUZZ}", **more}
    environment["LSAN_OPTIONS"] = f"suppressions={LEAKS}"
    try:
        return subprocess.run(
            list(map(str, command)),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            env=environment,
        )
    except subprocess.TimeoutExpired as late:
        text = (late.stderr or b"").decode("utf-8", "replace")
        return subprocess.CompletedProcess(command, 124, "", f"{text}\nit did not end\n")


def keep(target, file, text):
    FAILURES.mkdir(parents=True, exist_ok=True)
    name = f"{target.name}-none"
    if file is not None and file.exists():
        data = file.read_bytes()
        name = f"{target.name}-{hashlib.sha256(data).hexdigest()[:12]}"
        (FAILURES / f"{name}{target.suffix}").write_bytes(data)
    (FAILURES / f"{name}.txt").write_text(text[-20000:])
    last = [line for line in text.splitlines() if line.strip()][-1:]
    print(f"  {name}: {' '.join(last)[:200]}", flush=True)


def atheris_python():
    """Returns the Python of an environment with Atheris, or None if it cannot be installed."""
    python = VENV / "bin" / "python"
    test = [str(python), "-c", "import atheris, numpy"]
    if python.exists() and subprocess.run(test, capture_output=True).returncode == 0:
        return python
    shutil.rmtree(VENV, ignore_errors=True)
    for command in (
        [sys.executable, "-m", "venv", "--system-site-packages", str(VENV)],
        [str(python), "-m", "pip", "install", "--quiet", "atheris"],
        test,
    ):
        if subprocess.run(command, capture_output=True).returncode:
            return None
    return python
