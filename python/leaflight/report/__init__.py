# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: error against seconds and the tables of the thesis (extra leaflight[report])."""
