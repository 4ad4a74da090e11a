// SPDX-License-Identifier: MIT
#include "io/exchange/file_loops.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/join.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reverse.h"
#include "geometry/editing/loop_nesting.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

using Curve = NurbsCurve<2>;

Eigen::Vector2d Start(const Curve& curve) { return curve.At(curve.basis().lower()); }
Eigen::Vector2d End(const Curve& curve) { return curve.At(curve.basis().upper()); }

// The larger of the gaps in u and v, as shares of the sides.
double Gap(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Array2d& sides) {
  return ((a - b).array().abs() / sides).maxCoeff();
}

std::string GapText(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double largest_gap) {
  const Eigen::Vector2d gap = (a - b).cwiseAbs();
  return NumberText(gap[0]) + ", " + NumberText(gap[1]) + " apart, more than " +
         NumberText(largest_gap) + " of the domain";
}

// Turns pieces round so that each begins nearest to where the one before it ends.
void TurnPieces(std::vector<Curve>& pieces, const Eigen::Array2d& sides) {
  if (pieces.size() < 2) return;
  const auto nearest = [&](const Eigen::Vector2d& p) {
    return std::min(Gap(p, Start(pieces[1]), sides), Gap(p, End(pieces[1]), sides));
  };
  if (nearest(Start(pieces[0])) < nearest(End(pieces[0]))) pieces[0] = Reversed(pieces[0]);
  for (size_t i = 1; i < pieces.size(); ++i) {
    const Eigen::Vector2d from = End(pieces[i - 1]);
    if (Gap(from, End(pieces[i]), sides) < Gap(from, Start(pieces[i]), sides)) {
      pieces[i] = Reversed(pieces[i]);
    }
  }
}

// The loop, moved onto the domain where it leaves it by no more than `largest_gap` of it.
Curve InDomain(const NurbsSurface& surface, const Curve& loop, double largest_gap, size_t index) {
  constexpr double kRounding = 1e-12;
  const auto box = BoundingBox(loop);
  const Eigen::Array2d sides = DomainSides(surface);
  Curve::Points points = loop.control_points();
  const SplineBasis* bases[] = {&surface.basis_u(), &surface.basis_v()};
  for (int k = 0; k < 2; ++k) {
    const double lower = bases[k]->lower(), upper = bases[k]->upper();
    const double low = box.min()[k], high = box.max()[k];
    if (!(low >= lower - largest_gap * sides[k] && high <= upper + largest_gap * sides[k])) {
      throw LoopError(index,
                      std::string("reaches from ") + "uv"[k] + " = " + NumberText(low) + " to " +
                          NumberText(high) + ", outside the domain " + IntervalText(lower, upper));
    }
    const double slack = kRounding * sides[k];
    if ((low >= lower - slack && high <= upper + slack) || !(low < high)) continue;
    const double to_low = std::max(low, lower), to_high = std::min(high, upper);
    points.row(k) = to_low + (points.row(k).array() - low) * ((to_high - to_low) / (high - low));
  }
  if (points == loop.control_points()) return loop;
  return loop.basis().periodic() ? loop : Curve(loop.basis(), std::move(points), loop.weights());
}

}  // namespace

Eigen::Array2d DomainSides(const NurbsSurface& surface) {
  return {surface.basis_u().upper() - surface.basis_u().lower(),
          surface.basis_v().upper() - surface.basis_v().lower()};
}

Curve Chained(std::vector<Curve> pieces,
              const Eigen::Array2d& sides,
              double largest_gap,
              bool either_way) {
  constexpr double kSmooth = 1e-10;
  if (pieces.empty()) throw std::invalid_argument("Chained: a loop without a curve");
  if (either_way) TurnPieces(pieces, sides);
  Curve chain = pieces[0];
  for (size_t i = 1; i < pieces.size(); ++i) {
    const Eigen::Vector2d end = End(chain), start = Start(pieces[i]);
    if (!(Gap(end, start, sides) <= largest_gap)) {
      throw std::invalid_argument("the end of curve " + std::to_string(i - 1) +
                                  " and the start of curve " + std::to_string(i) + " are " +
                                  GapText(end, start, largest_gap));
    }
    const double joint = chain.basis().upper();
    chain = Join(chain, pieces[i], 2 * (end - start).norm());
    const int multiplicity = chain.basis().Multiplicity(joint);
    chain = RemoveKnot(chain, joint, multiplicity, kSmooth * sides.minCoeff()).shape;
  }
  return chain;
}

Curve Shut(const Curve& loop, const Eigen::Array2d& sides, double largest_gap) {
  const Eigen::Vector2d start = Start(loop), end = End(loop);
  const double gap = Gap(start, end, sides);
  if (gap <= kLoopClosure) return loop;
  if (!(gap <= largest_gap)) {
    throw std::invalid_argument("does not close: its ends are " + GapText(start, end, largest_gap));
  }
  const Curve clamped = Clamped(loop);
  Curve::Points points = clamped.control_points();
  points.rightCols<1>() = points.leftCols<1>().eval();
  return Curve(clamped.basis(), std::move(points), clamped.weights());
}

Curve DomainBoundary(const NurbsSurface& surface) {
  const double u0 = surface.basis_u().lower(), u1 = surface.basis_u().upper();
  const double v0 = surface.basis_v().lower(), v1 = surface.basis_v().upper();
  Eigen::Matrix2Xd corners(2, 5);
  corners << u0, u1, u1, u0, u0, v0, v0, v1, v1, v0;
  return Curve(SplineBasis::Uniform(1, 5, 0, 4), corners);
}

bool OneHoldsAll(const std::vector<Curve>& loops) {
  if (loops.empty()) return true;
  std::vector<Eigen::Matrix2Xd> polygons;
  for (const Curve& loop : loops) polygons.push_back(NestingPolygon(loop));
  const auto largest =
      std::max_element(polygons.begin(), polygons.end(), [](const auto& a, const auto& b) {
        return std::abs(PolygonArea(a)) < std::abs(PolygonArea(b));
      });
  return std::all_of(polygons.begin(), polygons.end(), [&](const auto& polygon) {
    return &polygon == &*largest || MostlyInside(polygon, *largest);
  });
}

NurbsSurface WithTurnedLoops(const NurbsSurface& surface,
                             std::vector<Curve> loops,
                             double largest_gap,
                             LoopRole role) {
  if (loops.empty()) return surface.WithTrims({});
  const Eigen::Array2d sides = DomainSides(surface);
  std::vector<Eigen::Matrix2Xd> polygons;
  std::vector<double> areas;
  for (size_t i = 0; i < loops.size(); ++i) {
    loops[i] = InDomain(surface, loops[i], largest_gap, i);
    polygons.push_back(NestingPolygon(loops[i]));
    areas.push_back(PolygonArea(polygons.back()));
    if (!(std::abs(areas.back()) > 1e-12 * sides.prod())) {
      throw LoopError(i, "encloses no area");
    }
  }
  size_t first = 0;
  std::vector<char> outer(loops.size(), 0);
  if (role == LoopRole::kHolesInTheLargest) {
    for (size_t i = 0; i < loops.size(); ++i)
      if (std::abs(areas[i]) > (1 + 1e-9) * std::abs(areas[first])) first = i;
    outer[first] = 1;
  } else {
    const std::vector<int> enclosing = EnclosingPolygons(polygons);
    for (size_t i = 0; i < loops.size(); ++i) {
      int depth = 0;
      for (int k = enclosing[i]; k >= 0; k = enclosing[k]) ++depth;
      outer[i] = depth % 2 == 0;
    }
    first = static_cast<size_t>(std::find(outer.begin(), outer.end(), 1) - outer.begin());
  }
  std::vector<Curve> turned;
  const auto add = [&](size_t i) {
    turned.push_back((areas[i] > 0) == (outer[i] != 0) ? loops[i] : Reversed(loops[i]));
  };
  add(first);
  for (size_t i = 0; i < loops.size(); ++i)
    if (i != first) add(i);
  return surface.WithTrims(std::move(turned));
}

}  // namespace batten::internal
