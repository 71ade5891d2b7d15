// SPDX-License-Identifier: GPL-3.0-or-later
// The system's header, which oneTBB and OpenVDB include, without its macros near and far for
// pointers of 16-bit programs. We have variables of these names.
#pragma once

#include_next <windows.h>

#undef near
#undef far
#undef NEAR
#undef FAR
#define NEAR
#define FAR
