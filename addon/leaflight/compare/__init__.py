# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of baked stills with stills of Cycles."""
