// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/isovalue_nodes.h"

#include <algorithm>
#include <vector>

namespace leaflight {
namespace {

constexpr int histogram_bins = 4096;
// Approximate number of sampled voxels.
constexpr std::size_t samples = 1 << 20;

}  // namespace

template <int D>
IsovalueNodes::IsovalueNodes(const Scene<D>& scene) {
  const IsovalueRange& isovalue_range = scene.isovalue_range;
  std::vector<double> share(histogram_bins, 0.0);
  double total = 0;
  for (const Volume<D>& volume : scene.volumes) {
    const std::size_t voxels = volume.field.voxels(), step = 1 + voxels / samples;
    for (std::size_t v = 0; v < voxels; v += step) {
      const double c = volume.common_isovalue(value_at(volume.field.values, v));
      if (!isovalue_range.contains(c)) continue;  // also false for NaN
      const double position = (c - isovalue_range.min) / isovalue_range.height() * histogram_bins;
      share[std::min(histogram_bins - 1, static_cast<int>(position))] += 1;
      total += 1;
    }
  }
  double below = 0;
  int next = 0;
  for (int bin = 0; bin < histogram_bins && next < count; ++bin) {
    const double density = 0.5 / histogram_bins + (total > 0 ? 0.5 * share[bin] / total : 0);
    const double scale = total > 0 ? 1 : 2;
    while (next < count && static_cast<double>(next) / (count - 1) < below + density * scale) {
      const double within = (static_cast<double>(next) / (count - 1) - below) / (density * scale);
      nodes_[next++] =
          isovalue_range.min + isovalue_range.height() * (bin + within) / histogram_bins;
    }
    below += density * scale;
  }
  while (next < count) nodes_[next++] = isovalue_range.max;
  nodes_[count - 1] = isovalue_range.max;
}

double IsovalueNodes::height(int i) const {
  const double low = i > 0 ? 0.5 * (nodes_[i - 1] + nodes_[i]) : nodes_[0];
  const double high = i + 1 < count ? 0.5 * (nodes_[i] + nodes_[i + 1]) : nodes_[count - 1];
  return high - low;
}

IsovalueNodes::Place IsovalueNodes::place(double c) const {
  const auto above = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, c);
  const int low = static_cast<int>(above - nodes_.begin()) - 1;
  const double height = nodes_[low + 1] - nodes_[low];
  return {low, height > 0 ? std::clamp((c - nodes_[low]) / height, 0.0, 1.0) : 0};
}

int IsovalueNodes::nearest(double c) const {
  const Place at = place(c);
  return at.low + (at.t > 0.5);
}

template IsovalueNodes::IsovalueNodes(const Scene<2>&);
template IsovalueNodes::IsovalueNodes(const Scene<3>&);

}  // namespace leaflight
