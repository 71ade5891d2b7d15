// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/all_shadows.h"

#include <cmath>
#include <limits>
#include <optional>

namespace leaflight {
namespace {

// Returns the first point of a ray inside the voxels of a field, or nothing. `length`: in units of
// `way`.
template <int D>
std::optional<Vec<D>> entry(const Field<D>& field, const Vec<D>& from, const Vec<D>& direction,
                            double length) {
  double begin = 0, end = length;
  for (int a = 0; a < D; ++a) {
    const double last = field.dims[a] - 1;
    if (direction[a] == 0) {
      if (from[a] < 0 || from[a] > last) return {};
      continue;
    }
    const double one = -from[a] / direction[a], other = (last - from[a]) / direction[a];
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
  if (begin > end) return {};
  Vec<D> position = from + direction * begin;
  for (int a = 0; a < D; ++a) position[a] = std::clamp(position[a], 0.0, field.dims[a] - 1.0);
  return position;
}

// Interpolates codes at all texels of a lattice that has one texel per voxel.
template <int D>
float interpolated(const TexelLattice<D>& lattice, const std::vector<std::uint8_t>& codes,
                   const Vec<D>& position) {
  const CellPoint<D> at = lattice.cell_point(position);
  float sum = 0;
  for (int corner = 0; corner < (1 << D); ++corner) {
    Index<D> texel = at.cell;
    double weight = 1;
    for (int a = 0; a < D; ++a) {
      const int upper = (corner >> a) & 1;
      texel[a] += upper;
      weight *= upper ? at.local[a] : 1 - at.local[a];
    }
    if (weight > 0) sum += static_cast<float>(weight) * codes[lattice.linear(texel)];
  }
  return sum;
}

}  // namespace

template <int D>
OtherVolumeShadows<D>::OtherVolumeShadows(const SceneTracer<D>& tracer, int other, int volume,
                                          const TexelLattice<D>& nodes,
                                          const IsovalueRange& code_range)
    : field_(tracer.scene().volumes[other].field),
      code_{tracer.scene().volumes[other].isovalues(code_range), false},
      nodes_(nodes),
      lattice_(inactive_lattice<D>(field_.dims, field_.dims)),
      sweep_(tracer, other, lattice_, false),
      to_frame_(tracer.index_to_frame(volume)),
      to_other_(inverse(tracer.index_to_frame(other))) {}

template <int D>
void OtherVolumeShadows<D>::run(const LightSource<D>& source, std::vector<std::uint8_t>& found,
                                Progress& progress) const {
  std::vector<std::uint8_t> codes;
  sweep_.run(source, code_, codes, progress);
  const Vec<D> light =
      source.infinite ? -to_other_.vector(source.direction) : to_other_.point(source.position);
  const double length = source.infinite ? std::numeric_limits<double>::infinity() : 1;
  for (const std::uint32_t node : nodes_.active) {
    const Vec<D> from = to_other_.point(to_frame_.point(nodes_.center(node)));
    const auto at = entry(field_, from, source.infinite ? light : light - from, length);
    if (!at) continue;
    // The sweep ignores the first voxel on the way.
    const double h = value_at(field_, *at);
    const float node_code = std::isnan(h) ? 0 : std::clamp(code_(h), 0.0f, VisibilityCode::most);
    const auto code =
        static_cast<std::uint8_t>(std::max(node_code, interpolated(lattice_, codes, *at)));
    found[node] = std::max(found[node], code);
  }
}

template <int D>
AllShadows<D>::AllShadows(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& nodes,
                          const IsovalueRange& code_range, double spacing)
    : own_(tracer, volume, nodes, true, spacing) {
  for (int other = 0; other < static_cast<int>(tracer.scene().volumes.size()); ++other) {
    if (other == volume) continue;
    others_.push_back(
        std::make_unique<OtherVolumeShadows<D>>(tracer, other, volume, nodes, code_range));
  }
}

template <int D>
void AllShadows<D>::run(const LightSource<D>& source, const VisibilityCode& code,
                        std::vector<std::uint8_t>& found, Progress& progress) const {
  own_.run(source, code, found, progress);
  for (const auto& other : others_) other->run(source, found, progress);
}

template class AllShadows<2>;
template class AllShadows<3>;
template class OtherVolumeShadows<2>;
template class OtherVolumeShadows<3>;

}  // namespace leaflight
