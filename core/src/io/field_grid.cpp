// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/field_grid.h"

#include <openvdb/io/io.h>
#include <openvdb/tools/Prune.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace leaflight {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// Fills the leaf node at `origin` with the voxels of the field; the rest is background.
void load_voxels(const Field<3>& field, const openvdb::Coord& origin, float background,
                 Leaf& leaf) {
  leaf.setOrigin(origin);
  leaf.fill(background, false);
  Index<3> low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = origin[a];
    high[a] = std::min(low[a] + static_cast<int>(Leaf::DIM), field.dims[a]);
  }
  std::visit(
      [&](const auto* values) {
        for_each_index<3>(low, high, [&](const Index<3>& voxel) {
          const float h = values[field.offset(voxel)];
          if (std::isnan(h)) return;
          leaf.setValueOn(Leaf::coordToOffset(openvdb::Coord(voxel[0], voxel[1], voxel[2])), h);
        });
      },
      field.values);
}

class FieldGrid final : public openvdb::FloatGrid {
 public:
  FieldGrid(const Field<3>& field, float masked) : Grid(masked), field_(field) {}

  // Returns a special type, which prevents OpenVDB from reading values that are not there. It would
  // compress them to compute their sizes before it writes them.
  openvdb::Name type() const override { return gridType() + "_of_field"; }

  // Writes the values in the tree's order of leaf nodes.
  void writeBuffers(std::ostream& stream) const override {
    std::vector<openvdb::Coord> origins;
    for (auto leaf = tree().cbeginLeaf(); leaf; ++leaf) origins.push_back(leaf->origin());
    const std::size_t count = (origins.size() + run_of_leaves - 1) / run_of_leaves;
    runs_.assign(1, static_cast<std::uint64_t>(stream.tellp()));
    std::vector<std::string> runs(std::min(runs_at_once, count));
    for (std::size_t first = 0; first < count; first += runs.size()) {
      const std::size_t some = std::min(runs.size(), count - first);
      tbb::parallel_for(std::size_t{0}, some, [&](std::size_t r) {
        const std::size_t begin = (first + r) * run_of_leaves;
        runs[r] = buffers(stream, &origins[begin], std::min(run_of_leaves, origins.size() - begin));
      });
      for (std::size_t r = 0; r < some; ++r) {
        stream.write(runs[r].data(), static_cast<std::streamsize>(runs[r].size()));
        runs_.push_back(runs_.back() + runs[r].size());
      }
    }
  }
  const std::vector<std::uint64_t>& runs() const { return runs_; }

 private:
  static constexpr std::size_t runs_at_once = 64;

  // Returns the bytes of leaf nodes for a stream.
  std::string buffers(std::ostream& stream, const openvdb::Coord* origins,
                      std::size_t count) const {
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::StreamMetadata(stream).transferTo(bytes);
    Leaf filled;
    for (std::size_t i = 0; i < count; ++i) {
      load_voxels(field_, origins[i], background(), filled);
      filled.writeBuffers(bytes, saveFloatAsHalf());
    }
    return bytes.str();
  }

  const Field<3>& field_;
  mutable std::vector<std::uint64_t> runs_;
};

// A block of 8^3 voxels.
struct Node {
  std::unique_ptr<Leaf> leaf;  // without values; null: all voxels are equal
  float value = 0;
  bool active = false;
};

}  // namespace

openvdb::FloatGrid::Ptr field_grid(const Field<3>& field) {
  // OpenVDB cannot compare NaN, so masked voxels get a value that no other voxel has.
  constexpr float lowest = std::numeric_limits<float>::lowest();
  const float masked = field.min > lowest ? lowest : std::numeric_limits<float>::infinity();
  const auto grid = std::make_shared<FieldGrid>(field, masked);
  Index<3> blocks;
  for (int a = 0; a < 3; ++a) blocks[a] = (field.dims[a] + Leaf::DIM - 1) / Leaf::DIM;
  std::vector<Node> nodes(cell_count<3>(blocks));
  const auto origin_of = [&](std::size_t b) {
    const Index<3> block = index_of<3>(b, blocks);
    return openvdb::Coord(block[0], block[1], block[2]) << static_cast<int>(Leaf::LOG2DIM);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), 64), [&](const auto& range) {
    // Reuse one leaf, because repeated allocations would leave gaps between the nodes.
    Leaf filled;
    for (std::size_t b = range.begin(); b != range.end(); ++b) {
      load_voxels(field, origin_of(b), masked, filled);
      Node& node = nodes[b];
      if (filled.isConstant(node.value, node.active)) continue;
      node.leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), filled.origin());
      node.leaf->setValueMask(filled.getValueMask());
    }
  });
  auto accessor = grid->getAccessor();
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    Node& node = nodes[b];
    if (node.leaf) {
      accessor.addLeaf(node.leaf.release());
    } else if (node.active) {
      accessor.addTile(1, origin_of(b), node.value, true);
    }
  }
  openvdb::tools::pruneTiles(grid->tree());
  return grid;
}

const std::vector<std::uint64_t>& runs_of(const openvdb::FloatGrid& field_grid) {
  return dynamic_cast<const FieldGrid&>(field_grid).runs();
}

namespace {

std::runtime_error damaged() { return std::runtime_error("the values of its volume are damaged"); }

// Dense voxels that are filled in parallel.
template <class Value>
class Filled {
 public:
  explicit Filled(const Index<3>& dims) : dims_(dims), values_(cell_count<3>(dims)) {
    if (std::is_same_v<Value, float>) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values_.size(), 1 << 16),
                        [&](const auto& range) {
                          std::fill(values_.begin() + range.begin(), values_.begin() + range.end(),
                                    static_cast<Value>(nan));
                        });
    }
  }
  // Sets the voxels of a box to the values of value(coordinates). NaN leaves voxels as they are.
  template <class Source>
  void fill(const openvdb::CoordBBox& box, const Source& value) {
    Index<3> low, high;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::max(box.min()[a], 0);
      high[a] = std::min(box.max()[a], dims_[a] - 1) + 1;
    }
    std::size_t filled = 0;
    for (int z = low[2]; z < high[2]; ++z) {
      for (int y = low[1]; y < high[1]; ++y) {
        Value* const row = values_.data() + linear_number<3>({0, y, z}, dims_);
        for (int x = low[0]; x < high[0]; ++x) {
          const float h = value(openvdb::Coord(x, y, z));
          if (std::isnan(h)) continue;
          if (!fits(h)) throw damaged();
          row[x] = static_cast<Value>(h);
          ++filled;
        }
      }
    }
    filled_ += filled;
  }
  // Throws Error if voxels of integers are missing.
  VoxelBuffer take() {
    if (!std::is_same_v<Value, float> && filled_ != values_.size()) throw damaged();
    return std::move(values_);
  }

 private:
  static constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  static bool fits(float h) {
    using Limits = std::numeric_limits<Value>;
    return std::is_same_v<Value, float> ||
           (h >= Limits::lowest() && h <= Limits::max() && h == std::trunc(h));
  }

  Index<3> dims_;
  std::vector<Value> values_;
  std::atomic<std::size_t> filled_{0};
};

template <class Value>
VoxelBuffer read_as(const VdbGrids& file, const std::string& name, const Index<3>& dims,
                    const std::vector<std::uint64_t>& runs) {
  std::ifstream stream = file.stream();
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.topology(name, stream));
  if (!grid) throw damaged();
  const openvdb::FloatTree& tree = grid->tree();
  std::vector<openvdb::Coord> origins;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) origins.push_back(leaf->origin());
  if (runs.size() != (origins.size() + run_of_leaves - 1) / run_of_leaves + 1) throw damaged();
  Filled<Value> voxels(dims);
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    const float h = *tile;
    voxels.fill(box, [h](const openvdb::Coord&) { return h; });
  }
  tbb::parallel_for(std::size_t{1}, runs.size(), [&](std::size_t r) {
    std::istringstream bytes(file.bytes(runs[r - 1], runs[r]), std::ios::binary);
    bytes.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::StreamMetadata(stream).transferTo(bytes);
    Leaf leaf;
    const std::size_t end = std::min(r * run_of_leaves, origins.size());
    for (std::size_t i = (r - 1) * run_of_leaves; i < end; ++i) {
      leaf.setOrigin(origins[i]);
      leaf.readBuffers(bytes, grid->saveFloatAsHalf());
      voxels.fill(leaf.getNodeBoundingBox(), [&](const openvdb::Coord& at) {
        const openvdb::Index place = Leaf::coordToOffset(at);
        return leaf.isValueOn(place) ? leaf.buffer().data()[place]
                                     : std::numeric_limits<float>::quiet_NaN();
      });
    }
  });
  return voxels.take();
}

}  // namespace

VoxelBuffer read_voxels(const VdbGrids& file, const std::string& name, const Index<3>& dims,
                        std::size_t type, const std::vector<std::uint64_t>& runs) {
  switch (type) {
    case 1:
      return read_as<std::uint8_t>(file, name, dims, runs);
    case 2:
      return read_as<std::int16_t>(file, name, dims, runs);
    case 3:
      return read_as<std::uint16_t>(file, name, dims, runs);
    default:
      return read_as<float>(file, name, dims, runs);
  }
}

}  // namespace leaflight
