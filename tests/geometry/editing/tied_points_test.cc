// SPDX-License-Identifier: MIT
#include "geometry/editing/tied_points.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "batten/geometry/closure.h"
#include "batten/geometry/flatten.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/meet_targets.h"
#include "batten/geometry/modify_shape.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::tied_points_test {

template <int Dim>
double Gap(const NurbsCurve<Dim>& curve) {
  return (curve.At(curve.basis().upper()) - curve.At(curve.basis().lower())).norm();
}

// The last control point put on the first.
NurbsCurve<3> ClosedUp(const NurbsCurve<3>& curve) {
  Eigen::Matrix3Xd points = curve.control_points();
  points.rightCols<1>() = points.leftCols<1>();
  return NurbsCurve<3>(curve.basis(), std::move(points), curve.weights());
}

TEST(TiedPointsTest, ClosedCurvesStayClosed) {
  ForRandomCurves<3>([](const NurbsCurve<3>& open, RandomSplines& random) {
    const SplineBasis& basis = open.basis();
    if (basis.periodic() || !basis.clamped() || basis.size() < 4 || basis.degree() < 2) return;
    const NurbsCurve<3> curve = ClosedUp(open);
    const double length = basis.upper() - basis.lower(), bound = kRounding * ExtentOf(curve);
    const Eigen::Vector3d to = random.Vector(2);
    for (const double share : {0.0, 0.03, 0.5, 0.97, 1.0}) {
      const double u = basis.Clamp(basis.lower() + share * length);
      const NurbsCurve<3> moved = MovedPoint(curve, u, to);
      EXPECT_LE(Gap(moved), bound + kRounding * ExtentOf(moved));
      EXPECT_LE((moved.At(u) - to).norm(), bound + kRounding * ExtentOf(moved));
      const NurbsCurve<3> met = WithTargets<3>(curve, std::vector<CurveTarget<3>>{{u, to}});
      EXPECT_LE(Gap(met), kIterated * ExtentOf(met));
      EXPECT_LE((met.control_points() - moved.control_points()).norm(), kIterated * ExtentOf(met));
    }
    for (const int i : {0, basis.size() - 1}) {
      const NurbsCurve<3> weighted = WithWeight(curve, i, 3 * curve.weights()[i]);
      EXPECT_NEAR(weighted.weights()[0] / curve.weights()[0], 3, kRounding);
      EXPECT_NEAR(
          weighted.weights()[basis.size() - 1] / curve.weights()[basis.size() - 1], 3, kRounding);
    }
  });
}

// What is moved, pulled or flattened at every kind of place.
std::vector<NurbsSurface> Edited(const NurbsSurface& surface) {
  std::vector<NurbsSurface> edited;
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  const auto at = [](const SplineBasis& basis, double share) {
    return basis.lower() + share * (basis.upper() - basis.lower());
  };
  for (const double s : {0.0, 0.02, 0.3, 0.99, 1.0}) {
    for (const double t : {0.0, 0.02, 0.6, 0.9, 1.0}) {
      const double u = at(bu, s), v = at(bv, t);
      const Eigen::Vector3d to = surface.At(u, v) + Eigen::Vector3d(0.3, -0.2, 0.5);
      edited.push_back(MovedPoint(surface, u, v, to));
      EXPECT_LE((edited.back().At(u, v) - to).norm(), 10 * kRounding);
      edited.push_back(WithTargets(surface, std::vector<SurfaceTarget>{{u, v, to}}));
    }
  }
  for (const ParameterRegion& region : {ParameterRegion{ParameterRange{at(bu, 0), at(bu, 0.2)},
                                                        ParameterRange{at(bv, 0.1), at(bv, 0.7)}},
                                        ParameterRegion{ParameterRange{at(bu, 0.7), at(bu, 1)},
                                                        ParameterRange{at(bv, 0), at(bv, 0.4)}},
                                        ParameterRegion{ParameterRange{at(bu, 0.3), at(bu, 0.6)},
                                                        ParameterRange{at(bv, 0.8), at(bv, 1)}}}) {
    edited.push_back(Flattened(surface, region, {.normal = {1, 2, 3}, .offset = 0.5}));
  }
  for (const auto& [i, j] : {std::pair(0, 0), {0, 1}, {surface.size_u() - 1, 1}, {1, 0}}) {
    edited.push_back(WithWeight(surface, i, j, 2));
  }
  edited.push_back(Pulled(surface, at(bu, 0.02), at(bv, 0.5), 0, surface.size_v() / 2, 0.05));
  return edited;
}

TEST(TiedPointsTest, ClosedSurfacesKeepTheirSeamsAndPoles) {
  for (const NurbsSurface& surface : {MakeCylinder(Frame(), 2, {0, 3}),
                                      MakeSphere(Frame(), 2),
                                      MakeTorus(Frame(), 5, 2),
                                      Swapped(MakeSphere(Frame(), 1)),
                                      MakeCone(Frame(), 2, 0, {0, 3})}) {
    const CollapsedEdgeSet poles = CollapsedEdges(surface);
    int k = 0;
    for (const NurbsSurface& edited : Edited(surface)) {
      SCOPED_TRACE("edit " + std::to_string(k++));
      EXPECT_EQ(Closed(edited, Direction::kU), Closed(surface, Direction::kU));
      EXPECT_EQ(Closed(edited, Direction::kV), Closed(surface, Direction::kV));
      EXPECT_EQ(CollapsedEdges(edited), poles);
    }
  }
}

// The transition of a region at the seam goes on beyond it.
TEST(TiedPointsTest, FlatteningAtTheSeamEndsInItsTransition) {
  const NurbsCurve<3> circle = MakeArc(Frame(), 2);
  for (const ParameterRange& range : {ParameterRange{0, 0.2}, ParameterRange{0.7, 1}}) {
    FlattenOptions<3> options;
    options.offset = 1;
    const NurbsCurve<3> flat = Flattened<3>(circle, range, options);
    EXPECT_LE(Gap(flat), kRounding);
    const double slack = options.transition * (range.to - range.from);
    for (int k = 0; k <= 200; ++k) {
      const double u = k / 200.;
      if (u >= range.from && u <= range.to) {
        EXPECT_NEAR(flat.At(u).z(), 1, kRounding);
      }
      const double from = std::remainder(u - range.from, 1), to = std::remainder(u - range.to, 1);
      if (std::min(std::abs(from), std::abs(to)) <= slack || (u >= range.from && u <= range.to)) {
        continue;
      }
      EXPECT_LE((flat.At(u) - circle.At(u)).norm(), kRounding) << "u = " << u;
    }
  }
}

// The least of all moves counts points that are one once: the seam is moved by as much as any other
// control point that acts alone.
TEST(TiedPointsTest, OpenShapesHaveNothingTied) {
  const NurbsCurve<3> line = MakeLine<3>({0, 0, 0}, {1, 0, 0});
  const TiedPoints ties(line);
  EXPECT_EQ(ties.First(1), 1);
  EXPECT_FALSE(ties.closed(Direction::kU));
}

}  // namespace batten::internal::tied_points_test
