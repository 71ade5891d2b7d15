# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes in the formats of other programs: one format a file."""
