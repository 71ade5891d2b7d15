// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace leaflight {

// Writes a state to a stream, or restores it from one, with the same bits. The streams throw on
// failure.
class Archive {
 public:
  explicit Archive(std::ostream& to) : to_(&to) {}
  explicit Archive(std::istream& from) : from_(&from) {}

  bool restores() const { return from_ != nullptr; }
  template <class Number>
  std::enable_if_t<std::is_arithmetic_v<Number> || std::is_enum_v<Number>> operator()(
      Number& number) {
    bytes(&number, sizeof number);
  }
  // Archives structs of numbers. `most`: upper bound on their number.
  template <class Item>
  void operator()(std::vector<Item>& items, std::size_t most) {
    static_assert(std::is_standard_layout_v<Item>);
    std::size_t count = items.size();
    (*this)(count);
    if (count > most) throw Error("The checkpoint is of another bake; bake the volume again.");
    items.resize(count);
    bytes(items.data(), count * sizeof(Item));
  }

 private:
  void bytes(void* data, std::size_t count) {
    if (from_) {
      from_->read(static_cast<char*>(data), static_cast<std::streamsize>(count));
    } else {
      to_->write(static_cast<const char*>(data), static_cast<std::streamsize>(count));
    }
  }

  std::ostream* to_ = nullptr;
  std::istream* from_ = nullptr;
};

// The checkpoints of a bake in passes.
struct Checkpoints {
  using Write = std::function<void(std::ostream&)>;
  using Read = std::function<void(std::istream&)>;

  // Upper bound on the seconds between two checkpoints, if no block of light takes longer.
  double seconds = 30;
  // Receives a function that writes the state; null: no checkpoints.
  std::function<void(const Write&)> save;
  // Receives, once, a function that reads a state to continue from; null: the bake starts empty.
  std::function<void(const Read&)> restore;
};

}  // namespace leaflight
