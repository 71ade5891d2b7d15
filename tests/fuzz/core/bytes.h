// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace leaflight::fuzz {

// Input of libFuzzer, read from the front as validation/run fuzz packs its seeds. Zeros follow its
// end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool empty() const { return left_ == 0; }
  template <class Number>
  Number take() {
    Number number{};
    const std::size_t size = std::min(sizeof number, left_);
    std::memcpy(&number, data_, size);
    data_ += size;
    left_ -= size;
    return number;
  }
  // Returns a number from 0 to count - 1.
  int choice(int count) { return take<std::uint8_t>() % count; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace leaflight::fuzz
