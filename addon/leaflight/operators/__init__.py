# SPDX-License-Identifier: GPL-3.0-or-later
"""Common code of operators: background work, and reasons why an operator is disabled."""
