// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/map_parts.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "bake/texels/checkpoint.h"
#include "base/packed_numbers.h"

namespace leaflight {
namespace {

// The bytes of a part: sizes of the blocks of stored_codes(), one more number, and the blocks. The
// number is 1 if a mesh casts shadows.
std::string joined(const std::vector<std::string>& blocks, bool has_dark) {
  std::vector<std::uint64_t> sizes;
  sizes.reserve(blocks.size() + 1);
  for (const std::string& block : blocks) sizes.push_back(block.size());
  sizes.push_back(has_dark);
  std::string all = bytes_of(sizes);
  for (const std::string& block : blocks) all += block;
  return all;
}

// Returns the blocks. `count`: their number.
std::vector<std::string> split(const std::string& bytes, std::size_t count, bool& has_dark) {
  std::vector<std::uint64_t> sizes(count + 1);
  copy_items(bytes, 0, sizes.data(), sizes.size());
  has_dark = has_dark || sizes.back() != 0;
  std::size_t at = sizes.size() * sizeof(sizes[0]);
  std::vector<std::string> blocks(count);
  for (std::size_t b = 0; b < count; ++b) {
    if (at + sizes[b] > bytes.size()) throw SharedParts::other_bake();
    blocks[b] = bytes.substr(at, sizes[b]);
    at += sizes[b];
  }
  return blocks;
}

template <int D>
void serialize(Archive& archive, MapSettings<D>& settings) {
  for (int& along : settings.resolution) archive(along);
  archive(settings.back);
  archive(settings.spacing);
}

}  // namespace

template <int D>
std::vector<BakePart> MapParts<D>::parts() const {
  std::vector<BakePart> parts;
  for (int side = 0; side < (settings_.back ? 2 : 1); ++side) {
    BakePart of_side{PartKind::maps};
    of_side.back = side;
    add_parts(parts, of_side, points_.size(), MapSweeps<D>::points_at_once);
  }
  return parts;
}

template <int D>
std::string MapParts<D>::traced(const BakePart& part, Progress& progress) {
  if (!sweeps_) {
    lattice_ = std::make_unique<const TexelLattice<D>>(
        map_lattice(tracer_.scene(), 0, settings_.resolution));
    sweeps_.emplace(tracer_, 0, points_, *lattice_, *lattice_, settings_.spacing);
  }
  std::vector<std::size_t> numbers(part.end - part.begin);
  std::iota(numbers.begin(), numbers.end(), part.begin);
  const PointCodes codes = sweeps_->codes(numbers, part.back != 0, progress);
  const bool has_dark = std::find(codes.begin(), codes.end(), VisibilityCode::dark) != codes.end();
  return joined(stored_codes(codes, lattice_->active.size(), numbers.size()), has_dark);
}

template <int D>
std::shared_ptr<const DirectLight<D>> MapParts<D>::light(
    const std::vector<std::string>& results) const {
  StoredMaps<D> maps;
  maps.lattice = map_lattice(tracer_.scene(), 0, settings_.resolution);
  maps.points = points_.size();
  maps.code_range =
      MapSweeps<D>(tracer_, 0, points_, maps.lattice, maps.lattice, settings_.spacing).code_range();
  maps.has_back = settings_.back;
  const std::size_t blocks = blocks_of(maps.lattice.active.size(), StoredMaps<D>::block);
  for (auto& side : maps.codes) side.resize(blocks * maps.points);
  const std::vector<BakePart> all = parts();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t some = all[i].end - all[i].begin;
    std::vector<std::string> of_part = split(results.at(i), blocks * some, maps.has_dark);
    for (std::size_t b = 0; b < blocks; ++b) {
      for (std::size_t p = 0; p < some; ++p) {
        maps.codes[all[i].back][b * maps.points + all[i].begin + p] =
            std::move(of_part[b * some + p]);
      }
    }
  }
  try {
    return std::make_shared<const DirectLight<D>>(tracer_, 0, points_, maps);
  } catch (const std::runtime_error&) {
    throw SharedParts::other_bake();
  }
}

template <int D>
void MapParts<D>::write(std::ostream& stream, MapSettings<D> settings,
                        const std::vector<std::string>& parts) {
  Archive archive(stream);
  serialize(archive, settings);
  std::size_t count = parts.size();
  archive(count);
  for (const std::string& part : parts) {
    std::size_t size = part.size();
    archive(size);
    stream.write(part.data(), static_cast<std::streamsize>(size));
  }
}

template <int D>
std::pair<MapSettings<D>, std::vector<std::string>> MapParts<D>::read(std::istream& stream) {
  Archive archive(stream);
  MapSettings<D> settings;
  serialize(archive, settings);
  std::size_t count = 0;
  archive(count);
  std::vector<std::string> parts(count);
  for (std::string& part : parts) {
    std::size_t size = 0;
    archive(size);
    part.resize(size);
    stream.read(part.data(), static_cast<std::streamsize>(size));
  }
  return {settings, std::move(parts)};
}

template class MapParts<2>;
template class MapParts<3>;

}  // namespace leaflight
