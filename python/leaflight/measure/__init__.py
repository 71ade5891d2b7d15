# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures a bake against a reference: the path tracer of the core, or Cycles."""
