# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common: work in the background, and reasons why one is greyed."""
