// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <type_traits>
#include <vector>

#include "math/error.h"

namespace leaflight {

// The state of something that is under way, to a stream or from one: what comes back has the same
// bits. The streams throw on failure.
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
  // Of structs of numbers alone; `most`: how many there can be.
  template <class Item>
  void operator()(std::vector<Item>& items, std::size_t most) {
    static_assert(std::is_standard_layout_v<Item>);
    std::size_t count = items.size();
    (*this)(count);
    if (count > most) throw Error("The checkpoint is of another bake; bake the volume anew.");
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

// What a bake in passes does against being interrupted.
struct Checkpoints {
  using Write = std::function<void(std::ostream&)>;
  using Read = std::function<void(std::istream&)>;

  // Seconds between two of them at most, as long as a block of light takes no longer.
  double seconds = 30;
  // Is called with what writes the state; null: there are none.
  std::function<void(const Write&)> save;
  // Is called once with what reads the state to go on from; null: from the beginning.
  std::function<void(const Read&)> restore;
};

}  // namespace leaflight
