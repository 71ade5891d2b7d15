// SPDX-License-Identifier: GPL-3.0-or-later
// Tests each texel of bakes against path tracing of the same texel.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "agreement.h"
#include "base/parallel.h"
#include "io/exr.h"
#include "statistics.h"
#include "transport/indirect_estimator.h"
#include "transport/light_sampler.h"

namespace leaflight {
namespace {

// The mean of a texel's radiance, and its variance, per channel.
struct Estimate {
  Imath::V3d mean{0}, variance{0};
  double freedom = 0;  // degrees of freedom of the variance; 0: unknown
};

// Estimates the radiance of a texel by its definition, independently of the bake's code. Points are
// uniform over its box of +-0.35 texels, weighted by |grad c|, and have one path each. Returns
// nothing if the box leaves the isovalue range, because a bake then samples farther away.
template <int D>
Estimate texel_truth(const SceneTracer<D>& tracer, const LightSampler<D>& lights,
                     const IndirectEstimator<D>& paths, const TexelLattice<D>& lattice,
                     std::uint32_t texel, int samples) {
  const Volume<D>& volume = tracer.scene().volumes[0];
  const Index<D> index = lattice.texel(texel);
  Random random(99, 99, texel);
  std::vector<double> weights;
  std::vector<Imath::V3d> radiances;
  std::uint64_t rays = 0;
  Imath::V3d sum(0);
  double weight = 0;
  for (int i = 0; i < samples; ++i) {
    Vec<D> position;
    for (int a = 0; a < D; ++a) {
      const double low = std::max(index[a] - 0.35, 0.0);
      const double high = std::min(index[a] + 0.35, lattice.resolution[a] - 1.0);
      position[a] = (low + (high - low) * random.uniform()) * lattice.voxels_per_texel[a];
    }
    const CellPoint<D> at = locate(volume.field, position);
    const double c =
        volume.common_isovalue(interpolate(load_corners(volume.field, at.cell), at.local));
    if (!tracer.scene().isovalue_range.contains(c)) return {};
    const SurfacePoint<D> point = tracer.isosurface_point(0, at, c, false);
    if (point.kind() == HitKind::none) return {};
    std::array<double, 5> u;
    for (double& number : u) number = random.uniform();
    const Rgb radiance = point.emission + lights.direct_radiance(point, u[0], {u[1], u[2]}, rays) +
                         paths.indirect_radiance(point, {u[3], u[4]}, random, rays);
    weights.push_back(point.isosurface().gradient_length);
    radiances.emplace_back(radiance);
    weight += weights.back();
    sum += radiances.back() * weights.back();
  }
  Estimate truth{sum / weight, Imath::V3d(0), samples - 1.0};
  for (int i = 0; i < samples; ++i) {
    const Imath::V3d rest = (radiances[i] - truth.mean) * (weights[i] / weight);
    truth.variance += rest * rest * (samples / (samples - 1.0));
  }
  return truth;
}

// The mean of bakes with different seeds, and its variance.
template <int D>
std::vector<Estimate> over_seeds(const Scene<D>& scene, FixedSettings<D> settings, int seeds) {
  std::vector<std::vector<Vec<3, float>>> radiance;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = 1 + seed;
    radiance.push_back(test::baked(scene, settings).grids[0].radiance);
  }
  std::vector<Estimate> estimates(radiance[0].size());
  for (std::size_t s = 0; s < estimates.size(); ++s) {
    Estimate& e = estimates[s];
    for (const auto& r : radiance) e.mean += Imath::V3d(r[s]) / seeds;
    for (const auto& r : radiance) {
      const Imath::V3d rest = Imath::V3d(r[s]) - e.mean;
      e.variance += rest * rest / (seeds * (seeds - 1.0));
    }
    e.freedom = seeds - 1;
  }
  return estimates;
}

// Returns z of the part of a difference that exceeds the bound of the bias (Welch's t with
// Satterthwaite's degrees of freedom).
double z_of(double difference, double bound, double variance_a, double freedom_a, double variance_b,
            double freedom_b) {
  const double variance = variance_a + variance_b;
  const double rest = std::max(0.0, std::abs(difference) - bound);
  if (!(rest > 0)) return 0;
  if (!(variance > 0)) return std::copysign(38, difference);
  const double freedom =
      variance * variance /
      (variance_a * variance_a / freedom_a + variance_b * variance_b / freedom_b);
  return std::copysign(test::z_of_t(rest / std::sqrt(variance), freedom), difference);
}

// Writes z of the middle slice, or of all of a flat lattice, as an image; returns its name.
template <int D>
std::string write_slice(const TexelLattice<D>& lattice, const std::vector<Imath::V3d>& z,
                        const std::string& name) {
  const int width = lattice.resolution[0], height = lattice.resolution[1];
  std::vector<float> pixels(3 * static_cast<std::size_t>(width) * height, 0.0f);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Index<D> texel;
      texel.fill(lattice.resolution[D - 1] / 2);
      texel[0] = x;
      texel[1] = y;
      const std::int32_t slot = lattice.slot[lattice.linear(texel)];
      if (slot == TexelLattice<D>::inactive) continue;
      for (int k = 0; k < 3; ++k) {
        pixels[3 * (static_cast<std::size_t>(y) * width + x) + k] = static_cast<float>(z[slot][k]);
      }
    }
  }
  const auto path = std::filesystem::path(LEAFLIGHT_ERROR_IMAGES) / ("z_" + name + ".exr");
  write_exr(path.string(), pixels.data(), width, height, 3);
  return path.string();
}

// Largest bias of an estimator: a share of the texel's radiance and a share of the mean.
struct Bias {
  double relative = 0, share_of_mean = 0;

  bool none() const { return relative == 0 && share_of_mean == 0; }
};

template <int D>
class TexelZ {
 public:
  TexelZ(Scene<D> scene, const Index<D>& resolution, int samples)
      : scene_(std::move(scene)), tracer_(scene_), lights_(tracer_), resolution_(resolution) {
    const auto paths = make_path_estimator(tracer_, lights_);
    lattice_ = make_lattice(test::field_of(scene_), resolution, scene_.isovalue_range.min,
                            scene_.isovalue_range.max);
    truth_.resize(lattice_.active.size());
    Progress progress;
    parallel_range(truth_.size(), 16, 0, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        truth_[s] = texel_truth(tracer_, lights_, *paths, lattice_, lattice_.active[s], samples);
      }
    });
    for (const Estimate& e : truth_) {
      if (!(e.freedom > 0)) continue;
      ++known_;
      mean_ += (e.mean.x + e.mean.y + e.mean.z) / 3;
    }
    mean_ /= static_cast<double>(known_);
  }

  testing::AssertionResult agrees(EstimatorName estimator, int samples, int photons, int seeds,
                                  const Bias& bias, const std::string& name) const {
    auto settings = test::fixed_settings<D>(estimator, samples, photons);
    settings.resolution = resolution_;
    const std::vector<Estimate> baked = over_seeds(scene_, settings, seeds);
    if (test::sanitized) return testing::AssertionSuccess();
    std::vector<Imath::V3d> z(baked.size(), Imath::V3d(0));
    double worst = 0, resolved = 0, bias_shown = 0;
    Imath::V3d difference(0), variance(0);  // variance of the sum over the texels
    std::size_t where = 0, tests = 3 * known_;
    for (std::size_t s = 0; s < baked.size(); ++s) {
      if (!(truth_[s].freedom > 0)) continue;
      for (int k = 0; k < 3; ++k) {
        const double bound = bias.relative * truth_[s].mean[k] + bias.share_of_mean * mean_;
        z[s][k] = z_of(baked[s].mean[k] - truth_[s].mean[k], bound, baked[s].variance[k],
                       baked[s].freedom, truth_[s].variance[k], truth_[s].freedom);
        difference[k] += baked[s].mean[k] - truth_[s].mean[k];
        variance[k] += baked[s].variance[k] + truth_[s].variance[k];
        resolved += std::sqrt(baked[s].variance[k] + truth_[s].variance[k]) / tests;
        bias_shown = std::max(
            bias_shown,
            (std::abs(baked[s].mean[k] - truth_[s].mean[k]) - bias.relative * truth_[s].mean[k] -
             test::z_limit(tests) * std::sqrt(baked[s].variance[k] + truth_[s].variance[k])) /
                mean_);
        if (std::abs(z[s][k]) > std::abs(worst)) worst = z[s][k], where = s;
      }
    }
    const std::string measured =
        name + ": the largest z of " + std::to_string(tests) + " is " + std::to_string(worst) +
        ", the mean standard error " + std::to_string(100 * resolved / mean_) +
        " % of the mean, the bias that it shows " + std::to_string(100 * bias_shown) + " %";
    // The mean over independent texels is more precise than each of them, so test it if there is no
    // bias.
    for (int k = 0; k < 3 && bias.none(); ++k) {
      const double z_of_sum = difference[k] / std::sqrt(variance[k]);
      if (std::abs(z_of_sum) <= test::z_limit(3)) continue;
      return testing::AssertionFailure() << name << ": z of the mean is " << z_of_sum;
    }
    if (std::abs(worst) <= test::z_limit(tests)) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << measured << ", over the limit of " << test::z_limit(tests) << ", in texel "
           << lattice_.active[where] << ": " << baked[where].mean << " baked, "
           << truth_[where].mean << " true; see " << write_slice(lattice_, z, name);
  }

 private:
  Scene<D> scene_;
  SceneTracer<D> tracer_;
  LightSampler<D> lights_;
  Index<D> resolution_;
  TexelLattice<D> lattice_;
  std::vector<Estimate> truth_;
  std::size_t known_ = 0;  // number of texels with a known truth
  double mean_ = 0;
};

constexpr int seeds = test::sanitized ? 3 : 8;
constexpr int photons = test::fewer(50'000);

// Measured biases times 1.5; more seeds do not reduce them. They come from blurred light, so at the
// edge of a shadow they are a share of the mean over texels. Looking up the nearest texel has no
// measurable bias.
constexpr Bias gathered{0.02, 0.02};
// Photons are counted over boxes of up to 9 texels: a bias of 0.7 % of the mean, or 6.3 % in 2D.
constexpr Bias boxes{0.02, 0.02}, flat_boxes{0.02, 0.1};
// With so few photons, the 200 nearest reach from light into shadow: 24 %, or 5.6 % in 2D.
constexpr Bias nearest{0.07, 0.36}, flat_nearest{0.07, 0.09};

TEST(TexelZ, InSpace) {
  const TexelZ<3> z(test::cornell(test::ball<3>(17), {0.6, 0.9}), {17, 17, 17}, test::fewer(300));
  EXPECT_TRUE(z.agrees(EstimatorName::path, 32, 1, seeds, {}, "path"));
  EXPECT_TRUE(z.agrees(EstimatorName::gather, 32, photons, seeds, gathered, "gather"));
  EXPECT_TRUE(z.agrees(EstimatorName::volumetric, 32, photons, seeds, boxes, "volumetric"));
  EXPECT_TRUE(z.agrees(EstimatorName::thesis, 12, photons, seeds, nearest, "thesis"));
}

TEST(TexelZ, InThePlane) {
  Scene<2> scene = test::scene_of(test::ball<2>(33), Rgb(0.8f, 0.5f, 0.3f), {0.6, 0.9});
  scene.lights = {AreaLight<2>{"lamp", {0.8, 1.25}, {Vec<2>(-0.6, 0)}, Rgb(3)}};
  scene.meshes = {test::wall(Vec<2>(-0.3, -0.3), {1.6, 0}, Rgb(0.3f, 0.6f, 0.9f))};
  const TexelZ<2> z(std::move(scene), {33, 33}, test::fewer(2048));
  EXPECT_TRUE(z.agrees(EstimatorName::path, 64, 1, seeds, {}, "flat_path"));
  EXPECT_TRUE(z.agrees(EstimatorName::gather, 64, photons, seeds, gathered, "flat_gather"));
  EXPECT_TRUE(
      z.agrees(EstimatorName::volumetric, 64, photons, seeds, flat_boxes, "flat_volumetric"));
  EXPECT_TRUE(z.agrees(EstimatorName::thesis, 64, photons, seeds, flat_nearest, "flat_thesis"));
}

}  // namespace
}  // namespace leaflight
