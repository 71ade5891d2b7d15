# SPDX-License-Identifier: GPL-3.0-or-later
# Debian's GCC for Windows x64, and the libraries that libraries.py builds.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
get_filename_component(libraries "${CMAKE_CURRENT_LIST_DIR}/../../../build/windows/libraries" ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH "${libraries}" /usr/x86_64-w64-mingw32)
set(CMAKE_PREFIX_PATH "${libraries}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # static libraries name those that they need
set(ZLIB_LIBRARY /usr/x86_64-w64-mingw32/lib/libz.a)  # not that of the DLL
# GCC does not align AVX variables on the stack of Windows (GCC bug 54412); unaligned moves do not need it.
add_compile_options(-Wa,-muse-unaligned-vector-move)
# The C and C++ runtime within the module: its DLLs would bear the names of other programs' DLLs.
add_link_options(-static)
