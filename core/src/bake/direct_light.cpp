// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/direct_light.h"

#include "leaflight/math/low_discrepancy.h"

namespace leaflight {

template <int D>
DirectLight<D>::DirectLight(const SweptVolume<D>& volume, const LightSampler<D>& lights,
                            const SweptLattice<D>& texels, bool inner, std::uint64_t seed,
                            int first_block)
    : volume_(volume),
      lights_(lights),
      texels_(texels),
      seed_(seed),
      leaf_light_(volume, texels),
      first_block_(first_block) {
  const std::size_t n = texels.lattice.active.size();
  moments_[0] = TexelMoments(n);
  if (inner) moments_[1] = TexelMoments(n);
}

template <int D>
void DirectLight<D>::add_blocks(int count, Progress& progress, std::atomic<std::uint64_t>& lines,
                                const std::function<void()>& after_block,
                                const BlockWorkers* workers) {
  for (TexelMoments& side : moments_) side.open();
  const int own = blocks_ == 0 ? 1 : 0;  // it tells leaf_light_ its sources
  if (workers && count > own) {
    workers->begin(SweptLight::direct, first_block_ + blocks_ + own, count - own, {});
  }
  for (int i = 0; i < count; ++i) {
    const int number = first_block_ + blocks_;
    const std::string bytes =
        workers && i >= own ? workers->take(SweptLight::direct, number) : std::string();
    if (bytes.empty()) {
      sweep(number, progress, lines, moments_, i < own ? &leaf_light_ : nullptr);
    } else {
      lines += take_block(bytes, moments_);
      progress.advance(cost());
    }
    for (TexelMoments& side : moments_) side.close_block(progress);
    ++blocks_;
    if (after_block) after_block();
  }
  for (TexelMoments& side : moments_) side.release();
}

template <int D>
std::string DirectLight<D>::sweep_for_others(int number, Progress& progress) {
  std::atomic<std::uint64_t> lines{0};
  for (TexelMoments& side : moments_) side.open();
  sweep(number, progress, lines, moments_, nullptr);
  std::string bytes = block_bytes(moments_, lines);
  for (TexelMoments& side : moments_) side.release();
  return bytes;
}

template <int D>
void DirectLight<D>::keep(Keeper& keeper, Progress& progress) {
  keeper(blocks_);
  for (TexelMoments& side : moments_) side.keep(keeper);
  if (keeper.restores() && blocks_ > 0) learn_leaf_light(first_block_, progress);
}

template <int D>
void DirectLight<D>::learn_leaf_light(int block, Progress& progress) {
  if (leaf_light_.sources() > 0) return;
  std::atomic<std::uint64_t> lines{0};
  for (TexelMoments& side : moments_) side.open();
  sweep(block, progress, lines, moments_, &leaf_light_);
  for (TexelMoments& side : moments_) side.release();
}

template <int D>
void DirectLight<D>::sweep(int block, Progress& progress, std::atomic<std::uint64_t>& lines,
                           SideMoments& moments, LeafLight<D>* leaf_light) {
  Random random = random_for(seed_, Purpose::direct_sweep, block);
  const std::uint64_t choice_key = random.bits(), source_key = random.bits(),
                      offset_key = random.bits();
  for (int i = 0; i < sources_per_block && lights_.can_light(); ++i) {
    const double choice = lights_.has_choice() ? sobol_point(i, choice_key)[0] : 0;
    const LightSource<D> source = lights_.source(choice, sobol_point(i, source_key));
    sweep_direct(volume_, texels_, source, sobol_point(i, offset_key), progress, lines, moments,
                 leaf_light);
    progress.advance(cost() / sources_per_block);
  }
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
