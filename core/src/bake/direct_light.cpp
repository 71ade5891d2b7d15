// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/direct_light.h"

#include "leaflight/math/low_discrepancy.h"

namespace leaflight {

template <int D>
DirectLight<D>::DirectLight(const SweptVolume<D>& volume, const LightSampler<D>& lights,
                            const SweptLattice<D>& texels, bool inner, std::uint64_t seed)
    : volume_(volume),
      lights_(lights),
      texels_(texels),
      seed_(seed),
      shadows_(texels.lattice, volume.window()) {
  const std::size_t n = texels.lattice.active.size();
  moments_[0] = TexelMoments(n);
  if (inner) moments_[1] = TexelMoments(n);
}

template <int D>
void DirectLight<D>::add_block(Progress& progress, std::atomic<std::uint64_t>& lines) {
  Random random = random_for(seed_, Purpose::direct_sweep, blocks_++);
  const std::uint64_t choice_key = random.bits(), source_key = random.bits(),
                      offset_key = random.bits();
  for (int i = 0; i < sources_per_block && lights_.can_light(); ++i) {
    const double choice = lights_.has_choice() ? sobol_point(i, choice_key)[0] : 0;
    const LightSource<D> source = lights_.source(choice, sobol_point(i, source_key));
    LeafShadows<D>* shadows = shadows_.sources() < most_shadows ? &shadows_ : nullptr;
    sweep_direct(volume_, texels_, source, sobol_point(i, offset_key), progress, lines, moments_,
                 shadows);
    progress.advance(cost() / sources_per_block);
  }
  for (TexelMoments& side : moments_) side.close_block(progress);
}

template <int D>
double DirectLight<D>::cost() const {
  return static_cast<double>(texels_.lattice.texels()) * sources_per_block;
}

template <int D>
std::vector<Average> DirectLight<D>::averages(bool inner) const {
  return moments_[inner].averages();
}

template class DirectLight<2>;
template class DirectLight<3>;

}  // namespace leaflight
