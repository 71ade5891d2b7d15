// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/math/platform.h"

#ifdef _WIN32
#include <windows.h>
// Needs the other before it.
#include <psapi.h>
#else
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#endif

namespace leaflight {

#ifdef _WIN32

std::uint64_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters;
  GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
  return counters.PeakWorkingSetSize;
}

// A folder that is open without sharing cannot be opened by another. Folders of users are open in
// other programs, too, so that waiting for one would be in vain.
FolderHold::FolderHold(const std::filesystem::path& folder, bool wait) {
  if (wait) return;
  const HANDLE file = CreateFileW(folder.c_str(), GENERIC_READ, 0, nullptr, OPEN_EXISTING,
                                  FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  state_ = file == INVALID_HANDLE_VALUE ? State::refused : State::held;
  handle_ = reinterpret_cast<std::intptr_t>(file);
}

FolderHold::~FolderHold() {
  if (state_ == State::held) CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

std::error_code write_through(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) return {};
  const HANDLE file = CreateFileW(path.c_str(), GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE,
                                  nullptr, OPEN_EXISTING, 0, nullptr);
  if (file == INVALID_HANDLE_VALUE)
    return {static_cast<int>(GetLastError()), std::system_category()};
  const bool done = FlushFileBuffers(file);
  const int failure = static_cast<int>(GetLastError());
  CloseHandle(file);
  return done ? std::error_code() : std::error_code(failure, std::system_category());
}

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

FolderHold::FolderHold(const std::filesystem::path& folder, bool wait) {
  handle_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle_ < 0) return;
  int failed;
  do {
    failed = flock(static_cast<int>(handle_), LOCK_EX | (wait ? 0 : LOCK_NB));
  } while (failed && errno == EINTR);
  if (!failed) state_ = State::held;
  if (failed && errno == EWOULDBLOCK) state_ = State::refused;
}

FolderHold::~FolderHold() {
  if (handle_ >= 0) close(static_cast<int>(handle_));
}

std::error_code write_through(const std::filesystem::path& path) {
  const bool folder = std::filesystem::is_directory(path);
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int failure = file >= 0 && fsync(file) == 0 ? 0 : errno;
  if (file >= 0) close(file);
  const bool lost = failure == EIO || failure == ENOSPC || failure == EDQUOT;
  if (failure == 0 || (folder && !lost) || failure == EINVAL) return {};
  return {failure, std::generic_category()};
}

#endif

}  // namespace leaflight
