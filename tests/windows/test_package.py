# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the package's tests of the short suite in Windows' Python 3.11."""

# Files and tests of tests/python that do not run there, with the reason.
NOT_HERE = {
    **dict.fromkeys(
        ("test_progress_bar.py", "test_saving.py"), "terminals, signals and limits of Linux"
    ),
    **dict.fromkeys(
        (
            *("test_docs.py", "test_laboratory.py", "test_rooms.py", "test_snippets.py"),
            *("test_translations.py", "test_web_page.py"),
        ),
        "programs and sources of this repository, which are the same everywhere",
    ),
    **dict.fromkeys(
        ("test_damaged_files.py", "test_fuzz.py"), "minutes, as Wine starts a process slowly"
    ),
    "test_cli.py::test_ctrl_c_leaves_no_file": "signals of Linux",
    "test_compare.py::test_what_blender_says_when_it_fails": "a shell of Linux in place of Blender",
    "test_hostile_input.py::test_nobody_listens": "a shell of Linux",
    "test_hostile_input.py::test_nrrd_data_stay_in_their_folder": "Wine 8 has no symbolic links",
    "test_notebook.py::test_a_bake_is_shown_as_its_page": "a shell of Linux in place of a browser",
    "test_reader_metaimage.py::test_damaged": "Wine 8 has no symbolic links",
}


def test_package(package_tests, tmp_path):
    # Files that are excluded completely may import modules of Linux.
    left_out = (
        f"--{'deselect' if '::' in name else 'ignore'}=tests/python/{name}" for name in NOT_HERE
    )
    shown = package_tests(
        *("-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow and not machine"),
        *("-o", "pythonpath=validation tests/python", f"--basetemp=Z:{tmp_path}/tests"),
        *("tests/python", *left_out),
    )
    print(shown)
    assert " passed" in shown
