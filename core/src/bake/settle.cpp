// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/settle.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

const Scene<3>& checked(const Scene<3>& scene, const SettleSettings& settings) {
  validate(scene);
  if (settings.volume < 0 || settings.volume >= static_cast<int>(scene.volumes.size())) {
    throw Error("There is no volume of number " + std::to_string(settings.volume) +
                " in the scene; it has " + std::to_string(scene.volumes.size()) + ".");
  }
  const Volume<3>& volume = scene.volumes[settings.volume];
  if (volume.scattering != Scattering::diffuse) {
    throw Error("What \"" + volume.name + "\" shows depends on the view, since it is a mirror or " +
                "glass: settle something diffuse.");
  }
  if (settings.above && has_specular(scene)) {
    throw Error("The inner side of \"" + volume.name +
                "\" cannot be settled beside mirrors or glass: settle the outer side, or show the "
                "baked light.");
  }
  return scene;
}

// What the bake says of the indirect light of the vertices; of the inner side it keeps the whole
// light alone.
std::vector<Vec<3, float>> baked_indirect(const Field<3>& field, const RadianceGrid<3>& grid,
                                          const std::vector<Vec<3, float>>& vertices, bool above) {
  std::vector<Vec<3, float>> result(vertices.size(), Vec<3, float>(0));
  if (above) return result;
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t v) {
    const Vec3 position = field.world_to_index.point(Vec3(vertices[v]));
    const RadianceLevel<3>& from = grid.at(position);
    result[v] = lookup(from.lattice, from.radiance_indirect, position);
  });
  return result;
}

}  // namespace

Settle::Settle(const Scene<3>& scene, const RadianceGrid<3>& grid, IsosurfaceMesh mesh,
               const SettleSettings& settings)
    : tracer_(checked(scene, settings)),
      lights_(tracer_),
      leaf_{settings.volume, settings.c, settings.above,
            VertexFans(mesh.vertices.size(), mesh.triangles), std::move(mesh.vertices)},
      direct_(tracer_, lights_, leaf_, settings.tolerance, settings.seed),
      indirect_(tracer_, lights_, leaf_, mesh.normals,
                baked_indirect(scene.volumes[settings.volume].field, grid, leaf_.vertices,
                               settings.above),
                settings.seed) {
  const bool traces_paths = !has_specular(scene);
  for (std::size_t i = 0; i < SettledDirect::rays_after.size(); ++i) {
    rounds_.push_back(Round::direct);
    if (traces_paths && i < SettledIndirect::passes_per_path) rounds_.push_back(Round::indirect);
  }
}

void Settle::refine(Progress& progress) {
  if (done_ == rounds()) return;
  progress.expect(rounds());
  progress.begin("Light of the isosurface at rest");
  if (rounds_[done_] == Round::direct) {
    direct_.trace(progress, rays_);
  } else {
    indirect_.trace(progress, rays_);
  }
  ++done_;
}

Settle::Settled Settle::settled() const {
  Settled result{direct_.radiance(), direct_.error()};
  const SettledIndirect::Found indirect = indirect_.found();
  for (std::size_t v = 0; v < result.radiance.size(); ++v) {
    result.radiance[v] += indirect.radiance[v];
    result.error[v] = std::hypot(result.error[v], indirect.error[v]);
  }
  return result;
}

}  // namespace leaflight
