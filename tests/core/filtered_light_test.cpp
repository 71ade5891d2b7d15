// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the filter that removes noise from indirect light along isosurfaces.
#include "bake/indirect/filtered_light.h"

#include <gtest/gtest.h>

#include "agreement.h"
#include "statistics.h"

namespace leaflight {
namespace {

Progress ignored;

// A volume with known light at its texels, to which tests add noise.
struct Filtering {
  Scene<3> scene;
  SceneTracer<3> tracer{scene};
  EmptySpace<3> empty{scene.volumes[0].field, scene.isovalue_range.min};
  LineVolume<3> volume{tracer, 0, empty};
  IndexedLattice<3> texels{make_lattice(scene.volumes[0].field, scene.volumes[0].field.dims,
                                        scene.isovalue_range.min, scene.isovalue_range.max)};

  // RMS errors of the mean over the channels: before the filter, after it, and as the variances
  // estimate it. `within` is the share of texels within 1.96 standard errors of the truth. `mean`
  // is the mean error.
  struct Found {
    double before = 0, after = 0, estimated = 0, within = 0, mean = 0;
  };
  Found filter(const std::function<double(const Vec3&)>& truth, double noise) const {
    const std::size_t count = texels.lattice.active.size();
    NoisyLight light{std::vector<Average>(count), std::vector<HalfDifference>(count)};
    std::vector<double> exact(count);
    Random random(5, 2, 1);
    Found found;
    for (std::size_t s = 0; s < count; ++s) {
      exact[s] = truth(texels.lattice.center(texels.lattice.active[s]));
      // Approximate a normal distribution by the sum of twelve uniform numbers.
      const auto normal = [&] {
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += random.uniform();
        return static_cast<Real>(std::sqrt(2) * noise * sum);
      };
      const Rgb first(normal(), normal(), normal()), second(normal(), normal(), normal());
      const Rgb errors = (first + second) * Real(0.5);
      light.averages[s] = {Rgb(static_cast<Real>(exact[s])) + errors,
                           static_cast<float>(noise * noise / 3), 16};
      light.halves[s] = {Imath::V3f(first - second), 0.5f, 1};
      const double error = average(errors);
      found.before += error * error;
    }
    std::array<NoisyLight, 2> sides{std::move(light), {}};
    filter_along_isosurfaces(texels, texel_surfaces(volume, texels.lattice, ignored), sides,
                             ignored);
    const std::vector<Average>& filtered = sides[0].averages;
    for (std::size_t s = 0; s < count; ++s) {
      const double off = average(filtered[s].mean) - exact[s];
      found.after += off * off;
      found.mean += off;
      found.estimated += filtered[s].variance;
      found.within += std::abs(off) <= 1.96 * std::sqrt(filtered[s].variance) + 1e-9;
    }
    const auto n = static_cast<double>(count);
    return {std::sqrt(found.before / n), std::sqrt(found.after / n), std::sqrt(found.estimated / n),
            found.within / n, found.mean / n};
  }
};

Scene<3> ball_scene() { return test::scene_of(test::ball<3>(33), Rgb(0.5f), {0.55, 0.9}); }

TEST(FilteredLight, LosesNoiseWhereLightIsSmooth) {
  const Filtering filtering{ball_scene()};
  const auto found = filtering.filter([](const Vec3& x) { return 1 + 0.01 * x.z; }, 0.1);
  EXPECT_LT(found.after, 0.4 * found.before);
  EXPECT_NEAR(found.mean, 0, 0.005);
  // The estimate must include noise that the filter takes for light.
  EXPECT_GT(found.estimated, 0.9 * found.after);
  EXPECT_LT(found.estimated, 1.6 * found.after);
  EXPECT_GT(found.within, 0.93);
}

TEST(FilteredLight, KeepsWhatIsNoNoise) {
  const Filtering filtering{ball_scene()};
  // Test the edge of a shadow.
  const auto edge = [](const Vec3& x) { return x.x < 15.3 ? 1.0 : 0.0; };
  const auto quiet = filtering.filter(edge, 0.003);
  EXPECT_LT(quiet.after, 1.01 * quiet.before);
  const auto loud = filtering.filter(edge, 0.1);
  EXPECT_LT(loud.after, 0.75 * loud.before);
  EXPECT_NEAR(loud.estimated / loud.after, 1, 0.2);
  EXPECT_NEAR(loud.within, 0.95, 0.03);
  // Without noise, the filter must change nothing.
  EXPECT_LT(filtering.filter(edge, 0).after, 1e-7);
}

TEST(FilteredLight, DoesNotMixTheFacesOfAThinShell) {
  // h has a ridge: on both sides of it isosurfaces face opposite directions, two voxels apart.
  const Scene<3> shell = test::scene_of(
      test::sampled<3>(33, [](const Vec3& x) { return 1 - std::abs(x.z - 0.5) * 16; }), Rgb(0.5f),
      {0.2, 0.8});
  const Filtering filtering{shell};
  const auto found =
      filtering.filter([](const Vec3& x) { return x.z < 16   ? 0.0
                                                  : x.z > 16 ? 1.0
                                                             : 0.5; }, 0.1);
  // The ridge, a third of the texels, has no normal and keeps its noise.
  EXPECT_LT(found.after, 0.65 * found.before);
  EXPECT_NEAR(found.mean, 0, 0.005);
}

}  // namespace
}  // namespace leaflight
