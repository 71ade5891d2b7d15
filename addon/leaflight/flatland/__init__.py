# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as height graphs, with isolines that are lit within the plane."""
