# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs parts of the tests, one after the other, and prints a table of them: part, seconds, result.

    scripts/test                        the short suite
    scripts/test PART [ARGUMENT ...]    one part; arguments go to its runner (ctest, pytest, ...)
    scripts/test --all [PART ...]       the short suite and the long parts, or the named parts
    scripts/test --all --resume         the same without the parts that passed on this very tree
    scripts/test --list                 the parts and their commands

Exits with 1 if a part fails; the others run all the same. Output: build/test/PART.log.
"""

import hashlib
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

from parts import LONG_PARTS, PARTS, SHORT_PARTS

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "build" / "test"
RESULTS = OUT / "results.json"


def main(arguments):
    if arguments and arguments[0] in ("-h", "--help"):
        print(__doc__.strip())
        return 0
    if arguments == ["--list"]:
        for part in PARTS.values():
            print(f"{part.name:15} {part.command.format(select=part.select)}")
        return 0
    whole, resume = "--all" in arguments, "--resume" in arguments
    if whole:
        chosen = [name for name in arguments if name not in ("--all", "--resume")]
        every, selections = (*SHORT_PARTS, *LONG_PARTS), {}
    else:
        chosen, selections = arguments[:1], {name: arguments[1:] for name in arguments[:1]}
        every = SHORT_PARTS
    chosen = chosen or [part.name for part in every]
    unknown = [name for name in chosen if name not in PARTS]
    if unknown or (resume and not whole):
        wrong = unknown[0] if unknown else "--resume without --all"
        print(f"scripts/test: no part {wrong!r}; see scripts/test --list.", file=sys.stderr)
        return 2
    OUT.mkdir(parents=True, exist_ok=True)
    tree = tree_id()
    earlier = json.loads(RESULTS.read_text()) if resume and RESULTS.exists() else {}
    results = {
        name: result
        for name, result in earlier.items()
        if name in chosen and result["passed"] and result["tree"] == tree
    }
    for name in chosen:
        if name not in results:
            results[name] = run(PARTS[name], selections.get(name), tree)
            if whole:
                RESULTS.write_text(json.dumps({**earlier, **results}, indent=2) + "\n")
    return report({name: results[name] for name in chosen})


def run(part, arguments, tree):
    """Runs a part, shows and keeps its output; returns its line of the table."""
    select = shlex.join(arguments) if arguments else part.select
    command = part.command.format(select=select)
    print(f"== {part.name}: {command}", flush=True)
    begin = time.monotonic()
    with (OUT / f"{part.name}.log").open("wb") as log:
        process = subprocess.Popen(
            ["bash", "-o", "pipefail", "-c", command],
            cwd=ROOT,
            # Node and npm, if the system has none.
            env={**os.environ, "PATH": f"{os.environ['PATH']}:{ROOT / 'build' / 'venv' / 'bin'}"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        while chunk := os.read(process.stdout.fileno(), 1 << 16):
            sys.stdout.buffer.write(chunk)
            sys.stdout.buffer.flush()
            log.write(chunk)
        status = process.wait()
    seconds = round(time.monotonic() - begin)
    return {"passed": status == 0, "seconds": seconds, "tree": tree}


def report(results):
    print(f"\n{'part':15} {'seconds':>7}  result")
    for name, result in results.items():
        print(f"{name:15} {result['seconds']:7}  {'passed' if result['passed'] else 'FAILED'}")
    failed = sum(not result["passed"] for result in results.values())
    total = sum(result["seconds"] for result in results.values())
    print(f"{'all':15} {total:7}\n{len(results) - failed} passed, {failed} failed")
    return 1 if failed else 0


def tree_id():
    """Returns a hash of the contents of all files that git tracks or would add."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    digest = hashlib.sha256()
    for name in sorted(set(listed.stdout.split(b"\0")) - {b""}):
        path = ROOT / os.fsdecode(name)
        if path.is_file():
            digest.update(name + b"\0" + path.read_bytes())
    return digest.hexdigest()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
