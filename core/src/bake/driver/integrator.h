// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "bake/output/radiance_grid.h"
#include "bake/texels/checkpoint.h"
#include "bake/texels/isovalue_error.h"
#include "bake/walls/wall_radiance.h"

namespace leaflight {

// An integrator lights all isosurfaces of a scene in independent blocks. It can return a complete
// bake after any number of blocks. The driver (passes.h) chooses their number. The same blocks give
// the same bits.
template <int D>
class Integrator {
 public:
  virtual ~Integrator() = default;

  // Adds at most `blocks` blocks. Calls go_on() after each block and after each step before the
  // first block; add() ends when it returns false.
  virtual void add(int blocks, const std::function<bool()>& go_on = {}) = 0;
  // Serializes the state, which is valid whenever go_on() is called. An add() after an interrupted
  // one continues with the missing blocks.
  virtual void serialize(Archive& archive) = 0;
  // Returns the number of all blocks, including those of the bake that it continues.
  virtual int blocks() const = 0;
  // Returns the work of a block in the unit of the progress.
  virtual double cost() const = 0;

  // Returns one grid for each volume of the scene.
  virtual std::vector<RadianceGrid<D>> grids() = 0;
  // Returns the noise of the last grids(), from the standard errors of the texels.
  virtual const IsovalueErrors& errors() const = 0;
  // Returns the light of the walls. Requires that the scene has computed their direct light.
  virtual WallRadiance<D> walls() = 0;
};

}  // namespace leaflight
