# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a bake without Blender: the core's own rays."""
