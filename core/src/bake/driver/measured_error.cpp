// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/measured_error.h"

#include "bake/driver/path_light.h"

namespace leaflight {
namespace {

constexpr int points_a_volume = 2048;

// Returns the paths of an estimate. Small errors need more paths, or noise hides them.
int paths_to_measure(double error) {
  const double percents = 1.5 / error;
  return static_cast<int>(std::clamp(16 * percents * percents, 16.0, 32.0));
}

// Computes the probability of each point. One half is proportional to area. The other half gives
// equal shares to all parts of the isovalue range that have their own estimate.
template <int D>
std::vector<double> chances(const std::vector<AreaPoint<D>>& points, const IsovalueErrors& parts) {
  std::array<double, IsovalueErrors::parts> areas{};
  double all = 0;
  for (const AreaPoint<D>& point : points) {
    areas[parts.part_of(point.c)] += point.area;
    all += point.area;
  }
  const auto is_large = [&](double area) { return area > IsovalueErrors::least_share * all; };
  const auto large = static_cast<double>(std::count_if(areas.begin(), areas.end(), is_large));
  std::vector<double> found;
  for (const AreaPoint<D>& point : points) {
    const double part = areas[parts.part_of(point.c)];
    found.push_back(0.5 * point.area * (1 / all + (is_large(part) ? 1 / (part * large) : 0)));
  }
  return found;
}

// Computes the squared difference between a radiance and the mean of others as colors, summed over
// the channels. Subtracts the expected square that the noise of the mean adds.
double square_without_noise(const Vec<3, float>& radiance, const std::vector<Rgb>& others,
                            double exposure) {
  // Clamp, because a path that hits a lamp by chance may be a hundred times brighter.
  constexpr double brightest = 1.5;
  const auto count = static_cast<double>(others.size());
  double result = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0, sum2 = 0;
    for (const Rgb& other : others) {
      const double one = std::min(brightest, exposure * other[i]);
      sum += one;
      sum2 += one * one;
    }
    const double mean = sum / count, color = std::min(1.0, exposure * radiance[i]);
    // Clip colors at white, where errors are invisible.
    if (mean > 1) {
      result += (color - 1) * (color - 1);
    } else {
      const double noise = (sum2 / count - mean * mean) / (count - 1);
      result += (color - mean) * (color - mean) - noise;
    }
  }
  return result / 3;
}

}  // namespace

template <int D>
MeasuredError<D>::MeasuredError(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels)
    : scene_(scene), points_(texels.size()) {
  for (std::size_t v = 0; v < texels.size(); ++v) {
    if (scene.stores_light_of(v)) place(v, texels[v].shown.lattice);
  }
}

// Chooses points by systematic sampling along their order.
template <int D>
void MeasuredError<D>::place(std::size_t volume, const TexelLattice<D>& texels) {
  const std::vector<AreaPoint<D>> all =
      area_points(scene_.volumes[volume], texels, scene_.settings.seed);
  const std::vector<double> chance =
      chances(all, IsovalueErrors(scene_.tracer.scene().isovalue_range));
  const Affine<D>& to_frame = scene_.tracer.index_to_frame(static_cast<int>(volume));
  double passed = 0, next = 0.5;
  for (std::size_t i = 0; i < all.size(); ++i) {
    passed += chance[i] * points_a_volume;
    AreaPoint<D> chosen = all[i];
    chosen.area /= chance[i];
    for (; next < passed; ++next) {
      const Vec<D> position = to_frame.point(chosen.position);
      if (scene_.tracer.is_covered(static_cast<int>(volume), position, chosen.c)) continue;
      points_[volume].push_back({chosen, {}});
    }
  }
}

template <int D>
void MeasuredError<D>::trace(const std::vector<BakeTexels<D>>& texels, int estimates) {
  scene_.progress.begin("Measuring the error");
  const int paths = paths_to_measure(scene_.settings.error);
  std::vector<TexelLattice<D>> lattices;  // one per volume, for photons
  lattices.reserve(texels.size());
  for (const BakeTexels<D>& one : texels) {
    if (!scene_.plan.caustics) continue;
    lattices.push_back(one.indirect.lattice);
    lattices.back().drop_layers();
  }
  for (; estimates_ < estimates; ++estimates_) {
    const std::uint64_t seed =
        random_for(scene_.settings.seed, Purpose::measured_error, estimates_).bits();
    // Prepare independent light, with new photons, for each estimate.
    const PathLight<D> light(scene_, lattices, texels[0].photon_count, seed);
    const PointSampler<D> from = light.sampler(scene_.lights);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      parallel_range(
          points_[v].size(), 1, 0, scene_.progress, [&](std::size_t begin, std::size_t end) {
            std::uint64_t rays = 0;
            for (std::size_t p = begin; p < end; ++p) {
              AreaPoint<D>& at = points_[v][p].at;
              const SurfacePoint<D> point =
                  scene_.tracer.isosurface_point(static_cast<int>(v), at.at, at.c, false);
              // The area is zero if no isosurface passes there.
              if (point.kind() == HitKind::none) at.area = 0;
              if (!(at.area > 0)) continue;
              // Average the paths of one estimate at the point.
              const SampleKeys keys =
                  sample_keys(seed, Purpose::measured_error, v, static_cast<std::uint32_t>(p));
              Imath::V3d sum(0);
              for (int i = 0; i < paths; ++i) {
                sum += Imath::V3d(from.direct(point, keys, i, rays) +
                                  from.indirect(point, &light.estimator(), keys, i, rays));
              }
              points_[v][p].radiance.push_back(Rgb(sum / paths));
            }
          });
    }
  }
}

template <int D>
void MeasuredError<D>::add_to(IsovalueErrors& errors,
                              const std::vector<RadianceGrid<D>>& grids) const {
  for (std::size_t v = 0; v < points_.size(); ++v) {
    const Field<D>& field = scene_.volumes[v].volume().field;
    for (const Point& point : points_[v]) {
      if (!(point.at.area > 0)) continue;
      const Vec<3, float> radiance = radiance_at(grids[v], field, point.at.position, false);
      const double square =
          square_without_noise(radiance, point.radiance, scene_.settings.exposure);
      errors.add_measured(point.at.c, point.at.area, square);
    }
  }
}

template class MeasuredError<2>;
template class MeasuredError<3>;

}  // namespace leaflight
