# SPDX-License-Identifier: GPL-3.0-or-later
# The programs and the libraries that targets.py makes for one processor; arm64.cmake and x64.cmake name it.
set(CMAKE_SYSTEM_NAME Darwin)
get_filename_component(work "${CMAKE_CURRENT_LIST_DIR}/../../../build/macos/${CMAKE_SYSTEM_PROCESSOR}" ABSOLUTE)
set(CMAKE_C_COMPILER "${work}/bin/cc")
set(CMAKE_CXX_COMPILER "${work}/bin/c++")
set(CMAKE_AR "${work}/bin/ar")
set(CMAKE_RANLIB "${work}/bin/ranlib")
set(CMAKE_INSTALL_NAME_TOOL true)  # changes the paths in dynamic libraries, which are not used
set(CMAKE_FIND_ROOT_PATH "${work}/libraries")
set(CMAKE_PREFIX_PATH "${work}/libraries")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # static libraries name those that they need
set(ZLIB_LIBRARY "${CMAKE_CURRENT_LIST_DIR}/libz.tbd")
set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)  # Zig's compiler has none
set(CMAKE_USER_MAKE_RULES_OVERRIDE "${CMAKE_CURRENT_LIST_DIR}/link.cmake")
# Boost derives from std::unary_function, which C++17 took away.
add_compile_definitions(_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION)
