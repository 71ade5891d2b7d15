# SPDX-License-Identifier: GPL-3.0-or-later
"""Files: readers of volumes, images, point clouds, scene files, and volumes by name."""
