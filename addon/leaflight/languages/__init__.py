# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages of the interface in other languages, as plain data. Each language has a file."""
