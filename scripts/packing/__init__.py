# SPDX-License-Identifier: GPL-3.0-or-later
"""How scripts/package makes the packages; needs what scripts/setup leaves in build/venv."""
