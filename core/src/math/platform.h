// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <system_error>

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

// The place of the lowest bit that is set; the word is not zero.
inline int lowest_bit(std::uint64_t word) {
#ifdef _MSC_VER
  unsigned long place;
  _BitScanForward64(&place, word);
  return static_cast<int>(place);
#else
  return __builtin_ctzll(word);
#endif
}

// The most memory that this process has held so far, in bytes.
std::uint64_t peak_memory();

// What this process may take of the machine's memory at most, in bytes: a container may have less
// of it. 0: the system has no such figure.
std::uint64_t machine_memory();

// Memory that lies in a file without a name in a folder, all zero. Throws Error where the disk has
// no room for all of it.
void* map_nameless_file(std::size_t bytes, const std::filesystem::path& folder);
void unmap_nameless_file(void* memory, std::size_t bytes);

// Holds a folder: of all who ask for it, in this process and in others, one has it, until it is
// given back or its process ends, however that comes about.
class FolderHold {
 public:
  // wait: until nobody else has it.
  FolderHold(const std::filesystem::path& folder, bool wait);
  ~FolderHold();
  FolderHold(const FolderHold&) = delete;
  FolderHold& operator=(const FolderHold&) = delete;

  bool held() const { return state_ == State::held; }
  // Another process has it. On file systems without locks it is neither held nor refused.
  bool refused() const { return state_ == State::refused; }

 private:
  enum class State { held, refused, unknown };
  State state_ = State::unknown;
  std::intptr_t handle_ = -1;
};

// Gives a file the name of another, which it replaces; waits for a moment while another program
// keeps that one open, where that is in the way.
std::error_code move_over(const std::filesystem::path& file, const std::filesystem::path& target);

// Returns when a file's content, or the names in a folder, have reached the disk. Of a folder
// errors count only where something was lost: not every file system writes one through.
std::error_code write_through(const std::filesystem::path& path);

}  // namespace leaflight
