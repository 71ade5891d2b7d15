# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of volumes and bakes, and what is held of them in memory."""
