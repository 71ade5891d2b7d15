# SPDX-License-Identifier: GPL-3.0-or-later
"""What is lit: leaves, surroundings and luminaires, in plain data."""
