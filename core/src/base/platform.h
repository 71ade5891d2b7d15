// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <system_error>

#ifdef _MSC_VER
#include <intrin.h>
#endif

// All code that depends on the operating system or the compiler.
namespace leaflight {

inline int count_ones(std::uint64_t word) {
#ifdef _MSC_VER
  return static_cast<int>(__popcnt64(word));
#else
  return __builtin_popcountll(word);
#endif
}

// Returns the position of the lowest set bit of a nonzero word.
inline int lowest_bit(std::uint64_t word) {
#ifdef _MSC_VER
  unsigned long place;
  _BitScanForward64(&place, word);
  return static_cast<int>(place);
#else
  return __builtin_ctzll(word);
#endif
}

// Returns the peak memory of this process in bytes.
std::uint64_t peak_memory();

// Returns the memory that this process may use in bytes, which a container may limit; 0: unknown.
std::uint64_t machine_memory();

// Maps a nameless file in a folder to memory, filled with zeros. Throws Error if the disk lacks
// room for all of it.
void* map_nameless_file(std::size_t bytes, const std::filesystem::path& folder);
void unmap_nameless_file(void* memory, std::size_t bytes);

// An exclusive hold on a folder across threads and processes. It ends with this object or with the
// process, in any way.
class FolderHold {
 public:
  // wait: blocks until no other object holds the folder.
  FolderHold(const std::filesystem::path& folder, bool wait);
  ~FolderHold();
  FolderHold(const FolderHold&) = delete;
  FolderHold& operator=(const FolderHold&) = delete;

  bool held() const { return state_ == State::held; }
  // True if another process holds it. On file systems without locks, held() and refused() are
  // false.
  bool refused() const { return state_ == State::refused; }

 private:
  enum class State { held, refused, unknown };
  State state_ = State::unknown;
  std::intptr_t handle_ = -1;
};

// Renames a file over another, which it replaces. Retries for a moment while another program has
// the target open.
std::error_code move_over(const std::filesystem::path& file, const std::filesystem::path& target);

// Returns when a file's content, or a folder's names, are on the disk. For folders, only errors
// with data loss count, because some file systems cannot flush them.
std::error_code write_through(const std::filesystem::path& path);

}  // namespace leaflight
