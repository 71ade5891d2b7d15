# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar volumes: their values and where they lie; volumes that are generated."""
