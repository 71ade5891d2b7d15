// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/platform.h"

#ifdef _WIN32
#include <windows.h>
// requires windows.h before it
#include <psapi.h>
#else
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#endif

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>

#include "base/error.h"

namespace leaflight {
namespace {

Error no_room(std::size_t bytes, const std::filesystem::path& folder, const std::string& why) {
  return Error("'" + folder.string() + "': there is no room for " +
               std::to_string((bytes + (1 << 20) - 1) >> 20) +
               " MiB of a volume that exceeds the memory limit (" + why +
               "); make room there, or raise the limit.");
}

}  // namespace

#ifdef _WIN32

std::uint64_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters;
  GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
  return counters.PeakWorkingSetSize;
}

std::uint64_t machine_memory() {
  MEMORYSTATUSEX status;
  status.dwLength = sizeof status;
  return GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}

void* map_nameless_file(std::size_t bytes, const std::filesystem::path& folder) {
  const auto failed = [&] {
    const int code = static_cast<int>(GetLastError());
    return no_room(bytes, folder, std::error_code(code, std::system_category()).message());
  };
  static std::atomic<unsigned> count = 0;
  const std::filesystem::path path =
      folder / (".leaflight-memory-" + std::to_string(GetCurrentProcessId()) + "-" +
                std::to_string(++count));
  const HANDLE file =
      CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE, 0, nullptr, CREATE_ALWAYS,
                  FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (file == INVALID_HANDLE_VALUE) throw failed();
  const HANDLE mapping = CreateFileMappingW(file, nullptr, PAGE_READWRITE,
                                            static_cast<DWORD>(std::uint64_t{bytes} >> 32),
                                            static_cast<DWORD>(bytes), nullptr);
  void* const memory = mapping ? MapViewOfFile(mapping, FILE_MAP_ALL_ACCESS, 0, 0, bytes) : nullptr;
  const Error error = failed();
  // The view keeps both alive.
  if (mapping) CloseHandle(mapping);
  CloseHandle(file);
  if (!memory) throw error;
  return memory;
}

void unmap_nameless_file(void* memory, std::size_t) { UnmapViewOfFile(memory); }

// Opens the folder for writing without sharing, so that no other process can do so or remove it.
// Other programs also open users' folders, so waiting would be in vain.
FolderHold::FolderHold(const std::filesystem::path& folder, bool wait) {
  if (wait) return;
  const HANDLE file = CreateFileW(folder.c_str(), GENERIC_WRITE, FILE_SHARE_READ, nullptr,
                                  OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  state_ = file == INVALID_HANDLE_VALUE ? State::refused : State::held;
  handle_ = reinterpret_cast<std::intptr_t>(file);
}

FolderHold::~FolderHold() {
  if (state_ == State::held) CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

// Retry, because virus scanners and indexers briefly open new files.
std::error_code move_over(const std::filesystem::path& file, const std::filesystem::path& target) {
  constexpr int patience_ms = 2000, pause_ms = 50;
  std::error_code failure;
  for (int waited = 0; waited <= patience_ms; waited += pause_ms) {
    if (waited) Sleep(pause_ms);
    if (MoveFileExW(file.c_str(), target.c_str(), MOVEFILE_REPLACE_EXISTING)) return {};
    const DWORD code = GetLastError();
    failure = {static_cast<int>(code), std::system_category()};
    if (code != ERROR_ACCESS_DENIED && code != ERROR_SHARING_VIOLATION) break;
  }
  return failure;
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

std::uint64_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return 0;
  std::uint64_t memory = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
  // Apply the limit of the process's control group, versions 2 and 1; "max" is no number.
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t limit;
    if (std::ifstream(path) >> limit) memory = std::min(memory, limit);
  }
  return memory;
}

void* map_nameless_file(std::size_t bytes, const std::filesystem::path& folder) {
  const auto failed = [&](int code) {
    return no_room(bytes, folder, std::generic_category().message(code));
  };
  std::string name = (folder / ".leaflight-memory-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) throw failed(errno);
  unlink(name.c_str());
#ifdef __APPLE__
  int failure = ftruncate(file, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
#else
  // Reserve the file's space now, because writes to a full disk would end the process.
  int failure;
  do {
    failure = posix_fallocate(file, 0, static_cast<off_t>(bytes));
  } while (failure == EINTR);
#endif
  void* memory = MAP_FAILED;
  if (failure == 0) {
    memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) failure = errno;
  }
  close(file);
  if (failure != 0) throw failed(failure);
  return memory;
}

void unmap_nameless_file(void* memory, std::size_t bytes) { munmap(memory, bytes); }

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

std::error_code move_over(const std::filesystem::path& file, const std::filesystem::path& target) {
  std::error_code failure;
  std::filesystem::rename(file, target, failure);
  return failure;
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
