// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/map_sweeps.h"

#include <cmath>

#include "base/parallel.h"
#include "field/shading_gradient.h"

namespace leaflight {
namespace {

// Computes the difference between values at neighboring texels, averaged over the isosurfaces.
template <int D>
double difference_of_texels(const Field<D>& field, const TexelLattice<D>& lattice) {
  constexpr std::size_t most_texels = 1 << 16;
  double sum = 0, area = 0;
  const std::size_t step = 1 + lattice.active.size() / most_texels;
  for (std::size_t s = 0; s < lattice.active.size(); s += step) {
    const Vec<D> center = lattice.center(lattice.active[s]);
    const Vec<D> gradient = shading_gradient(field, locate(field, center));
    const double difference = (gradient * lattice.voxels_per_texel).length();
    sum += difference * difference;
    area += difference;
  }
  return area > 0 ? sum / area : 0;
}

// Returns the common isovalues that codes can distinguish. Codes are interpolated before they are
// compared, so a margin of two texels extends the isovalue range.
template <int D>
IsovalueRange range_of_codes(const Scene<D>& scene, const Volume<D>& volume,
                             const TexelLattice<D>& lattice) {
  constexpr double texels = 2;
  const double margin = texels * difference_of_texels(volume.field, lattice) / volume.scale;
  IsovalueRange data = scene.isovalue_range;
  for (const Volume<D>& each : scene.volumes) {
    data.min = std::min(data.min, each.common_isovalue(each.field.min));
    data.max = std::max(data.max, each.common_isovalue(each.field.max));
  }
  return {std::max(scene.isovalue_range.min - margin, data.min),
          std::min(scene.isovalue_range.max + margin, data.max)};
}

}  // namespace

template <int D>
TexelLattice<D> map_lattice(const Scene<D>& scene, int volume, const Index<D>& resolution) {
  const Volume<D>& lit = scene.volumes[volume];
  const IsovalueRange range = lit.isovalues(scene.isovalue_range);
  return make_lattice(lit.field, resolution, range.min, range.max);
}

template <int D>
MapSweeps<D>::MapSweeps(const SceneTracer<D>& tracer, int volume,
                        const std::vector<LightPoint<D>>& points, const TexelLattice<D>& lattice,
                        const TexelLattice<D>& margin_of, double spacing)
    : tracer_(tracer),
      volume_(volume),
      points_(points),
      lattice_(lattice),
      spacing_(spacing),
      code_range_(range_of_codes(tracer.scene(), tracer.scene().volumes[volume], margin_of)) {}

template <int D>
IsovalueRange MapSweeps<D>::code_range() const {
  return tracer_.scene().volumes[volume_].isovalues(code_range_);
}

template <int D>
PointCodes MapSweeps<D>::codes(const std::vector<std::size_t>& numbers, bool back,
                               Progress& progress) {
  if (!shadows_) shadows_.emplace(tracer_, volume_, lattice_, code_range_, spacing_);
  const VisibilityCode code{code_range(), back};
  const std::size_t some = numbers.size();
  std::vector<std::vector<std::uint8_t>> found(some);
  parallel_range(some, 1, work_of_texel * static_cast<double>(lattice_.texels()), progress,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) {
                     shadows_->run(points_[numbers[i]].source, code, found[i], progress);
                   }
                 });
  PointCodes codes(lattice_.active.size() * some);
  parallel_each(lattice_.active.size(), 4096, progress, [&](std::size_t s) {
    for (std::size_t i = 0; i < some; ++i) {
      codes[s * some + i] = found[i][lattice_.active[s]];
    }
  });
  return codes;
}

template TexelLattice<2> map_lattice(const Scene<2>&, int, const Index<2>&);
template TexelLattice<3> map_lattice(const Scene<3>&, int, const Index<3>&);
template class MapSweeps<2>;
template class MapSweeps<3>;

}  // namespace leaflight
