// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/output/radiance_grid.h"
#include "bake/texels/checkpoint.h"
#include "bake/texels/isovalue_error.h"
#include "bake/walls/wall_radiance.h"

namespace leaflight {

// Lights all isosurfaces of a scene in blocks, which are independent of each other, and has a whole
// bake after any number of them. The driver (passes.h) decides how many there are. The same blocks
// give the same bits.
template <int D>
class Integrator {
 public:
  virtual ~Integrator() = default;

  // Adds at most so many blocks. go_on(), if given, is called after each of them, and after each
  // step that comes before the first one; false ends add().
  virtual void add(int blocks, const std::function<bool()>& go_on = {}) = 0;
  // Its state, as it is whenever go_on() is called. An add() that was interrupted goes on with one
  // of the blocks that are missing then.
  virtual void serialize(Archive& archive) = 0;
  // All that are averaged, with those of a bake that it goes on with.
  virtual int blocks() const = 0;
  // Of a block, in the unit of the progress.
  virtual double cost() const = 0;

  // Of each volume of the scene.
  virtual std::vector<RadianceGrid<D>> grids() = 0;
  // The noise of what grids() found, by the standard errors of the texels.
  virtual const IsovalueErrors& errors() const = 0;
  // Once the scene knows their direct light.
  virtual WallRadiance<D> walls() = 0;
};

}  // namespace leaflight
