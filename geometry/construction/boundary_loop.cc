// SPDX-License-Identifier: MIT
#include "geometry/construction/boundary_loop.h"

#include <algorithm>
#include <string>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

constexpr const char* kCoons = "Coons";

Eigen::Vector3d StartOf(const NurbsCurve<3>& curve) { return curve.control_points().leftCols<1>(); }
Eigen::Vector3d EndOf(const NurbsCurve<3>& curve) { return curve.control_points().rightCols<1>(); }

// Sides one after the other, each beginning where the one before ends, and their numbers.
struct Chain {
  std::vector<NurbsCurve<3>> sides;
  std::vector<std::size_t> numbers;
};

Chain ChainOf(std::vector<NurbsCurve<3>> sides) {
  Chain chain{{sides[0]}, {0}};
  std::vector<std::size_t> left;
  for (std::size_t k = 1; k < sides.size(); ++k) left.push_back(k);
  while (!left.empty()) {
    const Eigen::Vector3d end = EndOf(chain.sides.back());
    const auto distance = [&](std::size_t k) {
      return std::min((StartOf(sides[k]) - end).norm(), (EndOf(sides[k]) - end).norm());
    };
    const auto next = std::ranges::min_element(left, {}, distance);
    const NurbsCurve<3>& side = sides[*next];
    const bool forward = (StartOf(side) - end).norm() <= (EndOf(side) - end).norm();
    chain.sides.push_back(forward ? side : Reversed(side));
    chain.numbers.push_back(*next);
    left.erase(next);
  }
  return chain;
}

// Moves the ends that meet to their middle; the gap there was.
double CloseCorners(Chain& chain, double tolerance) {
  const std::size_t count = chain.sides.size();
  double widest = 0;
  std::vector<Eigen::Matrix3Xd> points;
  for (const NurbsCurve<3>& side : chain.sides) points.push_back(side.control_points());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    const Eigen::Vector3d end = points[k].rightCols<1>(), start = points[next].leftCols<1>();
    const double gap = (end - start).norm();
    widest = std::max(widest, gap);
    RequireThat(gap <= tolerance,
                kCoons,
                "sides " + std::to_string(chain.numbers[k] + 1) + " and " +
                    std::to_string(chain.numbers[next] + 1) +
                    " do not meet: their nearest ends are " + RoundedText(gap) +
                    " apart, above the tolerance " + NumberText(tolerance));
    points[k].rightCols<1>() = points[next].leftCols<1>() = start + (end - start) / 2;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const NurbsCurve<3>& side = chain.sides[k];
    chain.sides[k] = NurbsCurve<3>(side.basis(), std::move(points[k]), side.weights());
  }
  return widest;
}

NurbsCurve<3> PointCurve(const Eigen::Vector3d& point) {
  return NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), point.replicate<1, 2>());
}

}  // namespace

BoundaryLoop LoopOf(const std::vector<NurbsCurve<3>>& sides, double tolerance) {
  RequireThat(sides.size() == 3 || sides.size() == 4,
              kCoons,
              std::to_string(sides.size()) + " sides; three or four are needed");
  std::vector<NurbsCurve<3>> clamped;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    RequireThat(IsPoint(sides[k]) || !Closed(sides[k]),
                kCoons,
                "side " + std::to_string(k + 1) + " is closed; sides are to meet at corners");
    clamped.push_back(Reparameterized(Clamped(sides[k]), 0, 1));
  }
  Chain chain = ChainOf(std::move(clamped));
  BoundaryLoop loop;
  loop.gap = CloseCorners(chain, tolerance);
  if (sides.size() == 3)
    chain.sides.insert(chain.sides.begin() + 2, PointCurve(EndOf(chain.sides[1])));
  loop.along_u = {chain.sides[0], Reversed(chain.sides[2])};
  loop.along_v = {Reversed(chain.sides[3]), chain.sides[1]};
  loop.corners = {StartOf(loop.along_u[0]),
                  EndOf(loop.along_u[0]),
                  StartOf(loop.along_u[1]),
                  EndOf(loop.along_u[1])};
  return loop;
}

}  // namespace batten::internal
