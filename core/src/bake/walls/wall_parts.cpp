// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/wall_parts.h"

#include <algorithm>

namespace leaflight {
namespace {

constexpr int calls = 2;

}  // namespace

template <int D>
WallParts<D>::WallParts(const WallSources<D>& sources)
    : split_(split_light(sources.tracer)),
      wide_(sources.tracer, split_),
      rest_{wide_, sources.sampler.isosurfaces, sources.sampler.walls, sources.sampler.caustics},
      estimator_(sources.estimator),
      samples_{sources.seed, std::max(1, sources.samples / calls)},
      walls_(sources.tracer, sources.meshes) {}

template <int D>
WallRadiance<D> WallParts<D>::radiance(std::shared_ptr<const MeshDirectLight<D>> direct,
                                       Progress& progress, const WallsOfOthers& others) {
  const std::vector<BakePart> probes = walls_.probes();
  std::vector<std::vector<Vec<3, float>>> probed;
  light(probes, progress, others, [&](const BakePart&, std::vector<Vec<3, float>> means) {
    probed.push_back(std::move(means));
  });
  walls_.drop_dark(probes, probed);
  std::vector<BakePart> parts;
  for (int call = 0; call < calls; ++call) {
    const std::vector<BakePart> of_call = walls_.parts(call);
    parts.insert(parts.end(), of_call.begin(), of_call.end());
  }
  light(parts, progress, others,
        [&](const BakePart& part, const std::vector<Vec<3, float>>& means) {
          walls_.add(part, means);
        });
  for (int call = 0; call < calls; ++call) walls_.end_call();
  return walls_.radiance(std::move(direct), progress);
}

// Passes the means of each part to take(), in order.
template <int D>
template <class Take>
void WallParts<D>::light(const std::vector<BakePart>& parts, Progress& progress,
                         const WallsOfOthers& others, Take take) const {
  const std::vector<std::string> bytes = others ? others(parts) : std::vector<std::string>();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!others) {
      take(parts[i], means(parts[i], progress));
      continue;
    }
    std::vector<Vec<3, float>> found(parts[i].end - parts[i].begin);
    copy_items(bytes[i], found.data(), found.size());
    take(parts[i], std::move(found));
  }
}

template class WallParts<2>;
template class WallParts<3>;

}  // namespace leaflight
