// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/large_array.h"

#include <mutex>
#include <new>
#include <unordered_set>

#include "base/platform.h"

namespace leaflight {
namespace {

// Smaller arrays are not counted.
constexpr std::size_t least_counted = 1 << 20;
constexpr std::align_val_t alignment{64};

struct Arrays {
  std::mutex mutex;
  LargeMemory taken;
  std::filesystem::path folder;
  std::unordered_set<const void*> mapped;
};

Arrays& arrays() {
  // Never destroyed, because arrays may outlive static objects at the end of the process.
  static Arrays* const all = new Arrays;
  return *all;
}

}  // namespace

LargeMemory large_memory() {
  const std::lock_guard locked(arrays().mutex);
  return arrays().taken;
}

void limit_large_memory(std::uint64_t limit, const std::filesystem::path& folder) {
  const std::lock_guard locked(arrays().mutex);
  arrays().taken.limit = limit;
  arrays().folder = folder;
}

void* allocate_large(std::size_t bytes) {
  if (bytes < least_counted) return ::operator new(bytes, alignment);
  Arrays& all = arrays();
  const std::lock_guard locked(all.mutex);
  if (all.taken.limit > 0 && all.taken.in_memory + bytes > all.taken.limit) {
    void* const memory = map_nameless_file(bytes, all.folder);
    all.mapped.insert(memory);
    all.taken.in_files += bytes;
    return memory;
  }
  void* const memory = ::operator new(bytes, alignment);
  all.taken.in_memory += bytes;
  return memory;
}

void free_large(void* memory, std::size_t bytes) {
  if (bytes < least_counted) return ::operator delete(memory, alignment);
  Arrays& all = arrays();
  const std::lock_guard locked(all.mutex);
  if (all.mapped.erase(memory) > 0) {
    unmap_nameless_file(memory, bytes);
    all.taken.in_files -= bytes;
    return;
  }
  ::operator delete(memory, alignment);
  all.taken.in_memory -= bytes;
}

}  // namespace leaflight
