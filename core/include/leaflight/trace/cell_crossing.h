// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "leaflight/field/field.h"

namespace leaflight {

// h - c along a segment through one cell: sum_i coefficient[i] * s^i, s in [0,1].
using SegmentPolynomial = std::array<double, 4>;

template <int D>
SegmentPolynomial along_segment(const CellCorners<D>& corners, double isovalue, const Vec<D>& from,
                                const Vec<D>& to);

double evaluate(const SegmentPolynomial& p, double s);

// The first s in [0,1] at which the polynomial leaves the side `above` (p >= 0) or below (p < 0)
// on which the segment starts, or nothing. The starting side is given, not read off p(0): it was
// decided once, on the shared face or by the leaf from which the ray starts, and two cells never
// disagree about it. The root is bracketed by the critical points (derivative split), then found
// by Newton steps that never leave the bracket.
std::optional<double> first_crossing(const SegmentPolynomial& p, bool above);

}  // namespace leaflight
