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

// The curve as a fine polygon.
Eigen::Matrix2Xd PolygonOf(const Curve& curve) {
  const int cuts = 4 * (curve.basis().degree() + 1);
  std::vector<double> places;
  for (const int span : curve.basis().Spans()) {
    const double a = curve.basis().knots()[span], b = curve.basis().knots()[span + 1];
    for (int i = 0; i < cuts; ++i) places.push_back(a + (b - a) * i / cuts);
  }
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(places.size()));
  for (size_t i = 0; i < places.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = curve.At(places[i]);
  }
  return points;
}

double SignedArea(const Eigen::Matrix2Xd& polygon) {
  double twice = 0;
  const Eigen::Vector2d center = polygon.rowwise().mean();
  for (Eigen::Index i = 0, j = polygon.cols() - 1; i < polygon.cols(); j = i++) {
    const Eigen::Vector2d a = polygon.col(j) - center, b = polygon.col(i) - center;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

// Whether most corners of a polygon lie in another: polygons are not exact. Corners on the other's
// sides say nothing.
bool MostlyIn(const Eigen::Matrix2Xd& polygon, const Eigen::Matrix2Xd& outer) {
  constexpr double kOnSide = 1e-9;  // of the size
  const double near = kOnSide * (outer.rowwise().maxCoeff() - outer.rowwise().minCoeff()).norm();
  Eigen::Index inside = 0, outside = 0;
  for (const auto& p : polygon.colwise()) {
    bool odd = false, on_side = false;
    for (Eigen::Index i = 0, j = outer.cols() - 1; i < outer.cols(); j = i++) {
      const Eigen::Vector2d a = outer.col(j), b = outer.col(i), along = b - a, to = p - a;
      const double square = along.squaredNorm();
      const double share = square > 0 ? std::clamp(to.dot(along) / square, 0.0, 1.0) : 0;
      on_side = on_side || (to - share * along).squaredNorm() < near * near;
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      const double x = a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (p.x() < x) odd = !odd;
    }
    if (!on_side) ++(odd ? inside : outside);
  }
  return inside >= outside;
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
  for (const Curve& loop : loops) polygons.push_back(PolygonOf(loop));
  const auto largest =
      std::max_element(polygons.begin(), polygons.end(), [](const auto& a, const auto& b) {
        return std::abs(SignedArea(a)) < std::abs(SignedArea(b));
      });
  return std::all_of(polygons.begin(), polygons.end(), [&](const auto& polygon) {
    return &polygon == &*largest || MostlyIn(polygon, *largest);
  });
}

NurbsSurface WithTurnedLoops(const NurbsSurface& surface,
                             std::vector<Curve> loops,
                             double largest_gap) {
  const Eigen::Array2d sides = DomainSides(surface);
  std::vector<double> areas;
  for (size_t i = 0; i < loops.size(); ++i) {
    loops[i] = InDomain(surface, loops[i], largest_gap, i);
    areas.push_back(SignedArea(PolygonOf(loops[i])));
    if (!(std::abs(areas.back()) > 1e-12 * sides.prod())) {
      throw LoopError(i, "encloses no area");
    }
  }
  for (size_t i = 0; i < loops.size(); ++i) {
    if (std::abs(areas[i]) > (1 + 1e-9) * std::abs(areas[0])) {
      std::rotate(loops.begin(),
                  loops.begin() + static_cast<std::ptrdiff_t>(i),
                  loops.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      std::rotate(areas.begin(),
                  areas.begin() + static_cast<std::ptrdiff_t>(i),
                  areas.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }
  for (size_t i = 0; i < loops.size(); ++i) {
    if ((areas[i] > 0) != (i == 0)) loops[i] = Reversed(loops[i]);
  }
  return surface.WithTrims(std::move(loops));
}

}  // namespace batten::internal
