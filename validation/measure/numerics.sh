#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The figures of docs/validation/numerics.md: hard cases in large numbers (10^7 cells of each kind, 10^8 rays into each
# closed isosurface), a quarter of an hour of processor time. With arguments, those alone: validation/run numerics 'NumericsCells.*'
set -euo pipefail
cd "$(dirname "$0")/../.."

mkdir -p build
cmake --preset release >build/numerics.log && cmake --build --preset release >>build/numerics.log
LEAFLIGHT_NUMERICS=large exec build/release/tests/core/core_tests --gtest_filter="${1:-Numerics*}"
