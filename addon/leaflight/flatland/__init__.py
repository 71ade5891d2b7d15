# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as graphs of their height, with isolines that are lit within the plane."""
