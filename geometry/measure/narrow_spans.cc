// SPDX-License-Identifier: MIT
#include "geometry/measure/narrow_spans.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kNarrow = 0x1p-28;  // of the domain

// The longest way across a span, along the iso-curves of the other direction's Greville places.
double Across(const NurbsSurface& surface, Direction direction, double from, double to) {
  const bool in_u = direction == Direction::kU;
  const SplineBasis& other = in_u ? surface.basis_v() : surface.basis_u();
  double longest = 0;
  for (int k = 0; k < other.size(); ++k) {
    const double at = other.Clamp(other.Greville(k));
    const Eigen::Vector3d way = in_u ? surface.At(to, at) - surface.At(from, at)
                                     : surface.At(at, to) - surface.At(at, from);
    longest = std::max(longest, way.norm());
  }
  return longest;
}

}  // namespace

void RefuseNarrowSpans(const char* function, const NurbsSurface& surface, double tolerance) {
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
    for (const int span : basis.Spans()) {
      const double from = basis.knots()[static_cast<std::size_t>(span)],
                   to = basis.knots()[static_cast<std::size_t>(span) + 1];
      if (to - from >= kNarrow * (basis.upper() - basis.lower())) continue;
      const double across = Across(surface, direction, from, to);
      if (across <= tolerance) continue;
      throw std::invalid_argument(std::string(function) + ": the surface moves by " +
                                  NumberText(across) + " across the knot span from " +
                                  NumberText(from) + " to " + NumberText(to) +
                                  ", which is too narrow to be followed");
    }
  }
}

}  // namespace batten::internal
