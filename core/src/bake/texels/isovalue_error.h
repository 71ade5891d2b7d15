// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/scene.h"

namespace leaflight {

// Mean squares, over points of isosurfaces, of what colours err by: by the noise of indirect light,
// and by what its texels miss.
struct IsovalueError {
  double noise = 0, texture = 0;

  double percent() const { return 100 * std::sqrt(noise + texture); }
};

// The error of the isosurfaces about a common isovalue.
struct WorstIsovalue {
  double c = 0, percent = 0;
};

// Isosurface errors of an isovalue range, averaged by area: over all of it and over parts of equal
// height.
class IsovalueErrors {
 public:
  explicit IsovalueErrors(const IsovalueRange& isovalue_range) : isovalue_range_(isovalue_range) {}

  void add(double c, double area, const IsovalueError& error) {
    const double part =
        (c - isovalue_range_.min) / isovalue_range_.height() * static_cast<double>(parts);
    for (Sum* sum : {&all_, &parts_[std::clamp(static_cast<int>(part), 0, parts - 1)]}) {
      sum->area += area;
      sum->error.noise += area * error.noise;
      sum->error.texture += area * error.texture;
    }
  }

  // Those of the same isovalue range.
  void add(const IsovalueErrors& other) {
    all_.add(other.all_);
    for (int i = 0; i < parts; ++i) parts_[i].add(other.parts_[i]);
  }

  IsovalueError all() const { return all_.mean(); }
  // Of the parts that hold enough area for an estimate.
  WorstIsovalue worst() const {
    WorstIsovalue worst;
    for (int i = 0; i < parts; ++i) {
      if (!(parts_[i].area > least_share * all_.area)) continue;
      const double percent = parts_[i].mean().percent();
      const double c = isovalue_range_.min + isovalue_range_.height() * (i + 0.5) / parts;
      if (percent > worst.percent) worst = {c, percent};
    }
    return worst;
  }

 private:
  static constexpr int parts = 16;
  static constexpr double least_share = 0.01;
  struct Sum {
    IsovalueError error;
    double area = 0;

    void add(const Sum& other) {
      area += other.area;
      error.noise += other.error.noise;
      error.texture += other.error.texture;
    }
    IsovalueError mean() const {
      if (!(area > 0)) return {};
      // Products of independent halves may be negative, even on average.
      return {error.noise / area, std::max(0.0, error.texture / area)};
    }
  };

  IsovalueRange isovalue_range_;
  Sum all_;
  std::array<Sum, static_cast<std::size_t>(parts)> parts_;
};

}  // namespace leaflight
