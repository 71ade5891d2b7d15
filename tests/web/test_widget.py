# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the widget of a bake in JupyterLab: a real server, a real kernel, and the browser."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from browser import FRAMES
from waiting import package_folder, started, wait_for

ROOT = Path(__file__).resolve().parents[2]
# scripts/setup --tests installs JupyterLab there.
PYTHON = ROOT / "build" / "tools-venv" / "bin" / "python"
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/")
CELLS = (
    "import leaflight\nwidget = leaflight.load_bake('ball.vdb').widget(60.0, height=300)\nwidget",
    "widget.isovalue = 52.3456",
    "print('now', widget.isovalue)",
    "widget.isovalue = -5",
    "widget",
)
RUN_CELL = "jupyterapp.commands.execute('notebook:run-cell-and-select-next')"
# The page in the output of the first cell, and the one below.
PAGE = "document.querySelectorAll('.jp-OutputArea iframe')[0]?.contentWindow"
OTHER_PAGE = PAGE.replace("[0]", "[1]")
ISOVALUE = "leaflight?.panel.isovalue"
# Text of the output of the cell with this number.
OUTPUT = "document.querySelector('.jp-Cell:nth-child({}) .jp-OutputArea-output')?.textContent ?? ''"
# Output that JupyterLab shows on red.
STDERR = '[data-mime-type="application/vnd.jupyter.stderr"]'

pytestmark = pytest.mark.slow


@pytest.fixture
def lab(tmp_path):
    """Starts JupyterLab in tmp_path. Returns its address."""
    try:
        subprocess.run([PYTHON, "-c", "import jupyterlab, anywidget"], check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("JupyterLab and anywidget are not installed; run scripts/setup --tests")
    folder = tmp_path / "jupyter" / "kernels" / "tested"
    folder.mkdir(parents=True)
    kernel = [str(PYTHON), "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": kernel, "display_name": "tested", "language": "python"}
    (folder / "kernel.json").write_text(json.dumps(spec))
    options = ["--no-browser", "--allow-root", "--expose-app-in-browser", "--port=0"]
    variables = {
        "HOME": str(tmp_path),
        "JUPYTER_PATH": str(tmp_path / "jupyter"),
        "PYTHONPATH": str(package_folder()),
    }
    log = tmp_path / "log"
    with (
        log.open("w") as stderr,
        started(
            [PYTHON, "-m", "jupyterlab", *options, "--IdentityProvider.token=''"],
            cwd=tmp_path,
            env={**os.environ, **variables},
            stderr=stderr,
        ) as server,
    ):
        wait_for(lambda: ADDRESS.search(log.read_text()), lambda: server.poll() is None)
        found = ADDRESS.search(log.read_text())
        assert found, log.read_text()
        yield found[0]
        # Ends its kernels, too.
        server.terminate()
        server.wait()


def notebook(path, cells):
    empty = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    content = {
        "cells": [{**empty, "source": cell} for cell in cells],
        "metadata": {"kernelspec": {"name": "tested", "display_name": "tested"}},
        "nbformat": 4,
        "nbformat_minor": 4,
    }
    path.write_text(json.dumps(content))


def test_python_and_the_slider_move_the_same_isovalue(browser, bakes, lab, tmp_path):
    bakes("ball").save(tmp_path / "ball.vdb")
    notebook(tmp_path / "ball.ipynb", CELLS)
    browser.open(f"{lab}lab/tree/ball.ipynb", {"width": 900, "height": 900, "waits": False})
    browser.awaits("window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel")
    browser.evaluate(RUN_CELL)
    browser.awaits(f"{PAGE}?.document.querySelector('[data-state=rest]')")
    assert browser.evaluate(f"{PAGE}.{ISOVALUE}") == 60.0
    assert browser.evaluate(f"document.querySelectorAll({STDERR!r}).length") == 0

    # Python moves the page, exactly.
    browser.evaluate(RUN_CELL)
    browser.awaits(f"{PAGE}.{ISOVALUE} === 52.3456")

    # The slider of the page changes the trait.
    browser.evaluate(f"{PAGE}.document.querySelector('#isovalue').focus()")
    browser.press(["PageUp"])
    browser.evaluate(FRAMES)
    shown = browser.evaluate(f"{PAGE}.{ISOVALUE}")
    assert 55 < shown < 56
    browser.evaluate(RUN_CELL)
    browser.awaits(OUTPUT.format(3))
    assert browser.evaluate(OUTPUT.format(3)) == f"now {shown}\n"

    # An isovalue without light is refused. Another view of the widget shows the present one.
    browser.evaluate(RUN_CELL)
    browser.awaits(OUTPUT.format(4))
    assert "outside the baked range 20..80" in browser.evaluate(OUTPUT.format(4))
    browser.evaluate(RUN_CELL)
    browser.awaits(f"{OTHER_PAGE}?.{ISOVALUE} === {shown}")
    browser.awaits(f"{OTHER_PAGE}?.document.querySelector('[data-state=rest]')")
    assert not [said for said in browser.requests() if said.startswith("error: ")]
