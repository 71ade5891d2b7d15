# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site, and the notebook."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import leaflight
import pytest
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]


def sphinx(source, site):
    """What scripts/docs does, of another folder of pages."""
    command = ["-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", source, site]
    return subprocess.run(
        ["/usr/bin/python3", *map(str, command)],
        env={**os.environ, "PYTHONPATH": str(ROOT / "build/release/python")},
        capture_output=True,
        text=True,
        timeout=HANG,
    )


@pytest.fixture(scope="module")
def build_tree():
    if not Path(leaflight.__file__).is_relative_to(ROOT / "build" / "release"):
        pytest.skip("the site is made from the build tree")
    if subprocess.run(["/usr/bin/python3", "-c", "import sphinx, myst_parser"]).returncode:
        pytest.skip("python3-sphinx and python3-myst-parser are not installed")


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(build_tree, tmp_path):
    site = tmp_path / "site"
    done = subprocess.run(
        [ROOT / "scripts" / "docs", site], capture_output=True, text=True, timeout=HANG
    )
    assert done.returncode == 0 and not done.stderr, done.stderr
    pages = {path.stem for path in (ROOT / "docs").glob("*.md")}
    assert pages <= {path.stem for path in site.glob("*.html")}
    api = (site / "api.html").read_text()
    for name in ("leaflight.bake", "leaflight.export.gltf.write_glb", "leaflight.blender.show"):
        assert f'id="{name}"' in api
    # From the docstrings, with their own line breaks.
    assert "percent, of what compare() calls rms_percent" in api


@pytest.mark.slow
@pytest.mark.parametrize(
    "link, words",
    [("[x](nowhere.md)", "nowhere.md"), ("[x](guide.md#no-such-heading)", "no-such-heading")],
)
def test_a_link_that_leads_nowhere_fails(build_tree, tmp_path, link, words):
    pages = tmp_path / "docs"
    pages.mkdir()
    shutil.copy(ROOT / "docs" / "conf.py", pages)
    (pages / "guide.md").write_text("# Guide\n")
    (pages / "index.md").write_text(f"# Index\n\n{link}\n\n```{{toctree}}\nguide\n```\n")
    done = sphinx(pages, tmp_path / "site")
    assert done.returncode != 0 and words in done.stderr
    (pages / "index.md").write_text("# Index\n\n[x](guide.md#guide)\n\n```{toctree}\nguide\n```\n")
    assert sphinx(pages, tmp_path / "site").returncode == 0


def test_the_notebook_runs(tmp_path, monkeypatch):
    pyvista = pytest.importorskip("pyvista", reason="pyvista of PyPI is not installed")
    pyvista.OFF_SCREEN = True
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((ROOT / "examples" / "lit_surface.ipynb").read_text())
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert names["mesh"].n_points > 1000 and names["mesh"]["color"].max() > 100
    from PIL import Image

    picture = Image.open(tmp_path / "lit_surface.png").convert("L")
    assert picture.size == (1200, 400) and len(picture.getcolors()) > 50
    assert (tmp_path / "lit_surface.vtp").stat().st_size > 10_000
