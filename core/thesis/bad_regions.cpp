// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/bad_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace leaflight {
namespace {

struct Stroke {
  Vec<2> from, to;
};

double distance(const Vec<2>& p, const Stroke& stroke) {
  const Vec<2> along = stroke.to - stroke.from;
  const double t = std::clamp((p - stroke.from).dot(along) / along.length2(), 0.0, 1.0);
  return (p - stroke.from - along * t).length();
}

// The strokes of the letters, each letter in the unit square.
const std::array<std::vector<Stroke>, 3> letter_strokes{{{{{0, 0}, {0, 1}},  // B
                                                          {{0, 0}, {0.7, 0}},
                                                          {{0.7, 0}, {1, 0.15}},
                                                          {{1, 0.15}, {1, 0.35}},
                                                          {{1, 0.35}, {0.7, 0.5}},
                                                          {{0, 0.5}, {0.7, 0.5}},
                                                          {{0.7, 0.5}, {1, 0.65}},
                                                          {{1, 0.65}, {1, 0.85}},
                                                          {{1, 0.85}, {0.7, 1}},
                                                          {{0, 1}, {0.7, 1}}},
                                                         {{{0, 0}, {0.5, 1}},  // A
                                                          {{0.5, 1}, {1, 0}},
                                                          {{0.2, 0.4}, {0.8, 0.4}}},
                                                         {{{0, 0}, {0, 1}},  // D
                                                          {{0, 0}, {0.6, 0}},
                                                          {{0.6, 0}, {1, 0.25}},
                                                          {{1, 0.25}, {1, 0.75}},
                                                          {{1, 0.75}, {0.6, 1}},
                                                          {{0, 1}, {0.6, 1}}}}};

}  // namespace

template <int D>
bool in_letters(const Vec<D>& unit) {
  constexpr double half_width = 0.03, width = 0.22, height = 0.5, bottom = 0.35;
  constexpr std::array<double, 3> left{0.09, 0.39, 0.69};
  const auto place = [&](const Vec<2>& p, std::size_t letter) {
    return Vec<2>(left[letter] + width * p.x, bottom + height * p.y);
  };
  const Vec<2> p(unit[0], unit[1]);
  for (std::size_t letter = 0; letter < letter_strokes.size(); ++letter) {
    for (const Stroke& stroke : letter_strokes[letter]) {
      if (distance(p, {place(stroke.from, letter), place(stroke.to, letter)}) <= half_width) {
        return true;
      }
    }
  }
  return false;
}

template <int D>
bool in_slabs(const Vec<D>& unit) {
  constexpr double half_thickness = 0.005;
  double mean = 0;
  for (int a = 0; a < D; ++a) mean += unit[a] / D;
  const double nearest = (std::clamp(std::floor(mean * 5), 0.0, 4.0) + 0.5) / 5;
  return std::abs(mean - nearest) <= half_thickness;
}

template bool in_letters<2>(const Vec<2>&);
template bool in_letters<3>(const Vec<3>&);
template bool in_slabs<2>(const Vec<2>&);
template bool in_slabs<3>(const Vec<3>&);

}  // namespace leaflight
