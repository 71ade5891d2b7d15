# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside/check_files.py in Windows' Python."""

from pathlib import Path

CHECKS = Path(__file__).resolve().parent / "inside" / "check_files.py"


def test_files(windows, tmp_path):
    shown = windows(
        *("-m", "pytest", "-q", "-p", "no:cacheprovider", "-c", CHECKS.parent / "pytest.ini"),
        *(f"--basetemp=Z:{tmp_path}/checks", CHECKS),
    )
    print(shown)
    assert " passed" in shown
