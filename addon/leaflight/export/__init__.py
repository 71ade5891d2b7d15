# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of bakes for other programs."""
