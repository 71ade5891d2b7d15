// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/scene.h"

namespace leaflight {

// Mean squared errors of colors over points of isosurfaces. `noise`: of indirect light. `bias`:
// all other errors, such as detail finer than the texels.
struct IsovalueError {
  double noise = 0, bias = 0;

  double percent() const { return 100 * std::sqrt(noise + bias); }
};

// The error of the isosurfaces near a common isovalue.
struct WorstIsovalue {
  double c = 0, percent = 0;
};

// Isosurface errors of an isovalue range, averaged by area, over the range and over parts of equal
// height.
class IsovalueErrors {
 public:
  static constexpr int parts = 16;

  explicit IsovalueErrors(const IsovalueRange& isovalue_range) : isovalue_range_(isovalue_range) {}

  // Returns the part of the range that contains a common isovalue.
  int part_of(double c) const {
    return std::clamp(
        static_cast<int>((c - isovalue_range_.min) / isovalue_range_.height() * parts), 0,
        parts - 1);
  }

  // Adds the squared noise of a point that represents `area`.
  void add_noise(double c, double area, double square) {
    for (Sum* sum : {&all_, &parts_[part_of(c)]}) sum->noise.add(area, square);
  }
  // Adds a measured squared error. It is unbiased, so it may be negative.
  void add_measured(double c, double area, double square) {
    for (Sum* sum : {&all_, &parts_[part_of(c)]}) sum->measured.add(area, square);
  }

  // Adds the errors of another object with the same isovalue range.
  void add(const IsovalueErrors& other) {
    all_.add(other.all_);
    for (int i = 0; i < parts; ++i) parts_[i].add(other.parts_[i]);
  }

  IsovalueError all() const { return all_.mean(); }
  // Returns the worst of the parts that have enough area for an estimate.
  WorstIsovalue worst() const {
    WorstIsovalue worst;
    for (int i = 0; i < parts; ++i) {
      if (!(parts_[i].noise.area > least_share * all_.noise.area)) continue;
      const double percent = parts_[i].mean().percent();
      const double c = isovalue_range_.min + isovalue_range_.height() * (i + 0.5) / parts;
      if (percent > worst.percent) worst = {c, percent};
    }
    return worst;
  }

  // Least share of the area for an estimate of a part.
  static constexpr double least_share = 0.01;

 private:
  struct Mean {
    double sum = 0, area = 0;

    void add(double weight, double square) {
      sum += weight * square;
      area += weight;
    }
    void add(const Mean& other) {
      sum += other.sum;
      area += other.area;
    }
    double value() const { return area > 0 ? sum / area : 0; }
  };
  struct Sum {
    Mean noise, measured;

    void add(const Sum& other) {
      noise.add(other.noise);
      measured.add(other.measured);
    }
    IsovalueError mean() const {
      return {noise.value(), std::max(0.0, measured.value() - noise.value())};
    }
  };

  IsovalueRange isovalue_range_;
  Sum all_;
  std::array<Sum, static_cast<std::size_t>(parts)> parts_;
};

}  // namespace leaflight
