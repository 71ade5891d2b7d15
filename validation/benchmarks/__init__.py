# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast bakes are, with Cycles beside them in the same run: docs/validation/performance.md."""
