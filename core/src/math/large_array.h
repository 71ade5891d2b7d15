// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace leaflight {

// What the large arrays of this process take: those that have an element for each voxel of a
// volume, or for a few of them.
struct LargeMemory {
  std::uint64_t in_memory = 0, in_files = 0;  // bytes, now
  std::uint64_t limit = 0;                    // of in_memory; 0: none
};
LargeMemory large_memory();

// Large arrays that are made from now on lie in a file in the folder as soon as those in memory
// would take more than `limit` bytes: the system then keeps of them in memory what is used, and
// takes it away where others need it. The file has no name and ends with the process. 0: no limit.
void limit_large_memory(std::uint64_t limit, const std::filesystem::path& folder);

// At an address that any type may have. Throws Error where the folder has no room, std::bad_alloc.
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
