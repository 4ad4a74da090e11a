// SPDX-License-Identifier: MIT
#include "geometry/intersection/shared_edges.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/intersect_surfaces.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/split.h"
#include "random_splines.h"

namespace batten::internal::shared_edges_test {

// One branch, as long as the edge, everywhere on it.
void ExpectEdge(const SurfaceIntersection& met,
                const NurbsCurve<3>& edge,
                BranchKind kind,
                bool closed) {
  ASSERT_EQ(met.branches.size(), 1u);
  const SurfaceBranch& branch = met.branches[0];
  EXPECT_EQ(branch.kind, kind);
  EXPECT_EQ(branch.closed, closed);
  EXPECT_LE(branch.deviation, met.tolerance);
  const double length = ArcLength(edge);
  EXPECT_NEAR(ArcLength(branch.curve), length, 20 * met.tolerance);
  const CurveFootPoints<3> feet(branch.curve);
  constexpr int kPlaces = 41;
  for (int k = 0; k <= kPlaces; ++k) {
    const double t = static_cast<double>(k) / kPlaces;
    const Eigen::Vector3d at = edge.At((1 - t) * edge.basis().lower() + t * edge.basis().upper());
    EXPECT_LE(feet.Nearest(at).distance, 2 * met.tolerance) << t;
  }
  EXPECT_TRUE(met.touches.empty() && met.overlaps.empty());
}

NurbsCurve<3> IsoAt(const NurbsSurface& surface, Direction direction, double at) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const NurbsSurface part = direction == Direction::kU
                                ? Segment(surface, u.lower(), at, v.lower(), v.upper())
                                : Segment(surface, u.lower(), u.upper(), v.lower(), at);
  const int n = part.size_u(), m = part.size_v();
  const bool along_v = direction == Direction::kU;
  Eigen::Matrix3Xd points(3, along_v ? m : n);
  Eigen::VectorXd weights(points.cols());
  for (int k = 0; k < points.cols(); ++k) {
    const int column = along_v ? (n - 1) * m + k : k * m + m - 1;
    points.col(k) = part.control_points().col(column);
    weights[k] = part.weights()[column];
  }
  return NurbsCurve<3>(along_v ? part.basis_v() : part.basis_u(), points, weights);
}

// Both parts of a smooth surface that is split go on over the cut.
TEST(SharedEdgesTest, PartsOfASplitSurfaceMeetAlongTheCut) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface whole =
        random.Sheet(random.Integer(2, 4), random.Integer(2, 4), 0.4, {.most_spans = 3});
    const Direction direction = random.Coin() ? Direction::kU : Direction::kV;
    const SplineBasis& basis = direction == Direction::kU ? whole.basis_u() : whole.basis_v();
    const double share = random.Real(0.3, 0.7);
    const double at = (1 - share) * basis.lower() + share * basis.upper();
    const NurbsSurface low = Segment(whole, direction, basis.lower(), at);
    const NurbsSurface high = Segment(whole, direction, at, basis.upper());
    ExpectEdge(
        IntersectSurfaces(low, high), IsoAt(whole, direction, at), BranchKind::kTangential, false);
  }
}

TEST(SharedEdgesTest, RoundNeighboursMeetInTheirCircle) {
  for (const double scale : {1.0, 1e-3, 40.0}) {
    for (const double shift : {0.0, 3e5}) {
      SCOPED_TRACE(std::to_string(scale) + " at " + std::to_string(shift));
      const Eigen::Vector3d base = shift * Eigen::Vector3d::Ones();
      const auto frame = [&](double z) {
        return Frame(base + Eigen::Vector3d(0, 0, z * scale), {0, 0, 1});
      };
      const NurbsSurface low = MakeCylinder(frame(0), scale, {0, 2 * scale});
      const NurbsSurface high = MakeCylinder(frame(2), scale, {0, 2 * scale});
      const auto circle = MakeArc(frame(2), scale);
      ExpectEdge(IntersectSurfaces(low, high), circle, BranchKind::kTangential, true);
      const NurbsSurface ball = MakeSphere(frame(2), scale);
      const SplineBasis &u = ball.basis_u(), &v = ball.basis_v();
      const double equator = v.lower() / 2 + v.upper() / 2;
      const NurbsSurface cap = Segment(ball, u.lower(), u.upper(), equator, v.upper());
      const NurbsSurface bowl = Segment(ball, u.lower(), u.upper(), v.lower(), equator);
      ExpectEdge(IntersectSurfaces(low, cap), circle, BranchKind::kTangential, true);
      ExpectEdge(IntersectSurfaces(bowl, cap), circle, BranchKind::kTangential, true);
    }
  }
}

TEST(SharedEdgesTest, PlanesBesideEachOtherMeetAlongWhatTheyShare) {
  const NurbsSurface a = MakePlane({}, {0, 2}, {0, 3});
  const NurbsSurface b = MakePlane({}, {2, 5}, {1, 7});
  ExpectEdge(
      IntersectSurfaces(a, b), MakeLine<3>({2, 1, 0}, {2, 3, 0}), BranchKind::kTangential, false);
}

// A cylinder and a cone, or a disk's edge, that end in one circle: it is an edge of both.
TEST(SharedEdgesTest, ACrossingInTheEdgesOfBothIsTracedOnce) {
  for (const double radius : {1e-3, 1.0, 2.0, 3.3, 10.0, 50.0, 100.0}) {
    SCOPED_TRACE(radius);
    const NurbsSurface pipe = MakeCylinder({}, radius, {-2 * radius, 2 * radius});
    const Frame top({0, 0, 2 * radius}, {0, 0, 1});
    const NurbsSurface cone = MakeCone(top, radius, 2 * radius, {0, radius});
    ExpectEdge(IntersectSurfaces(pipe, cone), MakeArc(top, radius), BranchKind::kTransversal, true);
  }
}

}  // namespace batten::internal::shared_edges_test
