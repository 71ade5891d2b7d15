// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/gather_sweep.h"

#include <cmath>
#include <limits>
#include <optional>

#include "leaflight/math/random.h"
#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// What the points of a line need, found once for both of its directions.
template <int D>
struct GatherLine {
  LineValues<D> line;
  std::vector<std::int32_t> slot;  // of each plane, or inactive
  std::vector<float> weight;       // area that the point stands for, times the cosine
  std::vector<char> climbs;        // whether values grow along the axis
  std::vector<int> higher, lower;  // stacks of planes

  GatherLine(const Field<D>& field, const TexelLattice<D>& lattice, const LineSet<D>& set,
             const Planes<D>& planes)
      : line(field, lattice, set, planes),
        slot(planes.planes.size()),
        weight(planes.planes.size()),
        climbs(planes.planes.size()) {}
};

}  // namespace

template <int D>
void sweep_gather(const SweptVolume<D>& volume, const SweptLattice<D>& texels,
                  const GatheredRadiance<D>& from, const Vec<D>& direction, int spacing,
                  const std::array<double, 2>& offset, std::uint64_t key, Progress& progress,
                  std::atomic<std::uint64_t>& lines, SideMoments& moments) {
  const TexelLattice<D>& lattice = texels.lattice;
  const SceneTracer<D>& tracer = volume.tracer;
  const Volume<D>& of = volume.volume();
  const IsovalueWindow window = volume.window();
  const Affine<D> to_frame = texels_to_frame(volume, lattice), to_texels = inverse(to_frame);
  const bool inner = !moments[1].empty(), emissive = of.emission.largest() > 0;
  const LineSet<D> set = parallel_lines(lattice, to_texels.vector(direction), spacing, offset);
  const Planes<D> planes(of.field, lattice, set.axis);
  const bool meshes = !tracer.meshes().empty(), within = meshes && meshes_near<D>(volume, nullptr);
  Vec<D> to_source, to_shadows;
  for (int a = 0; a < D; ++a) {
    to_shadows[a] = lattice.voxels_per_texel[a] / from.shadows.lattice().voxels_per_texel[a];
    to_source[a] = lattice.voxels_per_texel[a] / from.texels.lattice.voxels_per_texel[a];
  }
  // What the outer side of leaf h, as if white, reflects of one of the sources; position in texels.
  const auto direct_at = [&](const Vec<D>& position, double h, std::uint64_t bits) {
    const LeafShadows<D>& shadows = from.shadows;
    if (shadows.sources() == 0) return Rgb(0);
    const std::size_t k = bits % shadows.sources();
    const LightSource<D>& source = shadows.source(k);
    Index<D> voxel;
    std::size_t at = 0, stride = 1;
    for (int a = 0; a < D; ++a) {
      voxel[a] = std::clamp(static_cast<int>(position[a] * lattice.voxels_per_texel[a] + 0.5), 0,
                            of.field.dims[a] - 1);
      at += voxel[a] * stride;
      stride *= of.field.dims[a];
    }
    const Vec<D> gradient(volume.gradients[at]);
    const double steep = gradient.length();
    if (!(steep > 0)) return Rgb(0);
    const Vec<D> normal = gradient / -steep;
    Vec<D> way = source.direction;
    double distance = 1;
    if (!source.infinite) {
      way = to_frame.point(position) - source.position;
      distance = way.length();
      way /= distance;
    }
    const double cosine = -way.dot(normal);
    if (!(cosine > 0)) return Rgb(0);
    // A texel away from the surface.
    Vec<D> out = to_texels.vector(normal);
    double most = 0;
    for (int a = 0; a < D; ++a) most = std::max(most, std::abs(out[a]));
    if (shadows.shadowed(k, (position + out / most) * to_shadows, h)) return Rgb(0);
    return source.irradiance(way, distance) * static_cast<Real>(cosine / projected_hemisphere<D>);
  };
  lines += set.lines();
  for_each_line(
      set, progress, [&] { return GatherLine<D>(of.field, lattice, set, planes); },
      [&](GatherLine<D>& own, const auto& tracks) {
        LineValues<D>& line = own.line;
        line.follow(tracks);
        const int first = line.first(), last = line.last();
        if (first > last) return;
        const Vec<D> per_z = to_frame.vector(line.direction());
        const double length = per_z.length();
        const Vec<D> way = per_z / length;
        const Vec<D, float> way_(way);
        bool any = false;
        for (int k = first; k <= last; ++k) {
          own.slot[k] = TexelLattice<D>::inactive;
          const double h = line.value(k);
          if (!window.contains(h)) continue;
          const std::int64_t texel = line.texel(k);
          if (texel < 0) continue;
          own.slot[k] = texels.slots[texel];
          if (own.slot[k] == TexelLattice<D>::inactive) continue;
          const float along = way_.dot(line.gradient(volume.gradients, k));
          own.weight[k] = std::abs(along);
          own.climbs[k] = along > 0;
          any = any || along != 0;
        }
        if (!any) return;
        const Vec<D> texel_steps = line.direction() * to_source;
        const double half = 0.5 / texel_steps.length();
        for (const int step : {1, -1}) {
          // From the points the way back is looked along, towards where the walk came from.
          const Vec<D> back = way * -step;
          const int begin = step > 0 ? first : last, end = step > 0 ? last : first;
          std::optional<SurroundingsHit> wall;
          double wall_z = -step * infinity;  // z of the nearest mesh behind
          const auto find_wall = [&](double z) {
            wall =
                tracer.surroundings().intersect(to_frame.point(line.position(z)), back, infinity);
            wall_z = wall ? z - step * wall->t / length : -step * infinity;
          };
          if (meshes) find_wall(line.z(begin));
          own.higher.clear();
          own.lower.clear();
          int stretch = begin;  // the plane after the last masked one
          for (int k = begin; k != end + step; k += step) {
            const double h = line.value(k);
            if (std::isnan(h)) {
              own.higher.clear();
              own.lower.clear();
              stretch = k + step;
              continue;
            }
            while (!own.higher.empty() && line.value(own.higher.back()) < h) own.higher.pop_back();
            while (inner && !own.lower.empty() && line.value(own.lower.back()) >= h) {
              own.lower.pop_back();
            }
            const std::int32_t slot = own.slot[k];
            // Climbing along the walk, the way back leads down and away from the outer side.
            const bool outer = own.climbs[k] == (step > 0);
            if (slot != TexelLattice<D>::inactive && own.weight[k] > 0 && (outer || inner)) {
              const std::vector<int>& stack = outer ? own.higher : own.lower;
              if (within) find_wall(line.z(k));
              const double c = of.leaf_coordinate(h);
              const Rgb albedo = of.albedo.at(c);
              int crossing = stack.empty() ? -1 : stack.back();
              if (stack.empty()) {
                // Beyond masked voxels the way goes on.
                bool above = !outer, known = false;
                for (int j = stretch - step; j != begin - step; j -= step) {
                  const double other = line.value(j);
                  if (std::isnan(other)) {
                    known = false;
                    continue;
                  }
                  if (known && (other >= h) != above) {
                    crossing = j;
                    break;
                  }
                  above = other >= h;
                  known = true;
                }
              }
              Rgb radiance(0);
              bool leaf = false;
              double z = 0;
              if (crossing >= 0) {
                const double there = line.value(crossing), here = line.value(crossing + step);
                const double t = there != here ? (there - h) / (there - here) : 0;
                z = line.z(crossing) + (line.z(crossing + step) - line.z(crossing)) * t;
                leaf = !wall || (z - wall_z) * step > 0;
              }
              if (leaf) {
                const bool above = line.value(crossing) < h;  // its inner side is seen
                const double gap = std::abs(line.z(k) - z);
                const Vec<D> at = line.position(z + step * std::min(half, gap)) * to_source;
                std::int32_t met = from.texels.slot_near(at);
                if (met == TexelLattice<D>::inactive) {
                  met = from.texels.slot_near(line.position(z) * to_source);
                }
                if (met != TexelLattice<D>::inactive) {
                  if (!from.soft[above]->empty()) radiance = albedo * (*from.soft[above])[met];
                  if (above && !from.inner_direct->empty()) radiance += (*from.inner_direct)[met];
                }
                if (!above) {
                  radiance +=
                      albedo * direct_at(line.position(z), h, Random::mix(key ^ (slot + 77)));
                }
                if (emissive) radiance += of.emission.at(c);
              } else if (wall) {
                const double u = static_cast<double>(Random::mix(key + slot) >> 11) * 0x1p-53;
                radiance = from.surroundings->radiance(*wall, back, c, u);
              }
              moments[!outer].sums[slot].add(Imath::V3f(radiance), own.weight[k]);
            }
            own.higher.push_back(k);
            if (inner) own.lower.push_back(k);
          }
        }
      });
}

template void sweep_gather<2>(const SweptVolume<2>&, const SweptLattice<2>&,
                              const GatheredRadiance<2>&, const Vec<2>&, int,
                              const std::array<double, 2>&, std::uint64_t, Progress&,
                              std::atomic<std::uint64_t>&, SideMoments&);
template void sweep_gather<3>(const SweptVolume<3>&, const SweptLattice<3>&,
                              const GatheredRadiance<3>&, const Vec<3>&, int,
                              const std::array<double, 2>&, std::uint64_t, Progress&,
                              std::atomic<std::uint64_t>&, SideMoments&);

}  // namespace leaflight
