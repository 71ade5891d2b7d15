# SPDX-License-Identifier: GPL-3.0-or-later
"""validation/run report: error against seconds, bakes against Cycles, and the tables of the thesis."""
