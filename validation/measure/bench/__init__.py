# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the speed of bakes, rays and changes of the isovalue: docs/validation/performance.md.

validation/run bench bake|scale|rays|scrub|stage [--quick] [--data DIR] [--out FILE.md]
"""

import argparse
from pathlib import Path

from .bakes import bakes_section
from .page import check_page, write_page
from .rays import rays_section
from .scale import scale_section
from .scrub import scrub_section
from .stage import stage_section

SECTIONS = {
    "bake": bakes_section,
    "scale": scale_section,
    "rays": rays_section,
    "scrub": scrub_section,
    "stage": stage_section,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "what",
        choices=SECTIONS,
        help="bake: against Cycles to the same error; scale: by size and threads; rays: against "
        "Embree; scrub: isovalues against VTK, and in Blender; stage: clicks in a "
        "window",
    )
    parser.add_argument("--quick", action="store_true", help="tiny, to see that it works")
    parser.add_argument("--data", type=Path, metavar="DIR", help="folder of real volumes")
    parser.add_argument("--only", default="", metavar="TEXT", help="cases with this in their name")
    parser.add_argument("--out", type=Path, metavar="FILE.md", help="document with the tables")
    options = parser.parse_args()
    if options.out and (options.quick or options.only):
        parser.error("--out writes whole tables alone; leave out --quick and --only")
    if options.out:
        check_page(options.out, options.what)
    lines = SECTIONS[options.what](options)
    print("\n".join(lines))
    if options.out:
        write_page(options.out, options.what, lines)
