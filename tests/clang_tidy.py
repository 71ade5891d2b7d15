# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs clang-tidy (.clang-tidy) over the core, after a build: tests/clang_tidy.py [FOLDER ...] Each
file takes ten seconds, mostly for headers.

Therefore the sources of a few folders are checked as one file: names in their unnamed namespaces
must differ.
"""

import json
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "core/src"
OUT = ROOT / "build/test/clang-tidy"
GROUPS = (
    ("base", "field", "surface", "lights", "scene", "io"),
    ("trace", "transport"),
    ("bake",),
    ("thesis",),
)
# Options of a compiler that change what a source means.
MEANING = ("-D", "-I", "-std", "-isystem")


def main(folders):
    OUT.mkdir(parents=True, exist_ok=True)
    groups = [group for group in GROUPS if not folders or set(group) & set(folders)]
    covered = {folder for group in GROUPS for folder in group}
    assert covered == {path.name for path in SOURCES.iterdir() if path.is_dir()} | {"thesis"}
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(check, groups))
    print("".join(found), end="")
    return 1 if any(found) else 0


def check(folders):
    """Returns the findings of clang-tidy in the sources of some folders."""
    above = ROOT / "core" if folders == ("thesis",) else SOURCES
    sources = [path for folder in folders for path in sorted((above / folder).rglob("*.cpp"))]
    whole = OUT / f"{'_'.join(folders)}.cpp"
    whole.write_text("".join(f'#include "{path}"\n' for path in sources))
    options = options_of(sources[0])
    done = subprocess.run(
        ["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", whole, "--", *options],
        capture_output=True,
        text=True,
    )
    if done.returncode == 0:
        return ""
    return done.stdout or done.stderr


def options_of(source):
    commands = json.loads((ROOT / "build/release/compile_commands.json").read_text())
    command = next(entry["command"] for entry in commands if entry["file"] == str(source))
    words = shlex.split(command)
    return [
        word
        for before, word in zip(words, words[1:])
        if word.startswith(MEANING) or before == "-isystem"
    ]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
