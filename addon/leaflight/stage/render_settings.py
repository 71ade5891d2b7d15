# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings for pictures of baked light, which has no grain: a few samples are enough."""

from .. import versions

# A pixel: of Cycles, whose lamps still have grain before the bake, and of Eevee.
_CYCLES, _EEVEE = 64, 32


def suit_baked_light(scene):
    cycles = getattr(scene, "cycles", None)
    if cycles is not None:
        cycles.samples = min(cycles.samples, _CYCLES)
        cycles.use_denoising = versions.has_denoiser()
    eevee = scene.eevee
    eevee.taa_render_samples = min(eevee.taa_render_samples, _EEVEE)
