#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
#     validation/run races [OPTION OF GOOGLETEST...]    looks for data races in what several threads do at once
# Builds the tests of it with ThreadSanitizer (CMake preset tsan), and TBB too, from Debian's source: of what Debian built
# the sanitizer sees only half, so that each task would look like a race with the thread that made it.
set -euo pipefail
cd "$(dirname "$0")/../.."

tbb=$PWD/build/tsan-tbb
if [ ! -e "$tbb/build/done" ]; then
    rm -rf "$tbb"
    mkdir -p "$tbb/apt/lists/partial"
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    echo "deb-src [signed-by=$keyring] $(scripts/debian_mirror) bookworm main" >"$tbb/apt/sources.list"
    # Lists of their own, so that the machine's stay as they are.
    sources=(-o "Dir::Etc::SourceList=$tbb/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
        -o "Dir::State::Lists=$tbb/apt/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache=)
    apt-get "${sources[@]}" update
    (cd "$tbb" && apt-get "${sources[@]}" source onetbb)
    cmake -S "$tbb"/onetbb-* -B "$tbb/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBB_SANITIZE=thread
    cmake --build "$tbb/build" --target tbb
    touch "$tbb/build/done"
fi
cmake --preset tsan
cmake --build --preset tsan

# Tests with threads and without statistics: passes, fixed samples, contours, photons, files.
tests=Passes.*Same*:Passes.GoOn*:Passes.*Cancelled*:FixedSamples.AreTheSame*:FixedSamples.AreCancelled*:Passes.ExpectTheir*
tests+=:PartTracer.*:ContourTopology.*Threads*:ContourTopology.Noise*:PhotonMap.IsTheSame*:Files.*
library=$(dirname "$(find "$tbb/build" -name libtbb.so.12)")
export LD_LIBRARY_PATH=$library
export TSAN_OPTIONS="suppressions=$PWD/tests/core/tsan.supp history_size=4 ${TSAN_OPTIONS:-}"
status=0
build/tsan/tests/core/thread_tests --gtest_filter="$tests" "$@" || status=$?
# The sanitizer slows all down so much that a test of time may fail, with 1; races end with 66.
[ "$status" -le 1 ] || exit "$status"
