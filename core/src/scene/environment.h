// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "base/affine.h"
#include "scene/texture.h"

namespace leaflight {

// The environment light: a constant radiance, or a latitude-longitude image.
template <int D>
struct Environment {
  std::string name = "world";
  Rgb radiance{0};                       // [W/(m^2 sr)]; multiplies the image
  std::shared_ptr<const Texture> image;  // 3D only; null: constant
  // The rotation from world directions to those of the image; the identity without an image. As in
  // Blender, the image's center column is along +x, and its upper rows are towards +z.
  Affine<D> world_to_image;
};

}  // namespace leaflight
