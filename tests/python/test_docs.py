# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the documentation site and the notebook."""

import inspect
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import leaflight
import pytest
from PIL import Image
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]
SITE_PYTHON = ROOT / "build" / "tools-venv" / "bin" / "python"


PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "tests/README.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
]


def page_of(path):
    return path.relative_to(ROOT).as_posix()


def anchors(path):
    """Returns the anchors of a page's headings, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ (.+)$", path.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", text.lower()).replace(" ", "-") for text in headings}


@pytest.mark.parametrize("page", PAGES, ids=page_of)
def test_links_lead_to_files_and_headings(page):
    for target, anchor in re.findall(r"\]\(([^)#: ]*)(?:#([^)]*))?\)", page.read_text()):
        file = page.parent / target if target else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=page_of)
def test_commands_have_the_options_that_pages_give_them(page):
    from leaflight_command.parser import make_parser

    (commands,) = (a.choices for a in make_parser()._actions if a.dest == "command")
    for command, rest in re.findall(r"leaflight (\w+)([^`\n#]*)", page.read_text()):
        if command in commands:
            known = set(commands[command]._option_string_actions)
            own = re.sub('"[^"]*"', "", rest)  # without the arguments of --each
            assert set(re.findall(r"--[a-z-]+", own)) <= known, f"{command}{rest}"


def test_pictures_of_the_guide_fill_the_page():
    """Checks that no picture is enlarged, or has panels that are too small to see."""
    guide = (ROOT / "docs" / "guide.md").read_text()
    for name in re.findall(r"\]\((images/[^)]+\.(?:webp|png))\)", guide):
        with Image.open(ROOT / "docs" / name) as picture:
            assert picture.width >= 960 and picture.height >= 360, name


def test_tests_that_pages_name_are_there():
    readme = ROOT / "tests" / "README.md"
    named = re.findall(r"`([\w./]+\.(?:py|mjs))(?:::(\w+))?`", readme.read_text())
    assert named
    for path, function in named:
        file = readme.parent / path
        assert file.exists(), path
        assert f"def {function}" in file.read_text() if function else True, f"{path}::{function}"


def sphinx(source, site):
    """Builds the site from another folder of pages, as scripts/docs does."""
    command = ["-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", source, site]
    return subprocess.run(
        [SITE_PYTHON, *map(str, command)],
        env={**os.environ, "PYTHONPATH": str(ROOT / "build/release/python")},
        capture_output=True,
        text=True,
        timeout=HANG,
    )


@pytest.fixture(scope="module")
def build_tree():
    if not Path(leaflight.__file__).is_relative_to(ROOT / "build" / "release"):
        pytest.skip("the site is made from the build tree")
    if not SITE_PYTHON.exists():
        pytest.skip("the tools of the site are not installed; run scripts/setup --tests")


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(build_tree, tmp_path):
    site = tmp_path / "site"
    done = subprocess.run(
        [ROOT / "scripts" / "docs", site], capture_output=True, text=True, timeout=HANG
    )
    assert done.returncode == 0 and not done.stderr, done.stderr
    pages = {path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")}
    assert pages <= {path.relative_to(site).with_suffix(".md") for path in site.rglob("*.html")}
    api = (site / "api.html").read_text()
    for name in ("leaflight.bake", "leaflight.export.gltf.write_glb", "leaflight.blender.show"):
        assert f'id="{name}"' in api
    # This text comes from a docstring, with the docstring's line breaks.
    assert "Target error in percent, as rms_percent of compare()" in api
    # This text comes from the parser.
    assert "--both-sides" in (site / "command_line.html").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "link, words",
    [("[x](nowhere.md)", "nowhere.md"), ("[x](guide.md#no-such-heading)", "no-such-heading")],
)
def test_a_link_that_leads_nowhere_fails(build_tree, tmp_path, link, words):
    pages = tmp_path / "docs"
    pages.mkdir()
    for source in (ROOT / "docs").glob("*.py"):
        shutil.copy(source, pages)
    (pages / "guide.md").write_text("# Guide\n")
    (pages / "index.md").write_text(f"# Index\n\n{link}\n\n```{{toctree}}\nguide\n```\n")
    done = sphinx(pages, tmp_path / "site")
    assert done.returncode != 0 and words in done.stderr
    (pages / "index.md").write_text("# Index\n\n[x](guide.md#guide)\n\n```{toctree}\nguide\n```\n")
    assert sphinx(pages, tmp_path / "site").returncode == 0


# Program that runs a notebook as Jupyter does, in a separate kernel, and saves its output.
EXECUTE = """
import sys, nbformat
from nbclient import NotebookClient

notebook = nbformat.read(sys.argv[1], 4)
NotebookClient(notebook, timeout=None).execute()
nbformat.write(notebook, sys.argv[2])
"""


@pytest.mark.slow
def test_the_notebook_is_executed(tmp_path):
    for name in ("nbclient", "ipykernel", "pyvista"):
        pytest.importorskip(name, reason=f"{name} is not installed: run scripts/setup --tests")
    notebook, executed = ROOT / "examples" / "lit_surface.ipynb", tmp_path / "executed.ipynb"
    found = os.pathsep.join(filter(None, map(str, sys.path)))
    done = subprocess.run(
        ["xvfb-run", "--auto-servernum", sys.executable, "-c", EXECUTE, notebook, executed],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": found, "LIBGL_ALWAYS_SOFTWARE": "1"},
        capture_output=True,
        text=True,
        timeout=HANG,
    )
    assert done.returncode == 0, done.stderr
    cells = [cell for cell in json.loads(executed.read_text())["cells"] if "outputs" in cell]
    shown = [
        {kind for output in cell["outputs"] for kind in output.get("data", {})} for cell in cells
    ]
    assert "text/html" in shown[2] and "image/png" in shown[3]
    picture = Image.open(tmp_path / "lit_surface.png").convert("L")
    assert picture.size == (1200, 400) and len(picture.getcolors()) > 50
    assert (tmp_path / "lit_surface.vtp").stat().st_size > 10_000


@pytest.fixture(scope="module")
def plain_docstrings():
    return runpy.run_path(str(ROOT / "docs" / "plain_docstrings.py"))


def rows(lines):
    """Returns the rows of the only table."""
    cells = [line.strip(" *-") for line in lines if line.startswith(("   * - ", "     - "))]
    return [tuple(cells[i : i + 3]) for i in range(0, len(cells), 3)]


def test_parameters_become_a_table(plain_docstrings):
    lines = [
        "Reads a file.",
        "",
        "path: of the file,",
        "    with its suffix. None: takes one; time: seconds",
        'kind ("a", "b"), end: of the values.',
        "Returns a dict: of *all* and `code`.",
    ]
    types = {"path": "str | None", "time": "", "kind": "str", "end": "str"}
    found = plain_docstrings["rewritten"](lines, types)
    assert rows(found) == [
        ("Parameter", "Type", "Description"),
        ("``path``", "``str | None``", "of the file, with its suffix; None: takes one"),
        ("``time``", "", "seconds"),
        ("``kind``, ``end``", "``str``", '("a", "b"): of the values.'),
    ]
    assert found[1] == "Reads a file." and r"Returns a dict: of \*all\* and ``code``." in found


def test_options_are_parameters(plain_docstrings):
    lines = inspect.getdoc(leaflight.bake).splitlines()
    plain_docstrings["_process"](None, None, None, leaflight.bake, None, lines)
    described = " ".join(names for names, *_ in rows(lines))
    for name in ("isovalues", "error", "seed", "on_pass", "checkpoint"):
        assert f"``{name}``" in described


def test_a_paragraph_with_indentation_keeps_its_lines(plain_docstrings):
    found = plain_docstrings["rewritten"](["Use it:", "", "    one", "      two"], {})
    assert found[-6:-1] == ["::", "", "        one", "          two", ""] and not rows(found)
