// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/leaf_light.h"

#include <cmath>

#include "leaflight/math/sampling.h"

namespace leaflight {

template <int D>
LeafLight<D>::LeafLight(const SweptVolume<D>& volume, const SweptLattice<D>& texels)
    : volume_(volume), texels_(&texels), window_(volume.window()) {}

template <int D>
void LeafLight<D>::add(const LightSource<D>& source) {
  sources_.push_back(source);
  greatest_.assign(lattice().texels(), 0);
}

template <int D>
void LeafLight<D>::finish(Progress& progress) {
  const LightSource<D>& source = sources_.back();
  const TexelLattice<D>& lattice = texels_->lattice;
  const Field<D>& field = volume_.volume().field;
  const Affine<D> to_frame = texels_to_frame(volume_, lattice), to_texels = inverse(to_frame);
  const Affine<D> frame_to_index = inverse(volume_.tracer.index_to_frame(volume_.number));
  std::vector<std::uint32_t> packed(lattice.texels(), 0);
  parallel_range(lattice.active.size(), 4096, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::uint32_t number = lattice.active[s];
      const Vec<D> position = to_vector<D>(lattice.texel(number));
      Index<D> voxel;
      for (int a = 0; a < D; ++a) {
        voxel[a] = std::min(static_cast<int>(position[a] * lattice.voxels_per_texel[a] + 0.5),
                            field.dims[a] - 1);
      }
      const Vec<D> gradient = frame_to_index.pull_back_gradient(voxel_gradient(field, voxel));
      const double steep = gradient.length();
      if (!(steep > 0)) continue;
      const Vec<D> normal = gradient / -steep;
      Vec<D> way = source.direction;
      double distance = 1;
      if (!source.infinite) {
        way = to_frame.point(position) - source.position;
        distance = way.length();
        way /= distance;
      }
      const double cosine = -way.dot(normal);
      if (!(cosine > 0)) continue;
      const auto share =
          static_cast<float>(source.strength(way, distance) * cosine / projected_hemisphere<D>);
      // Shadows are looked up a texel away from the surface.
      Vec<D> out = to_texels.vector(normal);
      double most = 0;
      for (int a = 0; a < D; ++a) most = std::max(most, std::abs(out[a]));
      const std::uint8_t shadow = greatest_[nearest_texel(lattice, position + out / most)];
      std::memcpy(&packed[number], &share, sizeof share);
      packed[number] = (packed[number] & ~0xffu) | shadow;
    }
  });
  reflected_.push_back(std::move(packed));
}

template class LeafLight<2>;
template class LeafLight<3>;

}  // namespace leaflight
