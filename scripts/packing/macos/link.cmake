# SPDX-License-Identifier: GPL-3.0-or-later
# How the module is linked, after CMake's own rule. Zig's linker cannot be told what to export. Without a list of exports
# every function of C++ that is defined in several places would be shared with other programs' libraries.
set(CMAKE_C_VERBOSE_FLAG -v)  # CMake asks the linker for more, which Zig refuses
set(CMAKE_CXX_VERBOSE_FLAG -v)
set(runtime "${CMAKE_FIND_ROOT_PATH}/../runtime")
set(CMAKE_CXX_CREATE_SHARED_MODULE
    "ld64.lld-19 -bundle -arch ${CMAKE_SYSTEM_PROCESSOR} -platform_version macos 11.0 11.0 -undefined dynamic_lookup \
-exported_symbol _PyInit__core -dead_strip -S -x -no_fixup_chains -adhoc_codesign -o <TARGET> <OBJECTS> \
-L${runtime} <LINK_LIBRARIES> ${runtime}/libc++.a ${runtime}/libc++abi.a -lm")
