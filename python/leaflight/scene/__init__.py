# SPDX-License-Identifier: GPL-3.0-or-later
"""What is lit: isosurfaces, walls and lamps, in plain data."""
