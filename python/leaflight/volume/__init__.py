# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar volumes: their values and positions; generated volumes."""
