// SPDX-License-Identifier: GPL-3.0-or-later
// The system's header, which oneTBB and OpenVDB include, without its words for the pointers of
// 16-bit programs: here they are names of variables.
#pragma once

#include_next <windows.h>

#undef near
#undef far
#undef NEAR
#undef FAR
#define NEAR
#define FAR
