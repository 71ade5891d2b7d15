// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/lit_scene.h"

#include "bake/walls/wall_light.h"
#include "transport/placement.h"

namespace leaflight {

template <int D>
LitScene<D>::LitScene(const Scene<D>& scene, const BakeSettings<D>& settings_, const Plan& plan_,
                      Progress& progress_)
    : settings(settings_),
      plan(plan_),
      progress(progress_),
      tracer(scene),
      lights(tracer),
      split(split_light(tracer)),
      direct(scene.volumes.size()) {
  check_placement(tracer);
  empty_.reserve(scene.volumes.size());
  for (std::size_t v = 0; v < scene.volumes.size(); ++v) {
    const Volume<D>& volume = scene.volumes[v];
    empty_.emplace_back(volume.field, volume.isovalues(scene.isovalue_range).min);
    volumes.push_back({tracer, static_cast<int>(v), empty_[v]});
  }
}

template <int D>
const std::vector<SubdividedMesh<D>>& LitScene<D>::subdivided() {
  if (subdivided_.empty()) subdivided_ = subdivide(tracer.scene());
  return subdivided_;
}

template <int D>
void LitScene<D>::compute_visibility_maps(const std::vector<Index<D>>& texels, double spacing) {
  progress.begin("Direct light");
  // With several volumes, backs would need two maps, so they have none.
  const bool back = plan.back && volumes.size() == 1;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    if (!stores_light_of(v)) continue;
    const Index<D> resolution = map_resolution(
        volumes[v].volume().field, volumes[v].isovalue_range(), texels[v], split.points.size());
    const MapSettings<D> of_volume{resolution, back, spacing};
    const bool is_shared = workers && spacing == 1 && volumes.size() == 1;
    direct[v] = is_shared ? shared_maps(of_volume)
                          : std::make_shared<const DirectLight<D>>(
                                tracer, static_cast<int>(v), split.points, of_volume, progress);
  }
}

template <int D>
std::shared_ptr<const DirectLight<D>> LitScene<D>::shared_maps(
    const MapSettings<D>& of_volume) const {
  MapParts<D> maps(tracer, split.points, of_volume);
  const auto send = [&](std::vector<std::string>& packed) {
    workers->send(PartData::maps,
                  [&](std::ostream& stream) { MapParts<D>::write(stream, of_volume, packed); });
  };
  std::vector<std::string> packed;
  send(packed);
  const SharedParts shared(*workers, maps.parts());
  const double texels = static_cast<double>(cell_count<D>(of_volume.resolution));
  for (std::size_t i = 0; i < shared.parts().size(); ++i) {
    const BakePart& part = shared.parts()[i];
    const auto points = static_cast<double>(part.end - part.begin);
    std::optional<std::string> bytes =
        shared.take(i, MapSweeps<D>::work_of_texel * points * texels, progress);
    packed.push_back(bytes ? *std::move(bytes) : maps.traced(part, progress));
  }
  send(packed);
  return maps.light(packed);
}

template <int D>
void LitScene<D>::share_shadow_rays() {
  if (!workers || !plan.walls || computed_share_ == 1 || shadow_rays_ || wall_detail.share > 1) {
    return;
  }
  shadow_rays_.emplace(tracer, subdivided());
  shared_ = SharedParts(*workers, shadow_rays_->parts());
}

template <int D>
void LitScene<D>::compute_wall_direct_light() {
  if (computed_share_ == wall_detail.share) return;
  progress.begin("Shadows on walls");
  if (shadow_rays_ && wall_detail.share == 1) {
    direct_of_walls =
        std::make_shared<const MeshDirectLight<D>>(shadow_rays_->light(shared_, progress));
    shadow_rays_.reset();
    shared_ = {};
    computed_share_ = 1;
    return;
  }
  direct_of_walls =
      std::make_shared<const MeshDirectLight<D>>(tracer, subdivided(), progress, wall_detail.share);
  computed_share_ = wall_detail.share;
}

template <int D>
double LitScene<D>::cost_of_walls() {
  if (!plan.walls) return 0;
  const bool is_computed = computed_share_ == wall_detail.share;
  const double shadow_rays =
      is_computed ? 0 : work_of_shadow_rays(tracer, subdivided(), wall_detail.share);
  return shadow_rays +
         (plan.lines ? work_of_samples(tracer, subdivided(), wall_detail.samples) : 0);
}

template struct LitScene<2>;
template struct LitScene<3>;

}  // namespace leaflight
