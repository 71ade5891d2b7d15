# SPDX-License-Identifier: GPL-3.0-or-later
set(CMAKE_SYSTEM_PROCESSOR arm64)
include("${CMAKE_CURRENT_LIST_DIR}/toolchain.cmake")
