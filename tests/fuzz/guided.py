# SPDX-License-Identifier: GPL-3.0-or-later
"""Fuzzes one target with Atheris: libFuzzer, guided by the lines of Python that a file reaches.

guided.py TARGET FOLDER [OPTION OF LIBFUZZER...]
"""

import sys
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["leaflight"]):
    import leaflight.cli  # noqa: F401
    import leaflight.io.readers.reading  # noqa: F401
    from leaflight.io.readers.formats import FORMATS

    for kind in FORMATS:
        try:
            __import__(f"leaflight.io.readers.{kind.module}")
        except ImportError:
            pass

from targets import BY_NAME, check, seeds_of  # noqa: E402


def main(name, folder, *options):
    target, folder = BY_NAME[name], Path(folder)
    corpus = folder / "corpus"
    corpus.mkdir(exist_ok=True)
    for number, data in enumerate(seeds_of(target, folder)):
        (corpus / f"seed{number}").write_bytes(data)
    atheris.Setup([sys.argv[0], *options, str(corpus)], lambda data: check(target, folder, data))
    atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
