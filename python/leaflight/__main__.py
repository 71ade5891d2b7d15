# SPDX-License-Identifier: GPL-3.0-or-later
import sys

from leaflight_command import main

sys.exit(main())
