# SPDX-License-Identifier: GPL-3.0-or-later
"""Measuring a bake against the truth: the path tracer of the core, or Cycles."""
