# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes on several processes or machines, by Dask (docs/clusters.md).

Dask (Rocklin 2015, https://www.dask.org) starts workers, sends data to them, and moves the work of
dead workers to others. This package defines the work, which gives the same bits on any worker.
"""
