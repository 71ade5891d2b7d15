# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes pictures of the documentation: docs/images.

    validation/run pictures NAME [FILE, DIR or NAME]

guide: lit_walls.png, comparison.png and several_isosurfaces.png
exploded: exploded.webp of engine.vti in DIR
several_cuts: several_cuts.webp of Colin27
first_brain: first_brain_*.png, the window after each click
live: live.png, a lamp that is dragged over the baked volume FILE
stills: README.md's pictures, with vessels if DIR holds aneurism.nrrd
against_cycles: against_cycles.webp; also prints FLIP of Colin27 and of the volumes in DIR
scans: docs/gallery.md's pictures of scans, or of the one scan NAME
colors_and_cuts: the others of docs/gallery.md, of volumes in DIR and of a molecule by PySCF;
    also README.md's first picture
web_page: web_page*.webp, the page of Colin27 in Chromium

All but the last are made through the add-on in Blender. The first five take minutes. The others
take half an hour.
"""

import argparse
import json
import os
import shutil
import subprocess
from pathlib import Path

import driver
import nibabel
from leaflight.volume.particles import nucleons
from PIL import Image
from volume_recipes import COLIN27

from . import web_page
from .sheets import save_webp, sheet
from .skull import write_skull

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
IMAGES = ROOT / "docs" / "images"
WORK = ROOT / "build" / "pictures"
SCANS_FOLDER = ROOT / "build" / "scans"
BRAINS = Path("/usr/share/mricron/templates")
HUMAN = SCANS_FOLDER / "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz"
# Name, file, preset, and standard deviation of smoothing in voxels.
SCANS = (
    ("human", HUMAN, "SKIN", 0),
    ("human_smooth", HUMAN, "SKIN", 1),
    ("macaque", BRAINS / "inia19-t1-brain.nii.gz", "CLAY", 0),
    ("fly", SCANS_FOLDER / "fly_150x256x256.tif", "COPPER", 0),
    ("shell", SCANS_FOLDER / "shell_225x128x128.tif", "IVORY", 0),
    ("bone", SCANS_FOLDER / "bone_128x128x128.tif", "BONE", 0),
)
# File, options to read it, and isovalue of the pairs with Cycles.
PAIRS = (
    (COLIN27, {}, 45.5),
    ("nucleon.raw", {"dims": (41, 41, 41), "value_type": "uint8"}, 100.5),
    ("heptane.nii.gz", {}, 60.5),
    ("aneurism.nrrd", {}, 60.5),
    ("bunny_ct_half.nrrd", {}, 800.5),
)
# Names of the pictures of colors_and_cuts.py.
FIGURES = (
    *("density_by_potential", "orbital", "brain_regions", "microscopy", "tooth_by_gradient"),
    *("head_cut", "engine_cut", "first"),
)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made = (
        *(guide, exploded, several_cuts, first_brain, live, stills),
        *(against_cycles, scans, colors_and_cuts),
    )
    makers = {maker.__name__: maker for maker in made}
    parser.add_argument("name", choices=(*makers, "web_page"))
    parser.add_argument("argument", nargs="?", default="", metavar="FILE, DIR or NAME")
    options = parser.parse_args()
    if options.name == "web_page":
        return web_page.main()
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    makers[options.name](driver.with_addon(WORK / "blender"), options.argument)


def inside(blender, script, *arguments):
    """Runs a script of this folder in background Blender; prints its marked lines."""
    output = blender.run(*driver.NAMED, "--python", HERE / script, "--", *arguments)
    print(
        *(line for line in output.splitlines() if line.startswith(("|", "docs/"))),
        sep="\n",
        flush=True,
    )


def in_window(blender, script, *arguments, size):
    status, output = blender.show(script, *arguments, size=size)
    print(*(line for line in output.splitlines() if line.startswith(("SCAN", "WINDOW"))), sep="\n")
    if status:
        raise driver.BlenderFailed(output)


def guide(blender, _):
    volume = WORK / "volume.nii"
    values = nucleons(64)[0]
    nibabel.save(nibabel.Nifti1Image(values.values.T, values.index_to_world), volume)
    inside(blender, "guide.py", volume, WORK / "bakes", IMAGES)


def exploded(blender, folder):
    inside(blender, "parts_and_cuts.py", "exploded", Path(folder).resolve(), WORK, IMAGES)


def several_cuts(blender, _):
    inside(blender, "parts_and_cuts.py", "several_cuts", WORK, WORK, IMAGES)


def first_brain(blender, _):
    in_window(blender, HERE / "first_brain.py", IMAGES, size=(1280, 800))


def live(blender, volume):
    script = ROOT / "tests" / "blender" / "window" / "drag_lamp.py"
    in_window(blender, script, Path(volume).resolve(), WORK, size=(1024, 640))
    shutil.copy(WORK / "live.png", IMAGES)


def stills(blender, folder):
    download = "apt-get download -qq invesalius-examples && dpkg -x invesalius-examples_*.deb skull"
    subprocess.run(download, shell=True, check=True, cwd=WORK)
    write_skull(
        WORK / "skull/usr/share/doc/invesalius-examples/examples/Cranium.inv3", WORK / "skull.nii"
    )
    inside(blender, "stills.py", Path(folder or "/nonexistent").resolve(), WORK, IMAGES)


def against_cycles(blender, folder):
    print("| volume | isovalue | bake s | FLIP, mean | 95th percentile |")
    print("|---|---|---|---|---|", flush=True)
    rows = []
    for file, options, isovalue in PAIRS:
        path, row = Path(folder or "/nonexistent").resolve() / file, WORK / f"pair_{len(rows)}.png"
        if path.exists():
            work = WORK / path.name.split(".")[0]
            inside(blender, "against_cycles.py", path, work, row, json.dumps(options), isovalue)
            rows.append(Image.open(row))
    save_webp(sheet(rows, 1), IMAGES / "against_cycles.webp", 90)


def scans(blender, only):
    subprocess.run([HERE / "fetch_scans.sh"], check=True)
    for name, file, look, smooth in SCANS:
        if only not in ("", name):
            continue
        in_window(blender, HERE / "scans.py", WORK, file, name, look, smooth, size=(1600, 1000))
        for made, kept in ((f"{name}_baked", f"window_{name}"), (name, name)):
            save_webp(Image.open(WORK / f"{made}.png"), IMAGES / f"{kept}.webp")
        files = (WORK / f"{name}_viewport.png", next((WORK / name).glob("*_cycles.png")))
        both = sheet([Image.open(file) for file in files], 2, gap=0)
        save_webp(both, IMAGES / f"cycles_{name}.webp")


def colors_and_cuts(blender, folder):
    python, packages = ROOT / "build" / "venv" / "bin" / "python", WORK / "packages"
    install = [python, "-m", "pip", "install", "--quiet", "--target", packages, "pyscf"]
    subprocess.run(install, check=True)
    environment = {**os.environ, "PYTHONPATH": str(packages)}
    subprocess.run([python, HERE / "make_molecule.py", WORK], check=True, env=environment)
    folder = Path(folder or "/nonexistent").resolve()
    for name in FIGURES:
        inside(blender, "colors_and_cuts.py", name, folder, WORK, IMAGES)
