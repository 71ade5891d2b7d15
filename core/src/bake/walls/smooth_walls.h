// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/walls/subdivided_mesh.h"
#include "math/progress.h"

namespace leaflight {

// What samples say of one side of a mesh, [node * vertices + vertex]: two halves of the samples,
// each with a mean of its own.
using Halves = std::array<std::vector<Vec<3, float>>, 2>;

std::vector<Vec<3, float>> mean(const Halves& halves);

// Both halves, with the noise taken out that few samples leave: each vertex becomes the
// mean of those around it, at its node and the next ones, that differ from it by no more than their
// noise lets expect, so that edges of shadows stay. The noise is estimated from the difference of
// the halves; the weights of one half come from the other, whose noise is independent (Rousselle
// 2012). Each pass reaches one facet and one node further.
template <int D>
Halves smooth(const FineMesh<D>& mesh, Halves halves, int passes, Progress& progress);

}  // namespace leaflight
