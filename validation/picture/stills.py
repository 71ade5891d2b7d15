# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- DATA WORK OUT.

Renders the pictures at the start of README.md. They are a brain in 1080p and a sweep of isovalues
through a head, both of Debian's mricron-data; WORK's skull.nii in 1080p; and vessels if DATA has
aneurism.nrrd.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import bpy
from leaflight import blender

sys.path.append(str(Path(__file__).parent))

from rendering import empty_scene, rendered, turn
from sheets import save_webp

BRAINS = Path("/usr/share/mricron/templates")
ERROR = 1.5
# Sizes, quality and samples of a still, of slices and of the frames of the sweep.
STILL_SIZE, STILL_QUALITY = (1920, 1080), 92
SLICES_ERROR, SLICES_SIZE, SLICES_SAMPLES = 5.0, (960, 540), 128
SWEEP_SIZE, SWEEP_SAMPLES = (400, 400), 24
SWEEP_FRAMES, SWEEP_MILLISECONDS = 48, 90


@dataclass(frozen=True)
class Still:
    """A still.

    Isovalues are in data units. The color is the albedo. The camera turns by `turn` degrees about
    the vertical, and its angle is narrower than Stage's by the factor zoom. If lights_stage is
    True, the bake lights the stage, too. Otherwise Cycles does, with this number of samples.
    """

    path: Path
    preset: str
    isovalue_range: tuple
    isovalue: float
    color: tuple
    turn: float = 0.0
    zoom: float = 1.0
    lights_stage: bool = False
    samples: int = 192


def main():
    data, work, out = map(Path, sys.argv[-3:])
    bone, red = (0.83, 0.77, 0.64), (0.7, 0.16, 0.12)
    stills = {
        "brain": Still(
            BRAINS / "ch2bet.nii.gz", "OPEN_FLOOR", (40, 120), 74.5, (0.85, 0.55, 0.5), -35, 1.7
        ),
        "skull": Still(
            work / "skull.nii", "OPEN_FLOOR", (150, 450), 250.5, bone, 25, 1.8, True, 32
        ),
        "vessels": Still(
            data / "aneurism.nrrd", "LIGHT_TENT", (40, 120), 60.5, red, 0, 1.3, True, 32
        ),
    }
    for name, still in stills.items():
        if still.path.exists():
            render_still(still, work, out / f"{name}.webp")
    render_slices(BRAINS / "ch2.nii.gz", work, out / "slices.webp")
    render_sweep(BRAINS / "ch2.nii.gz", work, out / "sweep.webp")


def render_still(still, folder, picture):
    empty_scene()
    volume = blender.import_volume(still.path)
    stop = volume.leaflight.isosurface_stops.add()
    stop.isovalue, stop.color = still.isovalue, still.color
    turn(volume, 0, 0, still.turn)
    blender.stage(volume, preset=still.preset)
    bpy.context.scene.camera.data.angle /= still.zoom
    settings = {"error": ERROR, "bake_folder": str(folder)}
    settings["light_walls"] = still.lights_stage
    blender.bake(volume, isovalues=still.isovalue_range, **settings)
    blender.show(volume, still.isovalue)
    large = rendered(folder / f"{picture.stem}.png", STILL_SIZE, still.samples)
    save_webp(large, picture, STILL_QUALITY)


def render_slices(path, folder, picture):
    """Renders a translucent head with slices, the orientation cube and a scale bar."""
    empty_scene()
    head = blender.import_volume(path)
    blender.stage(head)
    blender.bake(head, error=SLICES_ERROR, bake_folder=str(folder))
    blender.show(head, 45.5)
    look = head.leaflight_look
    look.opacity, look.slices_inside = 0.3, True
    look.slice_axes, look.slice_places = (True, False, True), (0.52, 0.5, 0.42)
    bpy.ops.leaflight.add_orientation_cube()
    bpy.ops.leaflight.add_scale_bar()
    slices = rendered(folder / f"{picture.stem}.png", SLICES_SIZE, SLICES_SAMPLES)
    save_webp(slices, picture, STILL_QUALITY)


def render_sweep(path, folder, picture):
    empty_scene()
    head = blender.import_volume(path)
    blender.stage(head, "CORNELL")
    settings = {"light_walls": True, "error": ERROR, "bake_folder": str(folder)}
    blender.bake(head, isovalues=(15, 115), **settings)
    frames = []
    for frame in range(SWEEP_FRAMES):
        blender.show(head, 18.0 + 92.0 * frame / (SWEEP_FRAMES - 1))
        frames.append(rendered(folder / f"frame_{frame:03}.png", SWEEP_SIZE, SWEEP_SAMPLES))
    there_and_back = frames + frames[-2:0:-1]
    there_and_back[0].save(
        picture,
        save_all=True,
        append_images=there_and_back[1:],
        duration=SWEEP_MILLISECONDS,
        loop=0,
        quality=70,
        method=6,
    )


main()
