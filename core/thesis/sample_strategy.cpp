// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/sample_strategy.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "surface/marching_cubes.h"
#include "surface/marching_squares.h"
#include "surface/project.h"
#include "thesis/adaptive_isovalues.h"
#include "thesis/bad_regions.h"

namespace leaflight {
namespace {

struct Name {
  const char* name;
  SampleStrategy strategy;
};
constexpr std::array<Name, 7> names{{{"uniform", SampleStrategy::uniform},
                                     {"stratified", SampleStrategy::stratified},
                                     {"importance", SampleStrategy::importance},
                                     {"level_set", SampleStrategy::level_set},
                                     {"letters", SampleStrategy::letters},
                                     {"slabs", SampleStrategy::slabs},
                                     {"regular", SampleStrategy::regular}}};

constexpr int tries_in_domain = 1 << 17;
constexpr int tries_in_cell = 64;

template <int D>
struct Box {
  Vec<D> low, high;  // index coordinates
};

template <int D>
Box<D> domain_of(const Field<D>& field) {
  Box<D> box{Vec<D>(0.0), Vec<D>(0.0)};
  for (int a = 0; a < D; ++a) box.high[a] = field.dims[a] - 1;
  return box;
}

template <int D>
Vec<D> random_in(const Box<D>& box, Random& random) {
  Vec<D> x;
  for (int a = 0; a < D; ++a) x[a] = box.low[a] + (box.high[a] - box.low[a]) * random.uniform();
  return x;
}

// Samples positions on isosurfaces of the isovalue range.
template <int D>
class Sampler {
 public:
  Sampler(const Field<D>& field, const IsovalueRange& isovalue_range,
          const SampleSettings& settings)
      : field_(field),
        isovalue_range_(isovalue_range),
        settings_(settings),
        domain_(domain_of(field)) {}

  bool on_isosurface(const Vec<D>& position) const {
    const CellPoint<D> point = locate(field_, position);
    // False for NaN, because masked cells contain no isosurface.
    return isovalue_range_.contains(interpolate(load_corners(field_, point.cell), point.local));
  }

  // Samples the part of the domain that `region` accepts uniformly, in coordinates of [0,1]^D.
  template <class Region>
  Vec<D> draw(Random& random, Region region) const {
    for (int i = 0; i < tries_in_domain; ++i) {
      Vec<D> unit;
      for (int a = 0; a < D; ++a) unit[a] = random.uniform();
      if (!region(unit)) continue;
      const Vec<D> position = unit * domain_.high;
      if (on_isosurface(position)) return position;
    }
    throw Error("Hardly any part of the domain of the strategy '" + name_of(settings_.strategy) +
                "' lies in the isovalue range; widen it or choose another strategy.");
  }
  Vec<D> draw(Random& random) const {
    return draw(random, [](const Vec<D>&) { return true; });
  }
  // Samples a box, or the domain if no isosurface of the isovalue range is found in the box.
  Vec<D> draw_in(const Box<D>& box, int tries, Random& random) const {
    for (int i = 0; i < tries; ++i) {
      const Vec<D> position = random_in(box, random);
      if (on_isosurface(position)) return position;
    }
    return draw(random);
  }

  // Returns position(sample number, its random numbers) for all samples.
  template <class Position>
  std::vector<Vec<D>> all(Position position) const {
    std::vector<Vec<D>> positions(settings_.samples);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 1024),
                      [&](const auto& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) {
                          Random random = random_for(settings_.seed, Purpose::sample_position, i);
                          positions[i] = position(i, random);
                        }
                      });
    return positions;
  }

  const Field<D>& field() const { return field_; }
  const IsovalueRange& isovalue_range() const { return isovalue_range_; }
  const SampleSettings& settings() const { return settings_; }

 private:
  const Field<D>& field_;
  const IsovalueRange& isovalue_range_;
  const SampleSettings& settings_;
  Box<D> domain_;
};

// Returns the finest grid with at most n cells that are nearly cubes in the world.
template <int D>
Index<D> grid_of_at_most(const Field<D>& field, std::size_t n) {
  std::array<double, static_cast<std::size_t>(D)> length;
  double longest = 0;
  for (int a = 0; a < D; ++a) {
    length[a] = field.index_to_world.column[a].length() * (field.dims[a] - 1);
    longest = std::max(longest, length[a]);
  }
  const auto cells = [&](double along_longest) {
    Index<D> dims;
    for (int a = 0; a < D; ++a) {
      dims[a] = std::max(1, static_cast<int>(length[a] / longest * along_longest + 1e-9));
    }
    return dims;
  };
  // The numbers along all axes grow with the number along the longest axis.
  double low = 1, high = static_cast<double>(n) + 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (cell_count<D>(cells(middle)) <= n ? low : high) = middle;
  }
  return cells(low);
}

template <int D>
Box<D> stratum(const Field<D>& field, const Index<D>& grid, std::size_t number) {
  const Index<D> cell = index_of<D>(number, grid);
  Box<D> box;
  for (int a = 0; a < D; ++a) {
    const double step = static_cast<double>(field.dims[a] - 1) / grid[a];
    box.low[a] = cell[a] * step;
    box.high[a] = (cell[a] + 1) * step;
  }
  return box;
}

template <int D>
std::vector<Vec<D>> stratified_positions(const Sampler<D>& sampler) {
  const Index<D> grid = grid_of_at_most(sampler.field(), sampler.settings().samples);
  const std::size_t strata = cell_count<D>(grid);
  return sampler.all([&](std::size_t i, Random& random) {
    // Try once, so that a stratum that is partly in the isovalue range gets its share.
    return i < strata ? sampler.draw_in(stratum(sampler.field(), grid, i), 1, random)
                      : sampler.draw(random);
  });
}

template <int D>
std::vector<Vec<D>> regular_positions(const Sampler<D>& sampler) {
  const Index<D> grid = grid_of_at_most(sampler.field(), sampler.settings().samples);
  std::vector<Vec<D>> positions;
  for (std::size_t i = 0; i < cell_count<D>(grid); ++i) {
    const Box<D> box = stratum(sampler.field(), grid, i);
    const Vec<D> middle = (box.low + box.high) * 0.5;
    if (sampler.on_isosurface(middle)) positions.push_back(middle);
  }
  if (positions.empty()) {
    throw Error("No regular sample lies in the isovalue range; widen it or take more samples.");
  }
  return positions;
}

// Returns the part of the isovalue range that the values of each data cell span (thesis Eq. 4.14).
template <int D>
std::vector<float> fractional_extents(const Field<D>& field, const IsovalueRange& isovalue_range,
                                      const Index<D>& cells) {
  std::vector<float> fractions(cell_count<D>(cells));
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, fractions.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const CellCorners<D> corners = load_corners(field, index_of<D>(i, cells));
          double low = corners.h[0], high = low;
          bool masked = false;
          for (const double h : corners.h) {
            masked |= std::isnan(h);
            low = std::min(low, h);
            high = std::max(high, h);
          }
          const double span =
              std::min(high, isovalue_range.max) - std::max(low, isovalue_range.min);
          fractions[i] =
              masked ? 0 : static_cast<float>(std::max(0.0, span) / isovalue_range.height());
        }
      });
  return fractions;
}

// Distributes samples by thesis Eq. 4.12: ceil(fraction * most) samples in a data cell, with the
// largest `most` that does not need too many. Remaining samples go to data cells by systematic
// sampling, with probability proportional to the fraction. If there are fewer samples than data
// cells, all samples do. Returns the data cell of each sample.
std::vector<std::size_t> importance_cells(const std::vector<float>& fractions, std::size_t samples,
                                          double offset) {
  const auto per_cell = [&](std::size_t i, double most) {
    return static_cast<std::size_t>(std::ceil(fractions[i] * most));
  };
  const auto total = [&](double most) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, fractions.size(), 1 << 16), std::size_t{0},
        [&](const auto& range, std::size_t n) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) n += per_cell(i, most);
          return n;
        },
        std::plus<>());
  };
  double sum = 0;
  for (const float fraction : fractions) sum += fraction;
  if (!(sum > 0)) {
    throw Error("No isosurface of the isovalue range passes through the volume; widen it.");
  }
  // Find the largest `most` by bisection.
  double low = 0, high = static_cast<double>(samples) / sum;
  for (int i = 0; i < 24; ++i) {
    const double middle = (low + high) / 2;
    (total(middle) <= samples ? low : high) = middle;
  }
  // Distribute the rest by systematic sampling.
  const std::size_t rest = samples - total(low);
  std::vector<std::size_t> cells;
  cells.reserve(samples);
  double passed = 0, next = offset;
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    std::size_t n = per_cell(i, low);
    passed += fractions[i] / sum * static_cast<double>(rest);
    for (; next < passed; ++next) ++n;
    cells.insert(cells.end(), n, i);
  }
  // A rounding error may omit the last sample.
  const auto last =
      std::find_if(fractions.rbegin(), fractions.rend(), [](float f) { return f > 0; });
  cells.resize(samples, static_cast<std::size_t>(fractions.rend() - last) - 1);
  return cells;
}

template <int D>
std::vector<Vec<D>> importance_positions(const Sampler<D>& sampler) {
  const SampleSettings& settings = sampler.settings();
  Index<D> cells = sampler.field().dims;
  for (int& n : cells) --n;
  Random random = random_for(settings.seed, Purpose::sample_position, settings.samples);
  const std::vector<std::size_t> cell =
      importance_cells(fractional_extents(sampler.field(), sampler.isovalue_range(), cells),
                       settings.samples, random.uniform());
  return sampler.all([&](std::size_t i, Random& r) {
    const Vec<D> low = to_vector<D>(index_of<D>(cell[i], cells));
    return sampler.draw_in({low, low + Vec<D>(1.0)}, tries_in_cell, r);
  });
}

// Samples a facet of a contour, which has one or two edges, uniformly.
Vec<2> point_of(const IsolineMesh& mesh, std::size_t facet, Random& random) {
  const auto& s = mesh.segments[facet];
  const Vec<2> a(mesh.vertices[s[0]]), b(mesh.vertices[s[1]]);
  return a + (b - a) * random.uniform();
}
Vec3 point_of(const IsosurfaceMesh& mesh, std::size_t facet, Random& random) {
  const auto& t = mesh.triangles[facet];
  const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
  double u = random.uniform(), v = random.uniform();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return a + (b - a) * u + (c - a) * v;
}

void append_areas(const IsolineMesh& mesh, std::vector<double>& areas) {
  for (const auto& s : mesh.segments) {
    areas.push_back((mesh.vertices[s[1]] - mesh.vertices[s[0]]).length());
  }
}
void append_areas(const IsosurfaceMesh& mesh, std::vector<double>& areas) {
  for (const auto& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]);
    areas.push_back((Vec3(mesh.vertices[t[1]]) - a).cross(Vec3(mesh.vertices[t[2]]) - a).length() /
                    2);
  }
}

template <int D>
std::vector<double> level_set_isovalues(const Sampler<D>& sampler) {
  const IsovalueRange& isovalue_range = sampler.isovalue_range();
  const auto& wanted = sampler.settings().isovalues;
  if (const int* count = std::get_if<int>(&wanted)) {
    return adaptive_isovalues(sampler.field(), isovalue_range, *count);
  }
  const auto& isovalues = std::get<std::vector<double>>(wanted);
  for (const double c : isovalues) {
    if (isovalue_range.contains(c)) continue;
    throw Error("The isovalue " + std::to_string(c) +
                " of the strategy 'level_set' is not in the isovalue range " +
                std::to_string(isovalue_range.min) + ".." + std::to_string(isovalue_range.max) +
                "; choose another or widen it.");
  }
  return isovalues;
}

template <int D>
std::vector<Vec<D>> level_set_positions(const Sampler<D>& sampler) {
  const Field<D>& field = sampler.field();
  const std::vector<double> isovalues = level_set_isovalues(sampler);
  std::vector<decltype(contour(field, 0.0))> meshes;
  std::vector<std::size_t> first;  // first facet of each mesh
  std::vector<double> areas;       // of all facets, then cumulative
  for (const double c : isovalues) {
    first.push_back(areas.size());
    meshes.push_back(contour(field, c));
    append_areas(meshes.back(), areas);
  }
  for (std::size_t i = 1; i < areas.size(); ++i) areas[i] += areas[i - 1];
  if (areas.empty() || !(areas.back() > 0)) {
    throw Error(
        "The isosurfaces chosen for the strategy 'level_set' have no area; widen the "
        "isovalue range.");
  }
  return sampler.all([&](std::size_t, Random& random) {
    const auto at =
        std::upper_bound(areas.begin(), areas.end() - 1, random.uniform() * areas.back());
    const auto facet = static_cast<std::size_t>(at - areas.begin());
    const auto mesh = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), facet) -
                                               first.begin() - 1);
    const Vec<D> world = project_to_isosurface(
        field, Vec<D>(point_of(meshes[mesh], facet - first[mesh], random)), isovalues[mesh]);
    return locate(field, field.world_to_index.point(world)).index_position();
  });
}

}  // namespace

SampleStrategy sample_strategy_from(const std::string& name) {
  std::string choices;
  for (const Name& n : names) {
    if (name == n.name) return n.strategy;
    choices += (choices.empty() ? "" : &n == &names.back() ? " or " : ", ") + std::string(n.name);
  }
  throw Error("There is no sample strategy named '" + name + "'; choose " + choices + ".");
}

std::string name_of(SampleStrategy strategy) {
  return std::find_if(names.begin(), names.end(),
                      [&](const Name& n) { return n.strategy == strategy; })
      ->name;
}

template <int D>
std::vector<Vec<D>> sample_positions(const Field<D>& field, const IsovalueRange& isovalue_range,
                                     const SampleSettings& settings) {
  if (settings.samples < 1 || settings.samples > std::size_t{1} << 32) {
    throw Error("The number of samples is " + std::to_string(settings.samples) +
                "; choose between 1 and 4294967296.");
  }
  const Sampler<D> sampler(field, isovalue_range, settings);
  const auto within = [&](auto region) {
    return sampler.all([&](std::size_t, Random& random) { return sampler.draw(random, region); });
  };
  switch (settings.strategy) {
    case SampleStrategy::uniform:
      break;
    case SampleStrategy::stratified:
      return stratified_positions(sampler);
    case SampleStrategy::importance:
      return importance_positions(sampler);
    case SampleStrategy::level_set:
      return level_set_positions(sampler);
    case SampleStrategy::letters:
      return within(in_letters<D>);
    case SampleStrategy::slabs:
      return within(in_slabs<D>);
    case SampleStrategy::regular:
      return regular_positions(sampler);
  }
  return within([](const Vec<D>&) { return true; });
}

template std::vector<Vec<2>> sample_positions<2>(const Field<2>&, const IsovalueRange&,
                                                 const SampleSettings&);
template std::vector<Vec<3>> sample_positions<3>(const Field<3>&, const IsovalueRange&,
                                                 const SampleSettings&);

}  // namespace leaflight
