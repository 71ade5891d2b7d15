# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the packages for scripts/package. It needs build/venv from scripts/setup."""
