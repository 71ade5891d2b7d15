#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fetches scans into build/scans: a human brain (MNI152) from the package nilearn of PyPI; a fly, a shell and a bone from qim3d.
# The packages are downloaded and not installed.
set -euo pipefail
cd "$(dirname "$0")/../.."

scripts/setup
work=build/scans
mkdir -p "$work"

# PACKAGE FILE...: those that are not there yet.
fetch() {
    local package=$1 file
    shift
    for file; do
        [ -e "$work/$file" ] && continue
        build/venv/bin/python -m pip download --quiet --no-deps --dest "$work" "$package"
        unzip -q -o -j "$work/$package"-*.whl "*/$file" -d "$work"
    done
}
fetch nilearn mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz
fetch qim3d fly_150x256x256.tif shell_225x128x128.tif bone_128x128x128.tif
