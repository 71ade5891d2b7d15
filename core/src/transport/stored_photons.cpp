// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/stored_photons.h"

#include <algorithm>

#include "base/parallel.h"

namespace leaflight {
namespace {

constexpr std::size_t photons_per_piece = 4096;

}  // namespace

template <int D>
std::vector<StoredPhoton<D>> collect_photons(const SceneTracer<D>& tracer,
                                             const LightSampler<D>& lights, std::uint64_t seed,
                                             std::uint64_t count, Progress& progress) {
  const std::size_t pieces = (count + photons_per_piece - 1) / photons_per_piece;
  std::vector<std::vector<StoredPhoton<D>>> stored(pieces);
  parallel_range(pieces, 1, photons_per_piece, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::uint64_t first = p * photons_per_piece;
      const std::uint64_t last = std::min<std::uint64_t>(count, first + photons_per_piece);
      progress.count_rays(trace_photons(tracer, lights, PhotonPaths::all, seed, first, last, count,
                                        [&](const PhotonHit<D>& photon) {
                                          if (photon.point.kind() != HitKind::isosurface) return;
                                          stored[p].push_back({Vec<D, float>(photon.point.position),
                                                               photon.point.c, photon.flux_height,
                                                               photon.point.isosurface().volume,
                                                               photon.point.isosurface().back,
                                                               photon.arrival == Arrival::direct});
                                        }));
    }
  });
  std::size_t total = 0;
  for (const auto& piece : stored) total += piece.size();
  std::vector<StoredPhoton<D>> photons;
  photons.reserve(total);
  for (std::size_t p = 0; p < pieces; ++p) {
    photons.insert(photons.end(), stored[p].begin(), stored[p].end());
    stored[p] = {};
  }
  return photons;
}

template std::vector<StoredPhoton<2>> collect_photons<2>(const SceneTracer<2>&,
                                                         const LightSampler<2>&, std::uint64_t,
                                                         std::uint64_t, Progress&);
template std::vector<StoredPhoton<3>> collect_photons<3>(const SceneTracer<3>&,
                                                         const LightSampler<3>&, std::uint64_t,
                                                         std::uint64_t, Progress&);

}  // namespace leaflight
