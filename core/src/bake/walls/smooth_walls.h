// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/walls/subdivided_mesh.h"
#include "base/progress.h"

namespace leaflight {

// The means of two halves of the samples on one side of a mesh; the index is node * vertices +
// vertex.
using Halves = std::array<std::vector<Vec<3, float>>, 2>;

std::vector<Vec<3, float>> mean(const Halves& halves);

// Removes noise from both halves. Each vertex becomes the mean of its neighbors, at its node and
// adjacent ones, whose differences the noise can explain. Edges of shadows therefore stay. The
// difference of the halves gives the noise. The weights of one half come from the other, whose
// noise is independent (Rousselle et al. 2012). Each pass reaches one facet and one node further.
template <int D>
Halves smooth(const FineMesh<D>& mesh, Halves halves, int passes, Progress& progress);

}  // namespace leaflight
