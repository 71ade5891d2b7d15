// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/gather_lines.h"

#include <cmath>
#include <limits>
#include <optional>

#include "math/random.h"

namespace leaflight {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Planes of a line whose values fall, or grow, from the bottom to the top: those at which a
// isosurface may be met first on the way back.
struct Stack {
  struct Entry {
    float h;
    int plane;
  };
  std::vector<Entry> entries;
  int top = 0;

  // `bottom` is beyond all values and stays.
  Stack(std::size_t planes, float bottom) : entries(planes + 1) { entries[0] = {bottom, -1}; }
  void clear() { top = 0; }
  void push(float h, int plane) { entries[++top] = {h, plane}; }
};

// What the lines of a bundle need of the planes that they cross.
template <int D>
struct GatherLines {
  // The slots that their points belong to, or inactive.
  std::vector<std::array<std::int32_t, LineBundle<D>::width>> slots;
  std::size_t source = 0;  // of direct light
  // Of one line.
  std::vector<float> h;
  Stack higher, lower;

  explicit GatherLines(std::size_t planes)
      : slots(planes), h(planes), higher(planes, infinity), lower(planes, -infinity) {}
};

template <int D>
struct Gathering {
  const LineVolume<D>& volume;
  const IndexedLattice<D>& texels;
  const GatheredRadiance<D>& from;
  std::uint64_t key;
  SideMoments& moments;
  const SceneTracer<D>& tracer = volume.tracer;
  const Volume<D>& of = volume.volume();
  const IsovalueWindow window = volume.window();
  const bool back = !moments[1].empty(), emissive = of.emission.largest() > 0;
  const bool one_albedo = of.albedo.stops.size() == 1;
  const Affine<D> to_frame = texels_to_frame(volume, texels.lattice);
  const bool meshes = !tracer.meshes().empty();
  const bool within = meshes && meshes_near<D>(tracer, volume.number, nullptr);
  // From texels to those of other lattices.
  const Vec<D> to_source = texels.lattice.voxels_per_texel / from.texels.lattice.voxels_per_texel;

  void add(const LineBundle<D>& lines, GatherLines<D>& own) const;
  void find_slots(const LineBundle<D>& lines, GatherLines<D>& own) const;
  void walk(const LineBundle<D>& lines, int lane, int step, const Vec<D>& way, double length,
            GatherLines<D>& own) const;
  int beyond_masked(const GatherLines<D>& own, int begin, int stretch, int step, float h,
                    bool front) const;
  Rgb isosurface_radiance(const LineBundle<D>& lines, int lane, int k, int crossing, double z,
                          const GatherLines<D>& own) const;
};

// What the walks will look up comes into the cache meanwhile: they wait for memory more than for
// anything else.
template <int D>
void Gathering<D>::find_slots(const LineBundle<D>& lines, GatherLines<D>& own) const {
  const std::vector<Rgb>& indirect = *from.indirect[0];
  for (int k = lines.first(); k <= lines.last(); ++k) {
    for (int lane = 0; lane < lines.lanes(); ++lane) {
      std::int32_t& slot = own.slots[k][lane];
      slot = TexelLattice<D>::inactive;
      if (!window.contains(lines.value(k, lane))) continue;
      const std::int64_t texel = lines.texel(k, lane);
      if (texel < 0) continue;
      slot = texels.slots[texel];
      if (slot == TexelLattice<D>::inactive) continue;
      __builtin_prefetch(&moments[0].sums[slot], 1);
      if (!indirect.empty()) __builtin_prefetch(&indirect[slot]);
      from.direct.prefetch(own.source, texel);
    }
  }
}

template <int D>
void Gathering<D>::add(const LineBundle<D>& lines, GatherLines<D>& own) const {
  find_slots(lines, own);
  for (int lane = 0; lane < lines.lanes(); ++lane) {
    bool any = false;
    for (int k = lines.first(lane); k <= lines.last(lane); ++k) {
      own.h[k] = lines.value(k, lane);
      any = any || own.slots[k][lane] != TexelLattice<D>::inactive;
    }
    if (!any) continue;
    const Vec<D> per_z = to_frame.vector(lines.direction(lane));
    const double length = per_z.length();
    for (const int step : {1, -1}) walk(lines, lane, step, per_z / length, length, own);
  }
}

// From the points of a line the way back is looked along, towards where the walk came from.
template <int D>
void Gathering<D>::walk(const LineBundle<D>& line, int lane, int step, const Vec<D>& way,
                        double length, GatherLines<D>& own) const {
  const int begin = step > 0 ? line.first(lane) : line.last(lane);
  const int end = step > 0 ? line.last(lane) : line.first(lane);
  const Vec<D> to_origin = way * -step;
  const Rgb sky = from.sky ? from.sky->radiance(to_origin) : Rgb(0);
  const auto per_length = static_cast<float>(step / length);
  std::optional<WallHit> wall;
  double wall_z = 0;  // of the nearest mesh behind
  const auto find_wall = [&](double z) {
    wall = tracer.walls().intersect(to_frame.point(line.position(lane, z)), to_origin,
                                    std::numeric_limits<double>::infinity());
    if (wall) wall_z = z - step * wall->t / length;
  };
  if (meshes) find_wall(line.z(begin));
  Stack &higher = own.higher, &lower = own.lower;
  higher.clear();
  lower.clear();
  int stretch = begin;  // the plane after the last masked one
  for (int k = begin; k != end + step; k += step) {
    const float h = own.h[k];
    if (std::isnan(h)) {
      higher.clear();
      lower.clear();
      stretch = k + step;
      continue;
    }
    while (higher.entries[higher.top].h < h) --higher.top;
    if (back) {
      while (lower.entries[lower.top].h >= h) --lower.top;
    }
    const std::int32_t slot = own.slots[k][lane];
    if (slot != TexelLattice<D>::inactive) {
      // Climbing along the walk, the way back leads down and away from the front.
      const float climb = line.slope(k, lane) * per_length;
      const bool front = climb > 0;
      if (front || (back && climb < 0)) {
        if (within) find_wall(line.z(k));
        const Stack& stack = front ? higher : lower;
        int crossing = stack.entries[stack.top].plane;
        if (crossing < 0 && stretch != begin) {
          crossing = beyond_masked(own, begin, stretch, step, h, front);
        }
        double z = 0;
        if (crossing >= 0) {
          const float there = own.h[crossing], here = own.h[crossing + step];
          const float t = there != here ? (there - h) / (there - here) : 0;
          z = line.z(crossing) + (line.z(crossing + step) - line.z(crossing)) * t;
        }
        Rgb radiance(0);
        if (crossing >= 0 && (!wall || (z - wall_z) * step > 0)) {
          radiance = isosurface_radiance(line, lane, k, crossing, z, own);
        } else if (wall) {
          const double u = static_cast<double>(Random::mix(key + slot) >> 11) * 0x1p-53;
          radiance = from.walls->radiance(*wall, to_origin, of.common_isovalue(h), u);
          if (from.mesh_is_wide[wall->mesh]) radiance += tracer.meshes()[wall->mesh].emission;
        } else {
          radiance = sky;
        }
        moments[!front].sums[slot].add(Imath::V3f(radiance), std::abs(climb));
      }
    }
    // Values beyond the window are no isosurface's.
    if (h >= window.min) higher.push(h, k);
    if (back && h <= window.max) lower.push(h, k);
  }
}

// Where the isosurface of value h is met before the last masked voxels, if it is: a plane, or -1.
template <int D>
int Gathering<D>::beyond_masked(const GatherLines<D>& own, int begin, int stretch, int step,
                                float h, bool front) const {
  bool above = !front, known = false;
  for (int j = stretch - step; j != begin - step; j -= step) {
    const float other = own.h[j];
    if (std::isnan(other)) {
      known = false;
      continue;
    }
    if (known && (other >= h) != above) return j;
    above = other >= h;
    known = true;
  }
  return -1;
}

// Of the isosurface of plane k, met at coordinate z after a plane.
template <int D>
Rgb Gathering<D>::isosurface_radiance(const LineBundle<D>& line, int lane, int k, int crossing,
                                      double z, const GatherLines<D>& own) const {
  const float h = own.h[k];
  const bool above = own.h[crossing] < h;  // its back is seen
  Rgb radiance(0);
  const Vec<D> at = line.position(lane, z);
  const std::int32_t met = from.texels.slot_near(at * to_source);
  if (met != TexelLattice<D>::inactive && !from.indirect[above]->empty()) {
    radiance = (*from.indirect[above])[met];
  }
  if (!above && from.direct.sources() > 0) {
    const std::size_t there = nearest_texel(texels.lattice, at);
    radiance += from.direct.reflected(own.source, there, h);
  }
  const double c = one_albedo ? 0 : of.common_isovalue(h);
  radiance *= of.albedo.at(c);
  if (above && met != TexelLattice<D>::inactive && !from.back_direct->empty()) {
    radiance += (*from.back_direct)[met];
  }
  if (emissive) radiance += of.emission.at(of.common_isovalue(h));
  return radiance;
}

}  // namespace

template <int D>
void gather_along_lines(const LineVolume<D>& volume, const IndexedLattice<D>& texels,
                        const GatheredRadiance<D>& from, const Vec<D>& direction, int spacing,
                        const std::array<double, 2>& offset, std::uint64_t key, Progress& progress,
                        std::atomic<std::uint64_t>& lines, SideMoments& moments) {
  const TexelLattice<D>& lattice = texels.lattice;
  const Gathering<D> gathering{volume, texels, from, key, moments};
  const LineSet<D> set =
      parallel_lines(lattice, inverse(gathering.to_frame).vector(direction), spacing, offset);
  const Planes<D> planes(volume.volume().field, lattice, set.axis);
  lines += set.lines();
  const std::size_t sources = std::max<std::size_t>(1, from.direct.sources());
  for_each_bundle(
      volume, lattice, set, planes, progress, [&] { return GatherLines<D>(planes.planes.size()); },
      [&](GatherLines<D>& own, const LineBundle<D>& bundle, std::size_t number) {
        own.source = Random::mix(key ^ number) % sources;
        gathering.add(bundle, own);
      });
}

template void gather_along_lines<2>(const LineVolume<2>&, const IndexedLattice<2>&,
                                    const GatheredRadiance<2>&, const Vec<2>&, int,
                                    const std::array<double, 2>&, std::uint64_t, Progress&,
                                    std::atomic<std::uint64_t>&, SideMoments&);
template void gather_along_lines<3>(const LineVolume<3>&, const IndexedLattice<3>&,
                                    const GatheredRadiance<3>&, const Vec<3>&, int,
                                    const std::array<double, 2>&, std::uint64_t, Progress&,
                                    std::atomic<std::uint64_t>&, SideMoments&);

}  // namespace leaflight
