# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of scripts/test: those of the short suite, those of --all, and others."""

from dataclasses import dataclass

# Markers of pytest and labels of ctest (tests/README.md).
SHORT = "-m 'not slow and not machine'"
SLOW = "-m 'slow and not machine'"
RUFF = "build/tools-venv/bin/ruff"
# Checks types of the package and of the add-on, and that the compiled module's stub matches this
# build.
TYPES = (
    "build/tools-venv/bin/mypy && build/tools-venv/bin/mypy --config-file addon/mypy.ini"
    " && build/tools-venv/bin/mypy --config-file validation/mypy.ini"
    " && PYTHONPATH=build/release/python build/tools-venv/bin/pybind11-stubgen"
    " leaflight._core -o build/test/stubs"
    " && diff build/test/stubs/leaflight/_core.pyi python/leaflight/_core.pyi"
)
SCRIPTS = "$(grep -sl '^#!/usr/bin/python3' scripts/* validation/*)"
CODE = f"python addon tests scripts validation examples docs {SCRIPTS}"
PYTEST = "/usr/bin/python3 -m pytest"
# Most of the Python tests keep one processor busy; the tests of a file share their bakes.
PARALLEL = "--numprocesses 2 --dist loadfile"
OPERATORS = "tests/blender/test_window_operators.py"
# The benchmarks, too, since nothing else of the short suite compiles them.
BUILD_CORE = "cmake --preset tests && cmake --build --preset tests && cmake --build --preset bench"


@dataclass(frozen=True)
class Part:
    """A part: one line of the final table.

    command: of bash, in the root of the checkout. {select} in it is replaced by the user's
    arguments after the part's name, or by `select`.
    """

    name: str
    command: str
    select: str = ""


def in_blender(version):
    """Returns the Part with the tests for every version, in a version of Blender from PyPI."""
    path = f"program=$(scripts/blender {version}) && PATH=$program:$PATH"
    return Part(f"blender-{version}", f"{path} {PYTEST} tests/blender {{select}}", SHORT)


SHORT_PARTS = (
    Part(
        "lint",
        "find core python tests -name '*.h' -o -name '*.cpp'"
        " | xargs clang-format --dry-run --Werror"
        f" && {RUFF} format --diff --quiet {CODE} && {RUFF} check --quiet {CODE}"
        f" && {TYPES}"
        " && /usr/bin/python3 tests/clang_tidy.py"
        " && npm --prefix web run --silent check",
    ),
    Part("core", f"{BUILD_CORE} && ctest --preset short {{select}}"),
    Part("python", f"{PYTEST} tests/python {PARALLEL} {{select}}", SHORT),
    Part("web", f"{PYTEST} tests/web {{select}}", SHORT),
    Part("blender", f"{PYTEST} tests/blender {{select}}", SHORT),
)

LONG_PARTS = (
    Part("core-slow", f"{BUILD_CORE} && ctest --preset slow {{select}}"),
    Part(
        "core-sanitized",
        "cmake --preset debug && cmake --build --preset debug && ctest --preset debug {select}",
    ),
    Part(
        "double",
        "cmake --preset double && cmake --build --preset double"
        f" && {PYTEST} tests/python/test_precision.py {{select}}",
    ),
    Part(
        "python-slow",
        f"{BUILD_CORE} && {PYTEST} tests/python {PARALLEL}"
        " --ignore tests/python/test_precision.py {select}",
        SLOW,
    ),
    Part("web-slow", f"{PYTEST} tests/web {{select}}", SLOW),
    Part("blender-slow", f"{PYTEST} tests/blender --ignore {OPERATORS} {{select}}", SLOW),
    # Presses every operator in a window. build/test/window.md then lists how long the window was
    # frozen.
    Part("window", f"{PYTEST} {OPERATORS} {{select}}", SLOW),
    # This part measures time, so nothing else may run.
    Part(
        "machine",
        f"{BUILD_CORE} && ctest --preset machine && {PYTEST} tests/python {{select}}"
        f" && {PYTEST} tests/blender {{select}}",
        "-m machine",
    ),
    in_blender("4.2"),
    in_blender("4.5"),
    in_blender("5.0"),
    Part("package", f"{PYTEST} tests/package {{select}}"),
    # Installs the wheel as a user does, with the newest NumPy.
    Part("wheel", f"tests/wheel {PARALLEL} {{select}}", SHORT),
    # Uses Wine: the packages for Windows, and the add-on in Blender 4.5 for Windows. There, Eevee
    # has OpenGL only on a screen.
    Part(
        "windows",
        "scripts/setup --windows && "
        f"{PYTEST} tests/windows && "
        "program=$(scripts/blender windows-4.5) && PATH=$program:$PATH xvfb-run --auto-servernum "
        f"{PYTEST} tests/blender/test_addon.py -k 'test_in_blender or test_starts' {{select}}",
        "-m 'not machine'",
    ),
    # Reads the files of the packages for macOS, of which nothing runs here.
    Part(
        "macos",
        "scripts/setup --macos && build/tools-venv/bin/python -m pytest tests/macos {select}",
    ),
    Part(
        "fuzz", "validation/run fuzz --minutes 1 --jobs 2 --seed 1 --no-atheris --no-core {select}"
    ),
    Part("faults", "validation/run faults --seed 1 {select}", "--tries 20"),
    Part("races", "validation/run races {select}"),
    Part("every-scene", "validation/run every_scene --time 5 --nodes 16 {select}"),
    Part("mutations", "validation/run mutations {select}"),
    Part("cycles", "validation/run against_cycles --quick --out build/test/cycles {select}"),
    Part("tables", "validation/run tables --quick --out build/test/tables {select}"),
    Part("report", "validation/run report --quick --out build/test/report {select}"),
)

# Parts before a release. 5.2 compiles Python 3.13 (scripts/python3.13), and 5.2-window downloads a
# Debian sid.
RELEASE_PARTS = (in_blender("4.2-numpy2"), in_blender("5.2"), in_blender("5.2-window"))

PARTS = {part.name: part for part in (*SHORT_PARTS, *LONG_PARTS, *RELEASE_PARTS)}
