# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a bake without Blender, by rays of the core."""
