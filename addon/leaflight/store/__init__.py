# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of volumes and bakes, and their contents in memory."""
