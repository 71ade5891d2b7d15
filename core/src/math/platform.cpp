// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/math/platform.h"

#ifdef _WIN32
#include <windows.h>
// Needs the other before it.
#include <psapi.h>
#else
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace leaflight {

#ifdef _WIN32

std::uint64_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters;
  GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
  return counters.PeakWorkingSetSize;
}

long process_number() { return static_cast<long>(GetCurrentProcessId()); }

#else

std::uint64_t peak_memory() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr std::uint64_t unit = 1;
#else
  constexpr std::uint64_t unit = 1024;
#endif
  return static_cast<std::uint64_t>(usage.ru_maxrss) * unit;
}

long process_number() { return getpid(); }

#endif

}  // namespace leaflight
