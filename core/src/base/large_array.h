// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace leaflight {

// The memory of this process's large arrays, which have an element for each voxel of a volume, or
// for a few of them.
struct LargeMemory {
  std::uint64_t in_memory = 0, in_files = 0;  // current bytes
  std::uint64_t limit = 0;                    // on in_memory; 0: none
};
LargeMemory large_memory();

// Sets the limit of large arrays in memory. Arrays above it are mapped to a file in the folder, so
// that the system can swap them out. The file has no name and ends with the process. 0: no limit.
void limit_large_memory(std::uint64_t limit, const std::filesystem::path& folder);

// Allocates memory with an alignment for any type. Throws Error if the folder has no room, or
// std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes);

template <class T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <class Other>
  LargeAllocator(const LargeAllocator<Other>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { free_large(memory, count * sizeof(T)); }
  template <class Other>
  bool operator==(const LargeAllocator<Other>&) const {
    return true;
  }
  template <class Other>
  bool operator!=(const LargeAllocator<Other>&) const {
    return false;
  }
};

template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace leaflight
