// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/direct_sweep.h"

#include <cmath>
#include <limits>

#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Values of leaves that are blocked: a stretch of a line through the field blocks those between its
// least and its greatest value.
struct Stretch {
  double low = infinity, high = -infinity;

  bool empty() const { return low > high; }
  void take(double h) {
    low = std::min(low, h);
    high = std::max(high, h);
  }
  bool blocks(double h) const { return low < h && h <= high; }
};

}  // namespace

template <int D>
void sweep_direct(const SweptVolume<D>& volume, const SweptLattice<D>& texels,
                  const LightSource<D>& source, const std::array<double, 2>& offset,
                  Progress& progress, std::atomic<std::uint64_t>& lines, SideMoments& moments,
                  LeafLight<D>* leaf_light) {
  const TexelLattice<D>& lattice = texels.lattice;
  const SceneTracer<D>& tracer = volume.tracer;
  if (leaf_light) leaf_light->add(source);
  const Volume<D>& of = volume.volume();
  const IsovalueWindow window = volume.window();
  const Affine<D> to_frame = texels_to_frame(volume, lattice), to_texels = inverse(to_frame);
  const Affine<D> frame_to_index = inverse(tracer.index_to_frame(volume.number));
  const bool inner = !moments[1].empty();
  const ColorRamp& albedo = of.albedo;
  const bool one_albedo = albedo.stops.size() == 1;
  const Imath::V3f brdf(albedo.at(0) / static_cast<Real>(projected_hemisphere<D>));
  const auto brdf_of = [&](double h) {
    if (one_albedo) return brdf;
    return Imath::V3f(albedo.at(of.leaf_coordinate(h)) /
                      static_cast<Real>(projected_hemisphere<D>));
  };
  std::vector<LineSet<D>> sets;
  if (source.infinite) {
    sets.push_back(parallel_lines(lattice, to_texels.vector(source.direction), 1, offset));
  } else {
    sets = lines_from(lattice, to_texels.point(source.position), offset);
  }
  const bool meshes =
      source.infinite ? !tracer.meshes().empty() : meshes_near<D>(volume, &source.position);
  for (const LineSet<D>& set : sets) {
    const Planes<D> planes(of.field, lattice, set.axis);
    lines += set.lines();
    const auto add_line = [&](const LineBundle<D>& line, int lane) {
      const int first = line.first(lane), last = line.last(lane);
      if (first > last) return;
      // In the frame, by which z changes by 1; the light travels along it.
      const Vec<D> per_z = to_frame.vector(line.direction(lane)) * set.step;
      const double length = per_z.length();
      const Vec<D> way = per_z / length;
      const Vec<D, float> way_(way);
      const Imath::V3f irradiance(source.amount * static_cast<Real>(source.strength(way, 1)));
      double reach = infinity;  // z, in the light's sense, at which a mesh blocks it
      if (meshes) {
        Vec<D> origin;
        double z0;
        if (source.infinite) {
          z0 = set.step > 0 ? line.z(first) : line.z(last);
          const Vec<D> entry = to_frame.point(line.position(lane, z0));
          const double back =
              2 * tracer.bounds().radius + (entry - tracer.bounds().centre).length();
          origin = entry - way * back;
          z0 -= set.step * back / length;
        } else {
          z0 = set.from;
          const Vec<D> normal = source.normal.dot(way) < 0 ? -source.normal : source.normal;
          origin = leave_plane<D>(source.position, source.sphere ? way : normal);
        }
        if (const auto hit = tracer.surroundings().intersect(origin, way, infinity)) {
          reach = z0 * set.step + hit->t / length;
        }
      }
      Stretch stretch;
      std::vector<Stretch> before;
      const int count = last - first + 1;
      for (int i = 0; i < count; ++i) {
        const int plane = set.step > 0 ? first + i : last - i;
        const double h = line.value(plane, lane);
        if (std::isnan(h)) {
          if (!stretch.empty()) before.push_back(stretch);
          stretch = {};
          continue;
        }
        const bool highest = stretch.empty() || h > stretch.high;
        const bool lowest = stretch.empty() || h <= stretch.low;
        stretch.take(h);
        if (!leaf_light && !window.contains(h)) continue;
        const std::int64_t texel = line.texel(plane, lane);
        if (texel < 0) continue;
        if (leaf_light) {
          double greatest = stretch.high;
          for (const Stretch& other : before) greatest = std::max(greatest, other.high);
          const bool reached = line.z(plane) * set.step < reach;
          leaf_light->set_greatest(texel, reached ? greatest : infinity);
          if (!window.contains(h)) continue;
        }
        const std::int32_t slot = texels.slots[texel];
        if (slot == TexelLattice<D>::inactive) continue;
        const Vec<D, float> gradient(
            frame_to_index.pull_back_gradient(Vec<D>(line.gradient(plane, lane))));
        const float steep = gradient.length();
        if (!(steep > 0)) continue;
        const float along = way_.dot(gradient);
        // Light that climbs reaches the outer side.
        const bool outer = along > 0;
        bool lit = outer ? highest : inner && lowest;
        lit = lit && line.z(plane) * set.step < reach;
        for (const Stretch& other : before) lit = lit && !other.blocks(h);
        Imath::V3f radiance(0);
        if (lit) {
          float share = std::abs(along) / steep;
          if (!source.infinite) {
            share /= static_cast<float>(spread<D>(std::abs(line.z(plane) - set.from) * length));
          }
          radiance = brdf_of(h) * irradiance * share;
        }
        moments[0].sums[slot].add(outer ? radiance : Imath::V3f(0), steep);
        if (inner) moments[1].sums[slot].add(outer ? Imath::V3f(0) : radiance, steep);
      }
    };
    // Whether any texel is met; what add_line() will need comes into the cache, see sweep_gather().
    const auto meets_texels = [&](const LineBundle<D>& bundle) {
      bool any = false;
      for (int k = bundle.first(); k <= bundle.last(); ++k) {
        for (int lane = 0; lane < bundle.lanes(); ++lane) {
          if (!window.contains(bundle.value(k, lane))) continue;
          const std::int64_t texel = bundle.texel(k, lane);
          const std::int32_t slot = texel < 0 ? TexelLattice<D>::inactive : texels.slots[texel];
          if (slot == TexelLattice<D>::inactive) continue;
          __builtin_prefetch(&moments[0].sums[slot], 1);
          any = true;
        }
      }
      return any;
    };
    for_each_bundle(
        volume, lattice, set, planes, progress, [] { return 0; },
        [&](int, const LineBundle<D>& bundle, std::size_t) {
          if (!meets_texels(bundle) && !leaf_light) return;
          for (int lane = 0; lane < bundle.lanes(); ++lane) add_line(bundle, lane);
        });
  }
  if (leaf_light) leaf_light->finish(progress);
}

template void sweep_direct<2>(const SweptVolume<2>&, const SweptLattice<2>&, const LightSource<2>&,
                              const std::array<double, 2>&, Progress&, std::atomic<std::uint64_t>&,
                              SideMoments&, LeafLight<2>*);
template void sweep_direct<3>(const SweptVolume<3>&, const SweptLattice<3>&, const LightSource<3>&,
                              const std::array<double, 2>&, Progress&, std::atomic<std::uint64_t>&,
                              SideMoments&, LeafLight<3>*);

}  // namespace leaflight
