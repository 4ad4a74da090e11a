// SPDX-License-Identifier: MIT
#include "batten/geometry/meet_targets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <vector>

#include "batten/geometry/modify_shape.h"
#include "geometry/editing/control_forms.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::meet_targets_test {

// As many targets as a curve of this degree meets for sure: a point and a derivative here, a point
// there.
template <int Dim>
std::vector<CurveTarget<Dim>> RandomTargets(const NurbsCurve<Dim>& curve, RandomSplines& random) {
  const SplineBasis& basis = curve.basis();
  const double length = basis.upper() - basis.lower();
  const double u = basis.lower() + random.Real(0.05, 0.45) * length;
  const auto vector = [&]() -> Eigen::Matrix<double, Dim, 1> {
    return random.Vector(2).template head<Dim>();
  };
  std::vector<CurveTarget<Dim>> targets = {{u, vector()}};
  if (basis.degree() >= 2 && basis.size() - (basis.periodic() ? basis.degree() : 0) >= 4) {
    targets.push_back({u, vector(), 1});
    targets.push_back({u + random.Real(0.2, 0.5) * length, vector()});
  }
  return targets;
}

// Derivatives, and with them what is missed of them, grow with spans that get shorter.
template <int Dim>
double BoundOf(const NurbsCurve<Dim>& curve, const CurveTarget<Dim>& target) {
  const double scale = target.order == 0 ? 1 : 1e2 / ShortestSpan(curve.basis());
  return 1e3 * kRounding * scale * ExtentOf(curve);
}

template <int Dim>
void CheckCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const auto targets = RandomTargets<Dim>(curve, random);
    const NurbsCurve<Dim> moved = WithTargets<Dim>(curve, targets);
    EXPECT_EQ(moved.weights(), curve.weights());
    EXPECT_EQ(moved.basis(), curve.basis());
    for (const CurveTarget<Dim>& target : targets) {
      EXPECT_LE((moved.Derivatives(target.u, target.order).col(target.order) - target.value).norm(),
                BoundOf<Dim>(moved, target))
          << "order " << target.order;
    }
  });
}

TEST(MeetTargetsTest, CurvesHaveThePointsAndDerivativesAskedFor) {
  CheckCurves<2>();
  CheckCurves<3>();
}

TEST(MeetTargetsTest, SurfacesHaveThePointsAndDerivativesAskedFor) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    if (bu.degree() < 2 || bv.degree() < 2) return;
    const double u = random.Real(bu.lower(), bu.upper()), v = random.Real(bv.lower(), bv.upper());
    const std::vector<SurfaceTarget> targets = {
        {u, v, random.Vector(2)}, {u, v, random.Vector(2), 1, 0}, {u, v, random.Vector(2), 1, 1}};
    if (DistinctPoints(bu) < 4 || DistinctPoints(bv) < 4) return;
    const NurbsSurface moved = WithTargets(surface, targets);
    const SurfaceDerivatives D = moved.Derivatives(u, v, 2);
    const double scale = 1e3 * kRounding * ExtentOf(moved), hu = ShortestSpan(bu),
                 hv = ShortestSpan(bv);
    EXPECT_LE((D(0, 0) - targets[0].value).norm(), scale);
    EXPECT_LE((D(1, 0) - targets[1].value).norm(), 1e2 * scale / hu);
    EXPECT_LE((D(1, 1) - targets[2].value).norm(), 1e4 * scale / (hu * hv));
    EXPECT_EQ(moved.weights(), surface.weights());
  });
}

TEST(MeetTargetsTest, OnePointIsTheMoveOfOnePoint) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const double u = random.Parameter(curve.basis());
    const Eigen::Vector3d to = random.Vector(2);
    const NurbsCurve<3> one = MovedPoint(curve, u, to);
    const NurbsCurve<3> met = WithTargets<3>(curve, std::vector<CurveTarget<3>>{{u, to}});
    EXPECT_LE((one.control_points() - met.control_points()).norm(), kIterated * ExtentOf(one));
  });
}

// Moves that keep every target are orthogonal to the least one: projected onto the null space of
// the targets, found here by moving control points one by one, it vanishes.
TEST(MeetTargetsTest, TheChangeIsTheLeastOfAll) {
  ForRandomCurves<3>(
      [](const NurbsCurve<3>& curve, RandomSplines& random) {
        const auto targets = RandomTargets<3>(curve, random);
        const NurbsCurve<3> moved = WithTargets<3>(curve, targets);
        const int free = DistinctPoints(curve.basis());
        Eigen::MatrixXd influence(free, std::ssize(targets));
        for (int i = 0; i < free; ++i) {
          NurbsCurve<3>::Points points = curve.control_points();
          for (int k = i; k < curve.basis().size(); k += free) points(0, k) += 1;
          const NurbsCurve<3> other(curve.basis(), points, curve.weights());
          for (size_t k = 0; k < targets.size(); ++k) {
            const int r = targets[k].order;
            influence(i, static_cast<Eigen::Index>(k)) =
                other.Derivatives(targets[k].u, r)(0, r) - curve.Derivatives(targets[k].u, r)(0, r);
          }
        }
        for (auto column : influence.colwise()) column.normalize();
        const Eigen::MatrixXd change =
            (moved.control_points() - curve.control_points()).leftCols(free).transpose();
        const Eigen::MatrixXd outside =
            change - influence * influence.completeOrthogonalDecomposition().solve(change);
        EXPECT_LE(outside.norm(), kIterated * (1 + change.norm()));
      },
      2,
      5);
}

TEST(MeetTargetsTest, FixedControlPointsAndThoseElsewhereStay) {
  ForRandomCurves<2>([](const NurbsCurve<2>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    if (basis.degree() < 2 || DistinctPoints(basis) < 4) return;
    const double u = random.Real(basis.lower(), basis.upper());
    const int fixed = basis.Span(u) - random.Integer(0, basis.degree());
    const NurbsCurve<2> moved = WithTargets<2>(
        curve, std::vector<CurveTarget<2>>{{u, random.Vector(2).head<2>()}}, std::vector{fixed});
    EXPECT_EQ(moved.control_points().col(fixed), curve.control_points().col(fixed));
    for (int i = 0; i < basis.size() && !basis.periodic(); ++i) {
      if (i < basis.Span(u) - basis.degree() || i > basis.Span(u)) {
        EXPECT_EQ(moved.control_points().col(i), curve.control_points().col(i));
      }
    }
  });
}

TEST(MeetTargetsTest, ChangesFarFromTheOriginLoseNoDigits) {
  RandomSplines random(8);
  NurbsCurve<3> curve = random.Curve<3>(3, true, {.most_spans = 4});
  curve = NurbsCurve<3>(curve.basis(),
                        curve.control_points().colwise() + Eigen::Vector3d(5e6, 4e5, 100),
                        curve.weights());
  const double u = (curve.basis().lower() + curve.basis().upper()) / 2;
  const Eigen::Vector3d to = curve.At(u) + Eigen::Vector3d(1e-3, 0, 0);
  const NurbsCurve<3> moved = WithTargets<3>(
      curve, std::vector<CurveTarget<3>>{{u, to}, {u, curve.Derivatives(u, 1).col(1), 1}});
  EXPECT_LE((moved.At(u) - to).norm(), 64 * kUnitRoundoff * 5e6);
}

TEST(MeetTargetsTest, RefusesWhatCannotBeMet) {
  const NurbsCurve<2> curve(SplineBasis::Uniform(2, 4, 0, 1), Eigen::Matrix2Xd::Random(2, 4));
  using Targets = std::vector<CurveTarget<2>>;
  const auto refusal = [&](const Targets& targets, const std::vector<int>& fixed = {}) {
    return RefusalOf([&] { WithTargets<2>(curve, targets, fixed); });
  };
  const Eigen::Vector2d zero(0, 0), one(1, 0);
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_THAT(refusal({{0.5, zero}, {0.5, one}}),
              testing::AllOf(testing::HasSubstr("can't be met with the others"),
                             testing::HasSubstr("0.5 are missing at best")));
  EXPECT_EQ(refusal({{0.5, one}, {0.5, one}}), "accepted");
  EXPECT_THAT(refusal({{0.1, one}}, {0, 1, 2}), testing::HasSubstr("the point at u = 0.1"));
  EXPECT_THAT(refusal({{0.1, one, 3}}), testing::HasSubstr("zero whatever"));
  EXPECT_THAT(refusal({{1.5, one}}), testing::HasSubstr("u = 1.5 is outside the domain [0, 1]"));
  EXPECT_THAT(refusal({{0.5, one, -1}}), testing::HasSubstr("order -1 is not between 0 and 25"));
  EXPECT_THAT(refusal({{0.5, {NAN, 0}}}), testing::HasSubstr("not finite"));
  EXPECT_THAT(refusal({{0.5, one}}, {4}), testing::HasSubstr("index i = 4 is not in [0, 3]"));
  EXPECT_THAT(refusal(Targets(501, {0.5, one})),
              testing::HasSubstr("501 targets are more than 500"));
  // Five points of one span: four control points act there.
  EXPECT_THAT(refusal({{0.1, zero}, {0.2, one}, {0.3, zero}, {0.4, one}, {0.45, zero}}),
              testing::HasSubstr("can't be met"));
}

}  // namespace batten::internal::meet_targets_test
