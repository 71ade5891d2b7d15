# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes: how they are made, stored, loaded, resumed and relit."""
