// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#ifdef _MSC_VER
#include <intrin.h>
#endif

// All that differs between operating systems and compilers.
namespace leaflight {

inline int count_ones(std::uint64_t word) {
#ifdef _MSC_VER
  return static_cast<int>(__popcnt64(word));
#else
  return __builtin_popcountll(word);
#endif
}

// The most memory that this process has held so far, in bytes.
std::uint64_t peak_memory();

// Of this process, for the names of temporary files.
long process_number();

}  // namespace leaflight
