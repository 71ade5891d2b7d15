# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked stills beside Cycles' own."""
