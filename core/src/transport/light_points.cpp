// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/light_points.h"

#include <algorithm>
#include <cmath>

#include "base/low_discrepancy.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

constexpr int fewest_points = 16, most_points = 64;
// Points of a lamp that is as wide as its distance.
constexpr double points_at_unit_size = 48;
// Wider emissive meshes, relative to their distance, have no points; rays sample them.
constexpr double widest_mesh = 1;
// Pixels of an environment are bright above this multiple of the mean. They get no points if they
// have less than this share of its light.
constexpr double bright = 8, least_bright_share = 0.05;
constexpr int bright_points = 64;
// Number of the light of points on emissive meshes and of the environment.
constexpr int no_light = -1;

// Returns the position of a set's points in their cells; set 0 has the centers.
std::array<double, 2> place_in_cell(int set) {
  const auto along = [](int n) { return (n % light_point_sets + 0.5) / light_point_sets; };
  constexpr int middle = light_point_sets / 2;
  return {along(set + middle), along(3 * set + middle)};
}

// Returns one point in each of about `wanted` equal cells of the unit square. `aspect`: ratio of
// columns to rows. A shear makes all coordinates distinct, so that the edge of a shadow in any
// direction crosses the points one by one.
template <int D>
std::vector<std::array<double, 2>> spread_points(int wanted, double aspect, int set) {
  const auto within = [](double x) { return x - std::floor(x); };
  const auto [column, row] = place_in_cell(set);
  const int columns =
      D == 2 ? wanted
             : std::clamp(static_cast<int>(std::lround(std::sqrt(wanted * aspect))), 1, wanted);
  const int rows = (wanted + columns - 1) / columns, count = columns * rows;
  std::vector<std::array<double, 2>> points;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double across = j - 0.5 * (rows - 1), along = i - 0.5 * (columns - 1);
      points.push_back({within((i + column) / columns + across / count),
                        within((j + row) / rows - along / count)});
    }
  }
  return points;
}

int points_for(double size) {
  if (!(size > 0)) return 1;
  return std::clamp(static_cast<int>(std::ceil(size * points_at_unit_size)), fewest_points,
                    most_points);
}

// Sets of light points; the first is that of split_light().
template <int D>
using Sets = std::vector<std::vector<LightPoint<D>>>;

// Adds `count` points of one light to each set. source(set, i): returns one of them.
template <int D, class Source>
void add_points(Sets<D>& sets, int count, int light, Source source) {
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (int i = 0; i < count; ++i) {
      LightPoint<D> point{source(static_cast<int>(set), i), light};
      point.source.amount /= static_cast<Real>(count);
      sets[set].push_back(std::move(point));
    }
  }
}

template <int D, class Lamp>
void add_lamp(const Lamp& lamp, int number, Sets<D>& sets) {
  if (!(largest(lamp.amount()) > 0)) return;
  std::vector<std::vector<std::array<double, 2>>> places;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    places.push_back(
        spread_points<D>(points_for(lamp.width()), lamp.aspect(), static_cast<int>(set)));
  }
  add_points<D>(sets, static_cast<int>(places[0].size()), number,
                [&](int set, int i) { return lamp.light_point(places[set][i]); });
}

template <int D>
void add_mesh(const Mesh<D>& mesh, SplitLight<D>& split, Sets<D>& sets) {
  const MeshEmitter<D> emitter(mesh);
  Box<D> box;
  for (const auto& vertex : mesh.vertices) box.extend(Vec<D>(vertex));
  const double distance = ((box.low + box.high) * 0.5).length();
  const double width = D == 3 ? std::sqrt(emitter.area()) : emitter.area();
  if (!(width < widest_mesh * distance)) {
    split.mesh_is_wide.back() = true;
    return;
  }
  const int count = points_for(width / distance);
  add_points<D>(sets, count, no_light, [&](int set, int i) {
    // One number chooses the face and the position in it, since there may be few or many faces.
    return emitter.source((i + place_in_cell(set)[0]) / count, sobol_point(i + set * count, 0));
  });
}

// Returns the light of an image up to a brightness, or the rest above it.
std::shared_ptr<const Texture> part_of(const Texture& image, double limit, bool beyond) {
  auto part = std::make_shared<Texture>(image);
  for (auto& pixel : part->pixels) {
    const double most = std::max({pixel.x, pixel.y, pixel.z});
    const double below = most > limit ? limit / most : 1;
    pixel *= static_cast<float>(beyond ? 1 - below : below);
  }
  return part;
}

template <int D>
void add_environment(const SceneTracer<D>& tracer, const Environment<D>& environment,
                     SplitLight<D>& split, Sets<D>& sets) {
  split.wide = environment;
  if (!environment.image) return;
  const Texture& image = *environment.image;
  double sum = 0, weights = 0;
  for (int j = 0; j < image.height; ++j) {
    const double weight = std::cos(((j + 0.5) / image.height - 0.5) * pi);
    for (int i = 0; i < image.width; ++i) {
      const auto& p = image.pixels[static_cast<std::size_t>(j) * image.width + i];
      sum += weight * std::max({p.x, p.y, p.z});
      weights += weight;
    }
  }
  const double limit = bright * sum / weights;
  Environment<D> beyond = environment;
  beyond.image = part_of(image, limit, true);
  const EnvironmentSampler<D> all(environment), sharp(beyond);
  const double power = sharp.power(tracer.bounds());
  if (!(power > 0) || power < least_bright_share * all.power(tracer.bounds())) return;
  split.wide->image = part_of(image, limit, false);
  add_points<D>(sets, bright_points, no_light, [&](int set, int i) {
    return sharp.source(sobol_point(i + set * bright_points, 0));
  });
}

// Splits the light, except for its points, which go into the sets.
template <int D>
SplitLight<D> split_into(const SceneTracer<D>& tracer, Sets<D>& sets) {
  SplitLight<D> split;
  for (std::size_t l = 0; l < tracer.lights().size(); ++l) {
    std::visit([&](const auto& lamp) { add_lamp<D>(lamp, static_cast<int>(l), sets); },
               tracer.lights()[l]);
  }
  for (const Mesh<D>& mesh : tracer.meshes()) {
    split.mesh_is_wide.push_back(false);
    if (largest(mesh.emission) > 0) add_mesh(mesh, split, sets);
  }
  const std::optional<Environment<D>>& environment = tracer.scene().environment;
  if (environment && largest(environment->radiance) > 0) {
    add_environment(tracer, *environment, split, sets);
  }
  return split;
}

}  // namespace

template <int D>
SplitLight<D> split_light(const SceneTracer<D>& tracer) {
  Sets<D> sets(1);
  SplitLight<D> split = split_into(tracer, sets);
  split.points = std::move(sets[0]);
  return split;
}

template <int D>
std::vector<std::vector<LightPoint<D>>> interleaved_points(const SceneTracer<D>& tracer) {
  Sets<D> sets(light_point_sets);
  split_into(tracer, sets);
  return sets;
}

template <int D>
std::vector<int> same_points(const std::vector<LightPoint<D>>& points,
                             const std::vector<LightPoint<D>>& earlier) {
  std::vector<int> same;
  for (const LightPoint<D>& point : points) {
    const auto found = std::find_if(earlier.begin(), earlier.end(), [&](const auto& other) {
      return point.source.same_ways(other.source);
    });
    same.push_back(found == earlier.end() ? -1 : static_cast<int>(found - earlier.begin()));
  }
  return same;
}

template <int D>
void scale_points(const std::vector<Rgb>& lights, std::vector<LightPoint<D>>& points) {
  for (LightPoint<D>& point : points) {
    if (point.light >= 0) point.source.amount *= lights.at(point.light);
  }
}

template SplitLight<2> split_light(const SceneTracer<2>&);
template SplitLight<3> split_light(const SceneTracer<3>&);
template std::vector<std::vector<LightPoint<2>>> interleaved_points(const SceneTracer<2>&);
template std::vector<std::vector<LightPoint<3>>> interleaved_points(const SceneTracer<3>&);
template std::vector<int> same_points(const std::vector<LightPoint<2>>&,
                                      const std::vector<LightPoint<2>>&);
template std::vector<int> same_points(const std::vector<LightPoint<3>>&,
                                      const std::vector<LightPoint<3>>&);
template void scale_points(const std::vector<Rgb>&, std::vector<LightPoint<2>>&);
template void scale_points(const std::vector<Rgb>&, std::vector<LightPoint<3>>&);

}  // namespace leaflight
