# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the snippets of docs/*.md on small files with the names that they use."""

import re
import shlex
import shutil
import sys
from pathlib import Path

import leaflight
import nibabel
import numpy as np
import pytest
import tifffile
from PIL import Image
from waiting import run_python

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("scripting", "export", "clusters", "validation")
# Tests of snippets that need other programs, by a word in the snippet.
ELSEWHERE = {
    "blender": "tests/blender/inside/check_scripting.py, test_examples.py",
    "obj.": "tests/blender/inside/check_scrub.py",
    "--scheduler": "test_cluster.py",
    "scheduler=": "test_cluster.py",
    "leaflight render": "tests/blender/test_render.py",
    "validation/": "the program itself",
    "--skip": "test_raw.py",
    "potential.cube": "test_volume_texture.py",
    ".blend": "tests/blender/test_blend.py",
    "--each": "test_batch.py",
    "head_fine.vdb": "what `leaflight batch` reads",
}
# Replacements that make snippets faster, because they use large volumes.
SMALLER = {
    "bump_box(100)": "bump_box(16)",
    "spp=16384": "spp=16",
    "1_000_000": "10_000",
    "samples=64": "samples=4",
    # Small volumes need a smaller error.
    "error=0.7": "error=0.2",
    '"/scratch"': '"."',
}
BEGINNING = """
import leaflight, nibabel, numpy as np
volume = leaflight.read_volume("head.nii.gz")
array, image = np.asarray(volume.values), leaflight.flatland.flatland.bump_box_2d(16)
scene = leaflight.cornell_box()
bake = leaflight.bake(volume, scene, isovalues=(20, 160), error=20.0)
"""


def blocks(page):
    """Returns the indented blocks of a page, which are code."""
    text = (ROOT / "docs" / f"{page}.md").read_text()
    found = re.findall(r"(?:^|\n\n)((?:    .*\n(?:\n(?=    ))?)+)", text)
    return [re.sub(r"^    ", "", block, flags=re.MULTILINE) for block in found]


def snippets(page):
    """Returns (commands, Python) of a page, in order."""
    commands, scripts = [], []
    for block in blocks(page):
        python = []
        for line in block.splitlines():
            if line.startswith("leaflight "):
                commands.append(line.partition("#")[0].strip())
            else:
                python.append(line)
        scripts.append("\n".join(python).strip())
    return commands, [script for script in scripts if script]


def is_elsewhere(code):
    return any(mark in code for mark in ELSEWHERE)


@pytest.fixture
def folder(tmp_path):
    """Makes a folder with the files that snippets read."""
    values = (1.6 * leaflight.bump_box(20).values).T.astype(np.float32)
    centered = np.diag([10.0, 10.0, 10.0, 1.0])
    centered[:3, 3] = -95
    for name, of in (("head", values), ("scan", np.stack([values, values], axis=-1))):
        image = nibabel.Nifti1Image(of, centered)
        image.header.set_xyzt_units("mm")
        nibabel.save(image, tmp_path / f"{name}.nii.gz")
    start = "NRRD0004\ndimension: 3\nsizes: 20 20 20\nencoding: raw\n"
    header = f"{start}type: float\nendian: little\n\n"
    (tmp_path / "scan.nrrd").write_bytes(header.encode() + values.T.tobytes())
    labels = np.zeros((20, 20, 20), np.uint8)
    labels[4:10], labels[10:16] = 3, 5
    header = start + "type: uchar\nspace: right-anterior-superior\nspace origin: (-95,-95,-95)\n"
    header += "space directions: (10,0,0) (0,10,0) (0,0,10)\n\n"
    (tmp_path / "head.seg.nrrd").write_bytes(header.encode() + labels.tobytes())
    segments = np.where(labels == 3, 17, labels).astype(np.int32)
    nibabel.save(nibabel.MGHImage(segments, centered), tmp_path / "aseg.mgz")
    cells = np.stack([values[..., ::step] for step in (1, -1, 1)])
    about = {"axes": "CZYX", "Channel": {"Name": ["DAPI", "GFP", "Cy5"]}}
    path = tmp_path / "cells.ome.tif"
    tifffile.imwrite(path, cells, photometric="minisblack", metadata=about)
    (tmp_path / "bakes.txt").write_text(next(b for b in blocks("clusters") if "head_fine" in b))
    shutil.copy(ROOT / "scenes" / "bump_box.json", tmp_path / "scene.json")
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    return tmp_path


def run(folder, *command):
    done = run_python(*command, paths=filter(None, sys.path), cwd=folder)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_commands_run(folder, page):
    run(folder, "-m", "leaflight_command", "bake", "head.nii.gz", "--out", "head.vdb")
    for command in snippets(page)[0]:
        if not is_elsewhere(command):
            run(folder, "-m", "leaflight_command", *shlex.split(command)[1:])
    if page == "scripting":
        assert np.ptp(np.asarray(Image.open(folder / "head.png"))) > 50


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_python_runs(request, folder, page):
    if page == "validation":
        request.getfixturevalue("thesis")
    run(folder, "-m", "leaflight_command", "bake", "head.nii.gz", "--out", "head.vdb")
    scripts = [script for script in snippets(page)[1] if not is_elsewhere(script)]
    assert scripts, "the page has no Python"
    text = BEGINNING + "\n\n".join(scripts)
    for large, small in SMALLER.items():
        text = text.replace(large, small)
    (folder / "snippets.py").write_text(text)
    run(folder, "snippets.py")


def test_no_page_is_forgotten():
    others = {path.stem for path in (ROOT / "docs").glob("*.md")} - set(PAGES)
    for page in others:
        for block in blocks(page):
            is_code = re.search(r"^leaflight |leaflight\.|import leaflight", block, re.MULTILINE)
            assert not is_code or is_elsewhere(block), f"{page}: {block}"
