// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace leaflight {

// A stream of random numbers that is a pure function of its key, so that results do not depend on
// threads. The hash is SplitMix64's finalizer (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t key) : state_(key) {}
  // Streams with different purpose or index are independent.
  Random(std::uint64_t seed, std::uint64_t purpose, std::uint64_t index)
      : state_(mix(mix(mix(seed) ^ purpose) ^ index)) {}

  std::uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15ull); }
  // Returns a uniform number in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  std::array<double, 2> pair() {
    const double first = uniform();
    return {first, uniform()};
  }

  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t state_;
};

// The purpose of a random stream, which is part of its key.
enum class Purpose : std::uint64_t {
  photon = 1,
  texel,
  surface_cache,
  reference,
  seen_from_outside,
  walls,
  sample_position,
  scattered,
  gather_lines = 10,  // numbers are never reused
  noise,
  ray_block,
  measured_error
};

inline Random random_for(std::uint64_t seed, Purpose purpose, std::uint64_t index) {
  return Random(seed, static_cast<std::uint64_t>(purpose), index);
}

}  // namespace leaflight
