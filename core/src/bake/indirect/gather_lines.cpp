// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/gather_lines.h"

#include <bitset>
#include <cmath>
#include <limits>

#include "bake/indirect/cap_crossings.h"
#include "base/random.h"

namespace leaflight {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Returns a position relative to the center of a texel, uniform over the texel; unit: texels.
template <int D>
Vec<D> offset_within_texel(std::uint64_t bits) {
  Vec<D> offset;
  for (int a = 0; a < D; ++a) {
    offset[a] = static_cast<double>(bits >> (21 * a) & 0x1fffff) * 0x1p-21 - 0.5;
  }
  return offset;
}

template <int D>
struct Gathering {
  const LineVolume<D>& volume;
  const IndexedLattice<D>& texels;
  const GatheredRadiance<D>& from;
  std::uint64_t key;
  SideMoments& moments;
  const SceneTracer<D>& tracer = volume.tracer;
  const Volume<D>& scene_volume = volume.volume();
  const IsovalueRange isovalue_range = volume.isovalue_range();
  const bool back = !moments[1].empty(),
             emissive = from.emission && scene_volume.emission.largest() > 0;
  const bool layered = texels.lattice.has_layers();
  const CapCrossings<D> caps{volume, texels.lattice, key, !moments[1].empty()};
  const bool one_albedo = scene_volume.albedo.stops.size() == 1;
  const Affine<D> to_frame = texels_to_frame(volume, texels.lattice);
  const bool meshes = !tracer.meshes().empty();
  const bool within = meshes && meshes_near<D>(tracer, volume.number, nullptr);

  void add(const LineBundle<D>& lines, GatherLines<D>& scratch) const;
  using Lanes = std::bitset<LineBundle<D>::width>;
  Lanes find_slots(const LineBundle<D>& lines, GatherLines<D>& scratch) const;
  void walk(const LineBundle<D>& lines, Walk<D> walk, GatherLines<D>& scratch) const;
  void add_sample(const LineBundle<D>& lines, int k, Walk<D>& walk, GatherLines<D>& scratch) const;
  void find_wall(const LineBundle<D>& lines, double z, Walk<D>& walk) const;
  int beyond_masked(const GatherLines<D>& scratch, const Walk<D>& walk, float h, bool front) const;
  Rgb wall_radiance(const MeshHit& hit, const Vec<D>& direction, float h, std::int32_t slot) const;
  void gather(const LineBundle<D>& lines, const LineSample& sample, Walk<D>& walk,
              GatherLines<D>& scratch) const;
  std::array<std::uint32_t, 2> texels_near(const LineBundle<D>& lines, const Walk<D>& walk,
                                           double z, std::int32_t receiver) const;
  void add_hits(const Walk<D>& walk, GatherLines<D>& scratch) const;
  std::int32_t sender_of(const HitSample& sample, const Vec<D>& to_origin) const;
  Rgb isosurface_radiance(const HitSample& sample, std::size_t source) const;
};

// Finds the lanes whose lines cross active texels within the field. Prefetches the sums of these
// texels.
template <int D>
typename Gathering<D>::Lanes Gathering<D>::find_slots(const LineBundle<D>& lines,
                                                      GatherLines<D>& scratch) const {
  Lanes found;
  for (int k = lines.first(); k <= lines.last(); ++k) {
    if (lines.is_empty(k)) {
      scratch.slots[k].fill(TexelLattice<D>::inactive);
      continue;
    }
    for (int lane = 0; lane < lines.lanes(); ++lane) {
      std::int32_t& slot = scratch.slots[k][lane];
      slot = TexelLattice<D>::inactive;
      if (!layered && !isovalue_range.contains(lines.value(k, lane))) continue;
      const std::int64_t texel = lines.texel(k, lane);
      if (texel < 0) continue;
      slot = texels.slots[texel];
      if (slot == TexelLattice<D>::inactive) continue;
      if (lines.first(lane) <= k && k <= lines.last(lane)) found.set(lane);
      __builtin_prefetch(&moments[0].sums[slot], 1);
    }
  }
  return found;
}

template <int D>
void Gathering<D>::add(const LineBundle<D>& lines, GatherLines<D>& scratch) const {
  const Lanes lanes = find_slots(lines, scratch);
  for (int lane = 0; lane < lines.lanes(); ++lane) {
    if (!lanes[lane]) continue;
    for (int k = lines.first(lane); k <= lines.last(lane); ++k) scratch.h[k] = lines.value(k, lane);
    const Vec<D> per_z = to_frame.vector(lines.direction(lane));
    const double length = per_z.length();
    for (const int step : {1, -1}) {
      const Vec<D> to_origin = per_z / (-step * length);
      const Rgb sky = from.sky ? from.sky->radiance(to_origin) : Rgb(0);
      const int first = lines.first(lane), last = lines.last(lane);
      const int begin = step > 0 ? first : last, end = step > 0 ? last : first;
      walk(lines, {lane, step, begin, end, length, to_origin, sky, begin, {}, 0, 0}, scratch);
    }
  }
}

// Rays back from a point hit the front of its isosurface at the last greater value, and the back at
// the last smaller one.
template <int D>
void Gathering<D>::walk(const LineBundle<D>& line, Walk<D> walk, GatherLines<D>& scratch) const {
  if (meshes) find_wall(line, line.z(walk.begin), walk);
  Stack &higher = scratch.higher, &lower = scratch.lower;
  higher.clear();
  lower.clear();
  for (int k = walk.begin; k != walk.end + walk.step; k += walk.step) {
    const float h = scratch.h[k];
    if (std::isnan(h)) {
      higher.clear();
      lower.clear();
      walk.stretch = k + walk.step;
      continue;
    }
    if (layered && k != walk.begin && !std::isnan(scratch.h[k - walk.step])) {
      caps.for_each(line, walk, k, scratch,
                    [&](const LineSample& sample) { gather(line, sample, walk, scratch); });
    }
    while (higher.entries[higher.top].h < h) --higher.top;
    if (back) {
      while (lower.entries[lower.top].h >= h) --lower.top;
    }
    if (scratch.slots[k][walk.lane] != TexelLattice<D>::inactive)
      add_sample(line, k, walk, scratch);
    // Values outside the isovalue range belong to no isosurface.
    if (h >= isovalue_range.min) higher.push(h, k);
    if (back && h <= isovalue_range.max) lower.push(h, k);
  }
  add_hits(walk, scratch);
}

// Finds the mesh behind z. It stays the nearest one until the walk passes the next mesh, so few
// samples trace rays.
template <int D>
void Gathering<D>::find_wall(const LineBundle<D>& line, double z, Walk<D>& walk) const {
  constexpr double endless = std::numeric_limits<double>::infinity();
  const Vec<D> start = to_frame.point(line.position(walk.lane, z));
  walk.wall = tracer.mesh_bvh().intersect(start, walk.to_origin, endless);
  if (walk.wall) walk.wall_z = z - walk.step * walk.wall->t / walk.length;
  if (!within) return;
  const auto next = tracer.mesh_bvh().intersect(start, -walk.to_origin, endless);
  walk.next_wall_z = z + walk.step * (next ? next->t / walk.length : endless);
}

// Adds a sample of the isosurface at plane k.
template <int D>
void Gathering<D>::add_sample(const LineBundle<D>& line, int k, Walk<D>& walk,
                              GatherLines<D>& scratch) const {
  const float h = scratch.h[k];
  if (layered &&
      (!isovalue_range.contains(h) || caps.holds(line.position(walk.lane, line.z(k)), h)))
    return;
  // If the value rises along the walk, the ray back leaves from the front.
  const float climb = line.slope(k, walk.lane) * static_cast<float>(walk.step / walk.length);
  const bool front = climb > 0;
  if (!front && !(back && climb < 0)) return;
  gather(line, {line.z(k), h, std::abs(climb), front, scratch.slots[k][walk.lane]}, walk, scratch);
}

// Adds the radiance that reaches a sample from behind, or a hit.
template <int D>
void Gathering<D>::gather(const LineBundle<D>& line, const LineSample& sample, Walk<D>& walk,
                          GatherLines<D>& scratch) const {
  const float h = sample.h;
  if (within && (sample.z - walk.next_wall_z) * walk.step >= 0) find_wall(line, sample.z, walk);
  Stack& stack = sample.front ? scratch.higher : scratch.lower;
  if (sample.front) {
    while (stack.entries[stack.top].h < h) --stack.top;
  } else {
    while (stack.entries[stack.top].h >= h) --stack.top;
  }
  int crossing = stack.entries[stack.top].plane;
  if (crossing < 0 && walk.stretch != walk.begin) {
    crossing = beyond_masked(scratch, walk, h, sample.front);
  }
  LineHit hit{h, 0, false};
  if (crossing >= 0) {
    const float hit_value = scratch.h[crossing], here = scratch.h[crossing + walk.step];
    const float t = hit_value != here ? (hit_value - h) / (hit_value - here) : 0;
    hit.z = line.z(crossing) + (line.z(crossing + walk.step) - line.z(crossing)) * t;
    hit.on_back = hit_value < h;
  }
  Rgb radiance = walk.sky;
  if (crossing >= 0 && (!walk.wall || (hit.z - walk.wall_z) * walk.step > 0)) {
    const auto near = texels_near(line, walk, hit.z, sample.slot);
    const bool on_cap = layered && caps.holds(line.position(walk.lane, hit.z), hit.h);
    scratch.hits.push_back(
        {sample.slot, sample.weight, hit.h, sample.front, hit.on_back, on_cap, near, {}, {}});
    return;
  }
  if (walk.wall) radiance = wall_radiance(*walk.wall, walk.to_origin, h, sample.slot);
  moments[!sample.front].sums[sample.slot].add(Imath::V3f(radiance), sample.weight);
}

// Returns the radiance of a wall towards the isosurface of value h at the texel of `slot`.
template <int D>
Rgb Gathering<D>::wall_radiance(const MeshHit& hit, const Vec<D>& direction, float h,
                                std::int32_t slot) const {
  if (!from.walls) return Rgb(0);
  const double u = static_cast<double>(Random::mix(key + slot) >> 11) * 0x1p-53;
  Rgb radiance = from.walls->radiance(hit, direction, scene_volume.common_isovalue(h), u);
  if (from.mesh_is_wide[hit.mesh]) radiance += tracer.meshes()[hit.mesh].emission;
  return radiance;
}

// Returns the plane at which a ray back hits the isosurface of value h before the last masked
// voxels, or -1.
template <int D>
int Gathering<D>::beyond_masked(const GatherLines<D>& scratch, const Walk<D>& walk, float h,
                                bool front) const {
  bool above = !front, known = false;
  for (int j = walk.stretch - walk.step; j != walk.begin - walk.step; j -= walk.step) {
    const float other = scratch.h[j];
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

// Returns two texels at opposite random offsets from a hit. On average over offsets, their light is
// linearly interpolated.
template <int D>
std::array<std::uint32_t, 2> Gathering<D>::texels_near(const LineBundle<D>& line,
                                                       const Walk<D>& walk, double z,
                                                       std::int32_t receiver) const {
  const Vec<D> position = line.position(walk.lane, z);
  const Vec<D> offset = offset_within_texel<D>(Random::mix(key + receiver));
  std::array<std::uint32_t, 2> found;
  for (int i = 0; i < 2; ++i) {
    const Vec<D> place = i == 0 ? position + offset : position - offset;
    found[i] = static_cast<std::uint32_t>(nearest_texel(texels.lattice, place));
    __builtin_prefetch(&texels.slots[found[i]]);
  }
  return found;
}

// Adds the hits of a walk. Each step prefetches for all of them what the next one reads, because
// hits are spread over the memory.
template <int D>
void Gathering<D>::add_hits(const Walk<D>& walk, GatherLines<D>& scratch) const {
  for (HitSample& sample : scratch.hits) {
    for (int i = 0; i < 2; ++i) {
      sample.slots[i] = sample.on_cap ? texels.lattice.layer_slot(sample.texels[i],
                                                                  texels.lattice.layer_of(sample.h))
                                      : texels.slots[sample.texels[i]];
      if (sample.slots[i] != TexelLattice<D>::inactive)
        __builtin_prefetch(&from.surfaces[sample.slots[i]]);
    }
  }
  for (HitSample& sample : scratch.hits) {
    sample.sender = sender_of(sample, walk.to_origin);
    if (sample.sender == TexelLattice<D>::inactive) continue;
    const std::vector<Rgb>& indirect = *from.indirect[sample.on_back];
    if (!indirect.empty()) __builtin_prefetch(&indirect[sample.sender]);
    if (!sample.on_back) from.direct.prefetch(scratch.source, sample.sender);
  }
  for (const HitSample& sample : scratch.hits) {
    moments[!sample.front].sums[sample.receiver].add(
        Imath::V3f(isosurface_radiance(sample, scratch.source)), sample.weight);
  }
  scratch.hits.clear();
}

// Returns the slot of the texel whose light a hit sends, or inactive. The texel must face the line,
// and of two, the one with the closer value is chosen. Other texels may lie on the far side of a
// thin shell, or near its crest, where isosurfaces have holes. Their light would stay in a closed
// cavity for many bounces.
template <int D>
std::int32_t Gathering<D>::sender_of(const HitSample& sample, const Vec<D>& to_origin) const {
  std::int32_t found = TexelLattice<D>::inactive;
  float nearest = infinity;
  for (const std::int32_t slot : sample.slots) {
    if (slot == TexelLattice<D>::inactive) continue;
    // A layer has no other face. At an edge of a cut its normal is between those of both faces.
    if (sample.on_cap && !sample.on_back) return slot;
    const TexelSurface<D>& surface = from.surfaces[slot];
    const double away = Vec<D>(surface.normal).dot(to_origin);
    if (!(sample.on_back ? away > 0 : away < 0)) continue;
    const float distance = std::abs(surface.value - sample.h) / surface.steepness;
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = slot;
  }
  return found;
}

template <int D>
Rgb Gathering<D>::isosurface_radiance(const HitSample& sample, std::size_t source) const {
  const std::int32_t slot = sample.sender;
  const double c = scene_volume.common_isovalue(sample.h);
  Rgb radiance(0), back_direct(0);
  if (slot != TexelLattice<D>::inactive) {
    if (!from.indirect[sample.on_back]->empty()) radiance = (*from.indirect[sample.on_back])[slot];
    if (!sample.on_back && from.direct.sources() > 0) {
      radiance += from.direct.reflected(source, slot, sample.h);
    }
    if (sample.on_back && from.back_direct) back_direct = (*from.back_direct)[slot];
  }
  radiance = radiance * scene_volume.albedo.at(one_albedo ? 0 : c) + back_direct;
  if (slot != TexelLattice<D>::inactive && !from.texture.empty()) radiance *= from.texture[slot];
  if (emissive) radiance += scene_volume.emission.at(c);
  return radiance;
}

}  // namespace

template <int D>
std::uint64_t gather_along_lines(const LineVolume<D>& volume, const IndexedLattice<D>& texels,
                                 const GatheredRadiance<D>& from, const Vec<D>& direction,
                                 int spacing, const std::array<double, 2>& offset,
                                 std::uint64_t key, Progress& progress, SideMoments& moments) {
  const TexelLattice<D>& lattice = texels.lattice;
  const Gathering<D> gathering{volume, texels, from, key, moments};
  const LineSet<D> set =
      parallel_lines(lattice, inverse(gathering.to_frame).vector(direction), spacing, offset);
  const Planes<D> planes(volume.volume().field, lattice, set.axis);
  const std::size_t sources = std::max<std::size_t>(1, from.direct.sources());
  for_each_bundle(
      volume, lattice, set, planes, progress, [&] { return GatherLines<D>(planes.planes.size()); },
      [&](GatherLines<D>& scratch, const LineBundle<D>& bundle, std::size_t number) {
        scratch.source = Random::mix(key ^ number) % sources;
        gathering.add(bundle, scratch);
      });
  return set.lines();
}

template std::uint64_t gather_along_lines<2>(const LineVolume<2>&, const IndexedLattice<2>&,
                                             const GatheredRadiance<2>&, const Vec<2>&, int,
                                             const std::array<double, 2>&, std::uint64_t, Progress&,
                                             SideMoments&);
template std::uint64_t gather_along_lines<3>(const LineVolume<3>&, const IndexedLattice<3>&,
                                             const GatheredRadiance<3>&, const Vec<3>&, int,
                                             const std::array<double, 2>&, std::uint64_t, Progress&,
                                             SideMoments&);

}  // namespace leaflight
