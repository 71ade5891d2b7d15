// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/visibility_sweep.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "bake/direct/line_fan.h"
#include "bake/texels/line_volume.h"
#include "trace/line_bundle.h"

namespace leaflight {
namespace {

// Code of masked voxels; no isosurface passes next to them.
constexpr float masked_code = -1e9f;
// Lines from a light that is this many voxels away count as parallel. Numbers of lines between it
// and the volume would exceed 32 bits.
constexpr double parallel_from = 1e9;

// A plane of codes, axis `u` fastest.
struct CodePlane {
  int u_count = 0, v_count = 0;
  std::vector<float> codes;

  const float* row(int v) const { return codes.data() + static_cast<std::size_t>(v) * u_count; }
};

// Inputs that all sweeps through a volume share; see VisibilitySweep.
template <int D>
struct SweptVolume {
  const SceneTracer<D>& tracer;
  int volume;
  const TexelLattice<D>& nodes;
  Voxels turned;
  double spacing;
};

// The sweep along one axis in one direction. It serves the nodes that the light reaches that way.
template <int D>
class AxisSweep {
 public:
  AxisSweep(const SweptVolume<D>& swept, const LightSource<D>& source, const VisibilityCode& code,
            bool meshes, int axis, int sense)
      : tracer_(swept.tracer),
        field_(tracer_.scene().volumes[swept.volume].field),
        turned_(swept.turned),
        source_(source),
        nodes_(swept.nodes),
        code_(code),
        axis_(axis),
        sense_(sense),
        to_frame_(tracer_.index_to_frame(swept.volume)),
        planes_(field_, nodes_, axis),
        meshes_(meshes),
        spacing_(swept.spacing) {
    const double width = nodes_.voxels_per_texel[axis];
    if (spacing_ >= width) {
      auto& all = planes_.planes;
      const auto is_between = [](const auto& plane) { return plane.texel < 0; };
      all.erase(std::remove_if(all.begin(), all.end(), is_between), all.end());
    }
    for (int a = 0, b = 0; a < D; ++a) {
      if (a != axis) across_[b++] = a;
    }
    const Affine<D> to_index = inverse(to_frame_);
    const auto count = static_cast<int>(planes_.planes.size());
    for (int i = 0; i < count; ++i) order_.push_back(sense > 0 ? i : count - 1 - i);
    if (source.infinite) {
      const Vec<D> direction = to_index.vector(source.direction);
      from_ = width * planes_.planes[order_[0]].z;
      for (int b = 0; b < D - 1; ++b) {
        fans_[b].parallel = true;
        fans_[b].slope = direction[across_[b]] / std::abs(direction[axis]);
      }
    } else {
      const Vec<D> at = to_index.point(source.position);
      from_ = at[axis];
      for (int b = 0; b < D - 1; ++b) fans_[b].offset = at[across_[b]];
    }
    // Store the coordinate of each plane in voxels, starting at the light.
    for (const int i : order_) t_.push_back(sense * (width * planes_.planes[i].z - from_));
    delay_ = count > 1 ? (count - 1) / (nodes_.resolution[axis] - 1) : 1;
    ring_.resize(delay_ + 1);
  }

  void run(std::vector<std::uint8_t>& found, Progress& progress) {
    const auto count = static_cast<int>(order_.size());
    int q = 0;
    while (q < count && !reached(q)) ++q;
    const int first = q;  // first plane that the light reaches
    if (q == count) return;
    for (int b = 0; b < D - 1; ++b) {
      LineFan& fan = fans_[b];
      fan.last_voxel = field_.dims[across_[b]] - 1;
      const double widest = widest_between(b);
      fan.step = source_.infinite ? widest : 1;
      while (!source_.infinite && fan.spacing(t_[q]) > widest && fan.step > 1e-6) fan.step /= 2;
      fan.cover(t_[q], t_.back());
      if (fan.count == 0) return;
    }
    greatest_.assign(static_cast<std::size_t>(u_lines()) * v_lines(), 0.0f);
    if (meshes_) find_walls();
    for (; q < count && !progress.cancelled(); ++q) {
      take_plane(q);
      if (q - delay_ >= first) pass(q - delay_);
      if (planes_.planes[order_[q]].texel >= 0) store(q, found);
      for (int b = 0; b < D - 1; ++b) {
        if (!source_.infinite && fans_[b].spacing(t_[q]) > widest_between(b)) halve(b, t_[q]);
      }
    }
  }

 private:
  bool reached(int q) const { return source_.infinite || t_[q] > 0; }
  double widest_between(int b) const {
    return std::min(spacing_, nodes_.voxels_per_texel[across_[b]]);
  }
  int u_lines() const { return fans_[0].count; }
  int v_lines() const { return D == 3 ? fans_[D - 2].count : 1; }

  // Doubles the number of lines across an axis; every second line is an old one.
  void halve(int b, double t) {
    const LineFan before = fans_[b];
    LineFan& fan = fans_[b];
    const int u_before = u_lines(), v_before = v_lines();
    fan.step /= 2;
    fan.cover(t, t_.back());
    fan.first = std::max(fan.first, 2 * before.first);
    fan.count =
        std::max(1, std::min(fan.count, 2 * (before.first + before.count - 1) - fan.first + 1));
    std::vector<float> finer(static_cast<std::size_t>(u_lines()) * v_lines());
    const auto from = [&](int i) { return i + fan.first - 2 * before.first; };
    for (int v = 0; v < v_lines(); ++v) {
      for (int u = 0; u < u_lines(); ++u) {
        const int doubled = from(b == 0 ? u : v), low = doubled / 2, high = (doubled + 1) / 2;
        const auto old = [&](int i) {
          const int row = b == 0 ? v : i, column = b == 0 ? i : u;
          return greatest_[static_cast<std::size_t>(std::min(row, v_before - 1)) * u_before +
                           std::min(column, u_before - 1)];
        };
        finer[static_cast<std::size_t>(v) * u_lines() + u] = 0.5f * (old(low) + old(high));
      }
    }
    greatest_ = std::move(finer);
    if (meshes_) find_walls();
  }

  // Finds the distance along the axis at which a mesh ends each line.
  void find_walls() {
    walls_.assign(greatest_.size(), std::numeric_limits<double>::infinity());
    for (int v = 0; v < v_lines(); ++v) {
      for (int u = 0; u < u_lines(); ++u) {
        Vec<D> one, two;  // points on the line at two distances
        const double near = source_.infinite ? 0 : 1, far = near + 1;
        one[axis_] = from_ + sense_ * near;
        two[axis_] = from_ + sense_ * far;
        const std::array<int, 2> line{u, v};
        for (int b = 0; b < D - 1; ++b) {
          one[across_[b]] = fans_[b].at(line[b], near);
          two[across_[b]] = fans_[b].at(line[b], far);
        }
        const Vec<D> per_t = to_frame_.vector(two - one);
        const double length = per_t.length();
        const Vec<D> direction = per_t / length;
        Vec<D> origin;
        double t = 0;
        if (source_.infinite) {
          const Vec<D> entry = to_frame_.point(one);
          const double back =
              2 * tracer_.bounds().radius + (entry - tracer_.bounds().center).length();
          origin = entry - direction * back;
          t = -back / length;
        } else {
          const Vec<D> normal =
              source_.normal.dot(direction) < 0 ? -source_.normal : source_.normal;
          origin = leave_plane<D>(source_.position, source_.sphere ? direction : normal);
        }
        if (const auto hit = tracer_.mesh_bvh().intersect(
                origin, direction, std::numeric_limits<double>::infinity())) {
          walls_[static_cast<std::size_t>(v) * u_lines() + u] = t + hit->t / length;
        }
      }
    }
  }

  // Computes the codes of plane q; interpolates if it lies between two planes of voxels.
  void take_plane(int q) {
    const auto& plane = planes_.planes[order_[q]];
    CodePlane& codes = ring_[q % ring_.size()];
    codes.u_count = field_.dims[across_[0]];
    codes.v_count = D == 3 ? field_.dims[across_[D - 2]] : 1;
    codes.codes.resize(static_cast<std::size_t>(codes.u_count) * codes.v_count);
    // Strides of the values, which are stored in the order of the axes or with axis 0 slowest.
    std::size_t plane_size = 1, next = 1;
    for (int a = 0; a < D; ++a) {
      if (a != axis_) plane_size *= field_.dims[a];
      if (a < axis_) next *= field_.dims[a];
    }
    const bool turned = axis_ == 0;
    if (turned) next = plane_size;
    const std::size_t row_stride =
        turned || axis_ == D - 1 ? codes.u_count : next * field_.dims[axis_];
    const auto scale = static_cast<float>(code_.back ? -code_.scale() : code_.scale());
    const float zero = code_(0);
    const auto part = static_cast<float>(plane.between);
    std::visit(
        [&](const auto* values) {
          for (int v = 0; v < codes.v_count; ++v) {
            const auto* from = values + plane.voxel * next + v * row_stride;
            const auto* after = part > 0 ? from + next : from;
            float* to = codes.codes.data() + static_cast<std::size_t>(v) * codes.u_count;
            for (int u = 0; u < codes.u_count; ++u) {
              const auto low = static_cast<float>(from[u]), high = static_cast<float>(after[u]);
              const float code = zero + (low + (high - low) * part) * scale;
              to[u] = code == code ? code : masked_code;
            }
          }
        },
        turned ? turned_ : field_.values);
  }

  // Updates the greatest code of each line with plane q.
  void pass(int q) {
    const double t = t_[q];
    const CodePlane& plane = ring_[q % ring_.size()];
    const LineFan& fan = fans_[0];
    const double margin = fan.spacing(t);
    // Clamp lines slightly outside the box to its border, because their neighbors need them.
    int begin = 0, end = u_lines();
    while (begin < end && fan.at(begin, t) < -margin) ++begin;
    while (end > begin && fan.at(end - 1, t) > fan.last_voxel + margin) --end;
    places_.resize(u_lines());
    for (int u = begin; u < end; ++u) places_[u] = between(fan.at(u, t), plane.u_count);
    row_.resize(plane.u_count + 1);
    for (int v = 0; v < v_lines(); ++v) {
      const float* row = plane.row(0);
      if constexpr (D == 3) {
        const LineFan& rows = fans_[1];
        const double y = rows.at(v, t), beside = rows.spacing(t);
        if (y < -beside || y > rows.last_voxel + beside) continue;
        const Between at = between(y, plane.v_count);
        const float *low = plane.row(at.below), *high = plane.row(at.below + 1);
        for (int u = 0; u < plane.u_count; ++u) row_[u] = low[u] + (high[u] - low[u]) * at.part;
        row = row_.data();
      }
      float* greatest = greatest_.data() + static_cast<std::size_t>(v) * u_lines();
      for (int u = begin; u < end; ++u) {
        const Between& at = places_[u];
        const float h = row[at.below] + (row[at.below + 1] - row[at.below]) * at.part;
        greatest[u] = std::max(greatest[u], std::min(h, VisibilityCode::most));
      }
    }
  }

  // Stores the codes of the lines next to each node of plane q.
  void store(int q, std::vector<std::uint8_t>& found) {
    const double t = t_[q];
    Index<D> node{};
    node[axis_] = planes_.planes[order_[q]].texel;
    const auto is_ours = [&](int b, double x) {
      if (source_.infinite) return true;
      const double off = std::abs(x - fans_[b].offset);
      return across_[b] < axis_ ? off < t : off <= t;
    };
    const int rows = D == 3 ? nodes_.resolution[across_[D - 2]] : 1;
    const int columns = nodes_.resolution[across_[0]];
    const double u_width = nodes_.voxels_per_texel[across_[0]];
    columns_.clear();
    for (int i = 0; i < columns; ++i) {
      const double x = i * u_width;
      if (!is_ours(0, x)) continue;
      const double line = (x - fans_[0].origin(t)) / fans_[0].spacing(t) - fans_[0].first;
      columns_.push_back({i, between(line, u_lines())});
    }
    row_.resize(u_lines() + 1);
    for (int j = 0; j < rows; ++j) {
      Between across;
      if constexpr (D == 3) {
        const LineFan& fan = fans_[1];
        const double y = j * nodes_.voxels_per_texel[across_[1]];
        if (!is_ours(1, y)) continue;
        across = between((y - fan.origin(t)) / fan.spacing(t) - fan.first, v_lines());
        node[across_[1]] = j;
      }
      const std::size_t low = static_cast<std::size_t>(across.below) * u_lines();
      const std::size_t high = v_lines() > 1 ? low + u_lines() : low;
      for (int u = 0; u < u_lines(); ++u) {
        row_[u] = greatest_[low + u] + (greatest_[high + u] - greatest_[low + u]) * across.part;
      }
      for (const Column& column : columns_) {
        const int u = column.place.below, next = std::min(u + 1, u_lines() - 1);
        const float code = row_[u] + (row_[next] - row_[u]) * column.place.part;
        node[across_[0]] = column.node;
        // Round down, so that an isosurface in a flat part of the field does not hide itself.
        found[nodes_.linear(node)] = static_cast<std::uint8_t>(code);
        if (!meshes_) continue;
        // A node is behind a mesh if most of the lines next to it are, by weight.
        const auto ended = [&](std::size_t line) { return walls_[line] < t ? 1.0f : 0.0f; };
        const auto between_two = [](float a, float b, float part) { return a + (b - a) * part; };
        const float dark = between_two(
            between_two(ended(low + u), ended(low + next), column.place.part),
            between_two(ended(high + u), ended(high + next), column.place.part), across.part);
        if (dark >= 0.5f) found[nodes_.linear(node)] = VisibilityCode::dark;
      }
    }
  }

  struct Column {
    int node;
    Between place;
  };

  const SceneTracer<D>& tracer_;
  const Field<D>& field_;
  Voxels turned_;
  const LightSource<D>& source_;
  const TexelLattice<D>& nodes_;
  const VisibilityCode& code_;
  int axis_, sense_;
  Affine<D> to_frame_;
  Planes<D> planes_;
  bool meshes_;
  double spacing_;
  std::array<int, 2> across_{};
  std::array<LineFan, static_cast<std::size_t>(D - 1)> fans_;
  std::vector<int> order_;  // indices of the planes in the order of the light
  std::vector<double> t_;   // voxels from the light to the planes
  double from_ = 0;         // position of the light, or start of parallel lines
  int delay_ = 1;           // planes from one plane of nodes to the next
  std::vector<CodePlane> ring_;
  std::vector<float> greatest_;  // one code per line
  std::vector<double> walls_;
  std::vector<Between> places_;
  std::vector<Column> columns_;
  std::vector<float> row_;
};

template <int D, class Value>
LargeArray<Value> turned(const Field<D>& field, const Value* values) {
  const auto width = static_cast<std::size_t>(field.dims[0]), planes = field.voxels() / width;
  LargeArray<Value> turned(field.voxels());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, planes, 64), [&](const auto& rows) {
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t row = rows.begin(); row < rows.end(); ++row) {
        turned[x * planes + row] = values[row * width + x];
      }
    }
  });
  return turned;
}

}  // namespace

template <int D>
VisibilitySweep<D>::VisibilitySweep(const SceneTracer<D>& tracer, int volume,
                                    const TexelLattice<D>& nodes, bool meshes, double spacing)
    : tracer_(tracer), volume_(volume), nodes_(nodes), meshes_(meshes), spacing_(spacing) {
  const Field<D>& field = tracer.scene().volumes[volume].field;
  std::visit([&](const auto* values) { turned_ = turned(field, values); }, field.values);
}

template <int D>
void VisibilitySweep<D>::run(const LightSource<D>& given, const VisibilityCode& code,
                             std::vector<std::uint8_t>& found, Progress& progress) const {
  found.assign(nodes_.texels(), 0);
  LightSource<D> source = given;
  const Affine<D> to_index = inverse(tracer_.index_to_frame(volume_));
  if (!source.infinite && to_index.point(source.position).length() > parallel_from) {
    source.infinite = true;
    source.direction = (tracer_.bounds().center - source.position).normalized();
  }
  const bool meshes =
      meshes_ && (source.infinite ? !tracer_.meshes().empty()
                                  : meshes_near(tracer_, volume_, &source.position));
  const SweptVolume<D> swept{
      tracer_, volume_, nodes_,
      std::visit([](const auto& values) -> Voxels { return values.data(); }, turned_), spacing_};
  const auto run_along = [&](int axis, int sense) {
    AxisSweep<D>(swept, source, code, meshes, axis, sense).run(found, progress);
  };
  if (source.infinite) {
    const Vec<D> direction = to_index.vector(source.direction);
    int along = 0;
    for (int a = 1; a < D; ++a) {
      if (std::abs(direction[a]) > std::abs(direction[along])) along = a;
    }
    run_along(along, direction[along] < 0 ? -1 : 1);
  } else {
    for (int axis = 0; axis < D; ++axis) {
      run_along(axis, 1);
      run_along(axis, -1);
    }
  }
  progress.check();
}

template class VisibilitySweep<2>;
template class VisibilitySweep<3>;

}  // namespace leaflight
