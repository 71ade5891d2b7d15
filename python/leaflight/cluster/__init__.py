# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes on several processes or machines, by Dask (docs/clusters.md).

Dask (Rocklin 2015, https://www.dask.org) starts workers, sends them what they need, moves the work
of those that die to others and says who is there; what is done there, and why it makes no
difference who does it, is ours.
"""
