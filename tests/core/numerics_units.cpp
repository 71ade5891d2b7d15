// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "figures.h"

namespace leaflight {
namespace {

constexpr int voxels = 17;

// Units of a scene: data a h + b, lengths s x + d, light l L.
struct Units {
  std::string name;
  double scale = 1, offset = 0;       // of the values
  double size = 1, displacement = 0;  // of the lengths
  double light = 1;
};

Vec3 converted(const Units& units, const Vec3& p) {
  return p * units.size + Vec3(1, -1, 1) * units.displacement;
}

// Returns a ball of 256 levels in a room with a lamp; all coordinates are multiples of 1/64. No
// level is an end of the isovalue range, where rounding could exclude it.
Scene<3> scene_in(const Units& units, bool glowing = false) {
  Field<3> field = test::sampled<3>(voxels, [&](const Vec3& x) {
    const double level = std::round(256 * (1 - (x - Vec3(0.45, 0.5, 0.55)).length()));
    return units.scale * (level / 16 + units.offset);
  });
  Affine<3> place = field.index_to_world;
  for (Vec3& column : place.column) column *= units.size;
  place.origin = converted(units, place.origin);
  field = make_field<3>(field.values, field.dims, place, field.owner);
  const auto isovalue = [&](double c) { return units.scale * (c + units.offset); };
  Scene<3> scene =
      test::scene_of(std::move(field), Rgb(0.75f), {isovalue(10.03125), isovalue(13.96875)});
  const Rgb radiance(static_cast<Real>(3 * units.light));
  if (glowing) {
    scene.volumes[0].emission = ColorRamp({{isovalue(11), Rgb(0)}, {isovalue(13), radiance}});
  }
  for (const test::Side& side : test::cube_sides(-0.25, 1.25)) {
    scene.meshes.push_back(test::wall("wall", converted(units, side.corner), side.u * units.size,
                                      side.v * units.size, Rgb(0.5f, 0.25f, 0.75f)));
  }
  if (!glowing) {
    scene.lights.push_back(
        AreaLight<3>{"lamp",
                     converted(units, {0.25, 0.25, 1.234375}),
                     {Vec3(0, 0.5, 0) * units.size, Vec3(0.5, 0, 0) * units.size},
                     radiance});
  }
  return scene;
}

RadianceGrid<3> baked(const Scene<3>& scene, EstimatorName estimator) {
  auto settings = test::fixed_settings<3>(estimator, 2, test::fewer(20'000));
  settings.both_sides = true;
  return test::baked(scene, settings).grids[0];
}

struct Difference {
  bool same_texels = false;
  double mean = 0, rms = 0, most = 0;  // relative to the mean in the original units
};

Difference difference(const RadianceGrid<3>& plain, const RadianceGrid<3>& other, double light) {
  Difference d;
  d.same_texels = plain.lattice.active == other.lattice.active;
  if (!d.same_texels) return d;
  double sum = 0, other_sum = 0, square = 0;
  for (std::size_t s = 0; s < plain.radiance.size(); ++s) {
    for (int k = 0; k < 3; ++k) {
      const double a = plain.radiance[s][k], b = other.radiance[s][k] / light;
      sum += a;
      other_sum += b;
      square += (a - b) * (a - b);
      d.most = std::max(d.most, std::abs(a - b));
    }
  }
  const double count = 3.0 * static_cast<double>(plain.radiance.size()), mean = sum / count;
  d.mean = std::abs(other_sum - sum) / sum;
  d.rms = std::sqrt(square / count) / mean;
  d.most /= mean;
  return d;
}

const RadianceGrid<3>& plain(EstimatorName estimator, bool glowing) {
  static std::map<std::pair<EstimatorName, bool>, RadianceGrid<3>> known;
  auto found = known.find({estimator, glowing});
  if (found == known.end()) {
    found =
        known.emplace(std::pair{estimator, glowing}, baked(scene_in({}, glowing), estimator)).first;
  }
  return found->second;
}

void expect_alike(const Units& units, double most_rms, bool glowing = false) {
  for (const EstimatorName estimator : {EstimatorName::gather, EstimatorName::volumetric,
                                        EstimatorName::path, EstimatorName::thesis}) {
    const RadianceGrid<3> other = baked(scene_in(units, glowing), estimator);
    const Difference d = difference(plain(estimator, glowing), other, units.light);
    const std::string name =
        units.name + (glowing ? ", glowing isosurfaces, " : ", ") + traits_of(estimator).name;
    EXPECT_TRUE(d.same_texels) << name;
    EXPECT_LE(d.rms, most_rms) << name;
    test::figure(name + ": relative RMS", d.rms);
    test::figure(name + ": relative maximum", d.most);
    test::figure(name + ": difference of the means", d.mean);
  }
}

// Powers of two scale without rounding, so every bit must be the same. 2^100 is 1.3e30.
constexpr double huge = 0x1p100, tiny = 0x1p-100;

TEST(NumericsUnits, HugeAndTinyValuesChangeNothing) {
  expect_alike({"values 1e30", huge}, 0);
  expect_alike({"values 1e-30", tiny}, 0);
}

TEST(NumericsUnits, HugeAndTinyValuesOfGlowingIsosurfacesChangeNothing) {
  expect_alike({"values 1e30", huge}, 0, true);
  expect_alike({"values 1e-30", tiny}, 0, true);
}

TEST(NumericsUnits, DimLightChangesNothing) {
  Units units{"values 1e-30, light 1e-6", tiny};
  units.light = 0x1p-20;
  expect_alike(units, 0);
}

TEST(NumericsUnits, LengthsChangeNothing) {
  Units units{"lengths 1e-8"};
  units.size = 0x1p-27;
  expect_alike(units, 0);
  units = {"lengths 1e8"};
  units.size = 0x1p27;
  expect_alike(units, 0);
}

// Single precision stores the walls' displaced coordinates exactly, because they are multiples of
// 1/64.
TEST(NumericsUnits, DisplacementChangesNothing) {
  Units units{"displaced by 1.3e5 sizes"};
  units.displacement = 0x1p17;
  expect_alike(units, 0);
}

// Near 1e6, double precision resolves the isovalue to 6e-11, and so the isosurface. Radiance is
// rounded to 6e-8.
TEST(NumericsUnits, Offset) {
  expect_alike({"values - 1000", 1, -1000}, 0);
  expect_alike({"values + 1e6", 1, 1e6}, 1e-6);
}

// Single precision rounds values and walls to 6e-8 here. About one in 20,000 photons, each with 5
// hits, hits another texel. That changes boxes of about 100 photons by 1 %.
TEST(NumericsUnits, DecimalUnits) {
  constexpr double most = test::sanitized ? 1 : 1e-2;
  expect_alike({"values * 0.1", 0.1}, most);
  Units units{"lengths * 25.4, displaced by 0.3"};
  units.size = 25.4;
  units.displacement = 0.3;
  expect_alike(units, most);
}

}  // namespace
}  // namespace leaflight
