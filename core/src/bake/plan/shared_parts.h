// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <optional>
#include <utility>

#include "bake/plan/workers.h"
#include "base/error.h"
#include "base/progress.h"

namespace leaflight {

// Parts that workers compute for a bake, from their announcement until the bake takes or drops
// them.
class SharedParts {
 public:
  SharedParts() = default;
  SharedParts(const Workers& workers, std::vector<BakePart> parts)
      : workers_(&workers),
        parts_(std::move(parts)),
        first_(parts_.empty() ? 0 : workers.announce(parts_)) {}
  SharedParts(SharedParts&& other) noexcept { *this = std::move(other); }
  SharedParts& operator=(SharedParts&& other) noexcept {
    std::swap(workers_, other.workers_);
    std::swap(parts_, other.parts_);
    std::swap(first_, other.first_);
    return *this;
  }
  ~SharedParts() {
    if (!empty() && workers_->drop) workers_->drop(first_, static_cast<int>(parts_.size()));
  }

  bool empty() const { return parts_.empty(); }
  const std::vector<BakePart>& parts() const { return parts_; }

  // Returns the bytes of a part; null if no worker could compute it. Counts its rays, and `work`.
  std::optional<std::string> take(std::size_t part, double work, Progress& progress) const {
    std::string bytes = workers_->take(first_ + static_cast<int>(part));
    if (bytes.empty()) return {};
    progress.count_rays(take_rays(bytes));
    progress.advance(work);
    return bytes;
  }

  // Appends the number of rays of a part to its bytes, and takes it off again.
  static void add_rays(std::string& bytes, std::uint64_t rays) {
    bytes.append(reinterpret_cast<const char*>(&rays), sizeof rays);
  }
  static std::uint64_t take_rays(std::string& bytes) {
    std::uint64_t rays = 0;
    if (bytes.size() < sizeof rays) throw other_bake();
    std::memcpy(&rays, bytes.data() + bytes.size() - sizeof rays, sizeof rays);
    bytes.resize(bytes.size() - sizeof rays);
    return rays;
  }

  static Error other_bake() {
    return Error("A worker has computed a part of another bake; install one version for all.");
  }

 private:
  const Workers* workers_ = nullptr;
  std::vector<BakePart> parts_;
  int first_ = 0;
};

// Structs of numbers as bytes, and back. Throws Error if there are fewer, or other than `count`.
template <class Item>
std::string bytes_of(const std::vector<Item>& items) {
  return std::string(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
}
template <class Item>
void copy_items(const std::string& bytes, std::size_t at, Item* to, std::size_t count) {
  if (bytes.size() < at + count * sizeof(Item)) throw SharedParts::other_bake();
  if (count > 0) std::memcpy(static_cast<void*>(to), bytes.data() + at, count * sizeof(Item));
}
template <class Item>
void copy_items(const std::string& bytes, Item* to, std::size_t count) {
  if (bytes.size() != count * sizeof(Item)) throw SharedParts::other_bake();
  copy_items(bytes, 0, to, count);
}

}  // namespace leaflight
