// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/field_grid.h"

#include <openvdb/tools/Prune.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <memory>
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
    Leaf filled;
    for (auto leaf = tree().cbeginLeaf(); leaf; ++leaf) {
      load_voxels(field_, leaf->origin(), background(), filled);
      filled.writeBuffers(stream, saveFloatAsHalf());
    }
  }

 private:
  const Field<3>& field_;
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

}  // namespace leaflight
