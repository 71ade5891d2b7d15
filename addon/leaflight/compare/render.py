# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders in linear radiance, which restore the user's settings."""

import contextlib
import tempfile
from pathlib import Path

import bpy
from leaflight import LeaflightError
from leaflight.io.images import read_exr

from .. import versions

# Settings of Cycles with paths as long as those of the bake, and without biased shortcuts.
_UNBIASED = {
    "max_bounces": 64,
    "diffuse_bounces": 64,
    "glossy_bounces": 64,
    "transmission_bounces": 64,
    "caustics_reflective": True,
    "caustics_refractive": True,
    "blur_glossy": 0.0,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "light_sampling_threshold": 0.0,
    "use_fast_gi": False,
    "use_denoising": False,
    "use_adaptive_sampling": False,
    "film_exposure": 1.0,
}


@contextlib.contextmanager
def overridden(owner, **values):
    """Sets attributes of `owner` during the context, and restores them."""
    before = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


def cycles_still(scene, samples, seed, transparent=False, **settings):
    """Renders a frame of the scene with Cycles.

    settings: of Cycles, in place of those in _UNBIASED. Returns linear RGBA, float32 (height,
    width, 4), top row first. Raises LeaflightError if the user cancels the render.
    """
    with contextlib.ExitStack() as stack, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "still.exr"
        cycles = {**_UNBIASED, **settings, "samples": samples, "seed": seed}
        stack.enter_context(overridden(scene.cycles, **cycles))
        stack.enter_context(
            overridden(
                scene.render,
                engine="CYCLES",
                filepath=str(path),
                film_transparent=transparent,
                use_border=False,
                use_compositing=False,
                use_sequencer=False,
                use_motion_blur=False,
            )
        )
        stack.enter_context(
            overridden(
                scene.render.image_settings,
                **versions.image_format(
                    file_format="OPEN_EXR", color_mode="RGBA", color_depth="32"
                ),
            )
        )
        bpy.ops.render.render(write_still=True, scene=scene.name)
        if not path.exists():
            raise LeaflightError("The render was cancelled; nothing has changed.")
        return read_exr(path)
