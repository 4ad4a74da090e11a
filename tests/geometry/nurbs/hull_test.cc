// SPDX-License-Identifier: MIT
// Where a spline may lie and how far a control point reaches. [Piegl & Tiller 1997, §3.2, §4.2,
// §4.4]
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "extended_evaluation.h"
#include "law_cases.h"

namespace batten::internal::hull_test {

// A point lies in the convex hull of others exactly if in every direction some of them reaches as
// far. If it lies outside, the normal of one of the hull's faces shows it, and a face is spanned by
// 2 points in the plane, 3 in space: all of them are tried, both ways, and some random directions.
class DirectionsOfFaces {
 public:
  DirectionsOfFaces(const Eigen::Matrix2Xd& points, RandomSplines& random) {
    for (Eigen::Index a = 0; a < points.cols(); ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        const Eigen::Vector2d edge = points.col(a) - points.col(b);
        Add(Eigen::Vector2d(-edge.y(), edge.x()));
      }
    }
    for (int k = 0; k < 50; ++k) Add(random.Vector(1).head<2>());
  }
  DirectionsOfFaces(const Eigen::Matrix3Xd& points, RandomSplines& random) {
    for (Eigen::Index a = 0; a < points.cols(); ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        for (Eigen::Index c = 0; c < b; ++c) {
          const Eigen::Vector3d x = points.col(b) - points.col(a),
                                y = points.col(c) - points.col(a);
          Add(x.cross(y));
        }
      }
    }
    for (int k = 0; k < 100; ++k) Add(random.Vector(1));
  }

  // How far the point lies outside the hull at least, in one of the directions; ≤ 0 inside.
  template <typename Points>
  double Outside(const Points& points, const Eigen::VectorXd& point) const {
    double outside = -1;
    for (const Eigen::VectorXd& direction : directions_) {
      const Eigen::RowVectorXd heights =
          direction.transpose() * (points.colwise() - point);  // taken from the point: no rounding
      outside = std::max({outside, -heights.maxCoeff(), heights.minCoeff()});
    }
    return outside;
  }

 private:
  void Add(const Eigen::VectorXd& direction) {
    if (direction.norm() > 0) directions_.push_back(direction.normalized());
  }

  std::vector<Eigen::VectorXd> directions_;
};

template <int Dim>
void CurvesLieInTheHullOfTheirSpan() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const int p = curve.basis().degree();
    for (const int span : curve.basis().Spans()) {
      const Eigen::Matrix<double, Dim, Eigen::Dynamic> active =
          curve.control_points().middleCols(span - p, p + 1);
      const DirectionsOfFaces directions(active, random);
      const double low = curve.basis().knots()[span], high = curve.basis().knots()[span + 1];
      // Coordinates are right to (7p + 3)·ε·D + ε·|C|, and both are at most 2 here.
      const double rounding = std::sqrt(Dim) * (14 * p + 8) * kEpsilon;
      for (const double t : {0.0, random.Real(0, 1), random.Real(0, 1), random.Real(0, 1)}) {
        const Eigen::VectorXd point = curve.At(low + t * (high - low));
        EXPECT_LE(directions.Outside(active, point), rounding) << "span " << span << ", t = " << t;
      }
    }
  });
}

TEST(HullTest, PlanarCurvesLieInTheHullOfTheirSpansControlPoints) {
  CurvesLieInTheHullOfTheirSpan<2>();
}

TEST(HullTest, SpaceCurvesLieInTheHullOfTheirSpansControlPoints) {
  CurvesLieInTheHullOfTheirSpan<3>();
}

TEST(HullTest, SurfacesLieInTheHullOfTheirCellsControlPoints) {
  ForRandomSurfaces(
      [](const NurbsSurface& surface, RandomSplines& random) {
        const int p = surface.basis_u().degree(), q = surface.basis_v().degree();
        if ((p + 1) * (q + 1) > 36) return;  // all triples of the control points are tried
        const double u = random.Parameter(surface.basis_u());
        const double v = random.Parameter(surface.basis_v());
        const int su = surface.basis_u().Span(u), sv = surface.basis_v().Span(v);
        Eigen::Matrix3Xd active(3, (p + 1) * (q + 1));
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            active.col(r * (q + 1) + s) = surface.control_point(su - p + r, sv - q + s);
          }
        }
        const double rounding = std::sqrt(3) * (14 * (p + q) + 10) * kEpsilon;
        EXPECT_LE(DirectionsOfFaces(active, random).Outside(active, surface.At(u, v)), rounding);
      },
      90);
}

// The check itself: points a little outside the hull are found, those inside are not accused.
TEST(HullTest, TellsInsideFromOutside) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, random.Integer(4, 9));
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const DirectionsOfFaces directions(points, random);
    const Eigen::Vector3d mean = points.rowwise().mean();
    EXPECT_LE(directions.Outside(points, mean), 0);
    // Beyond the corner that reaches farthest in some direction.
    const Eigen::Vector3d direction = random.Vector(1).normalized();
    Eigen::Index corner;
    (direction.transpose() * points).maxCoeff(&corner);
    EXPECT_GT(directions.Outside(points, points.col(corner) + 1e-9 * direction), 0);
  }
}

template <int Dim>
void AControlPointReachesItsSupportOnly() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const SplineBasis plain(curve.basis().degree(), curve.basis().knots());  // ends moved singly
    const int p = plain.degree(), i = random.Integer(0, plain.size() - 1);
    auto points = curve.control_points();
    const Eigen::Matrix<double, Dim, 1> shift = random.Vector(1).template head<Dim>();
    points.col(i) += shift;
    const NurbsCurve<Dim> moved(plain, points, curve.weights());
    const NurbsCurve<Dim> before(plain, curve.control_points(), curve.weights());
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(plain);
      const int span = plain.Span(u);
      const Eigen::Matrix<double, Dim, 1> change = moved.At(u) - before.At(u);
      if (i < span - p || i > span) {
        EXPECT_EQ(moved.At(u), before.At(u)) << "u = " << u;
        EXPECT_TRUE(u <= plain.knots()[i] || u >= plain.knots()[i + p + 1]);
        continue;
      }
      // By the rational function N_i w_i / Σ N_j w_j, between 0 and 1, times the shift.
      double weight = 0;
      for (int j = span - p; j <= span; ++j) weight += plain.Function(j, u) * curve.weights()[j];
      const double share = plain.Function(i, u) * curve.weights()[i] / weight;
      EXPECT_LE(share, 1 + kEpsilon);
      EXPECT_NEAR((change - share * shift).cwiseAbs().maxCoeff(), 0, (40 * p + 40) * kEpsilon);
    }
  });
}

TEST(HullTest, AControlPointReachesTheSpansOfItsFunctionOnly) {
  AControlPointReachesItsSupportOnly<2>();
  AControlPointReachesItsSupportOnly<3>();
}

// A greater weight pulls every point of the support straight towards the control point.
TEST(HullTest, AWeightPullsTowardsItsControlPoint) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis plain(curve.basis().degree(), curve.basis().knots());
    const int p = plain.degree(), i = random.Integer(0, plain.size() - 1);
    Eigen::VectorXd weights = curve.weights();
    weights[i] *= random.Real(1.5, 10);
    const NurbsCurve<3> pulled(plain, curve.control_points(), weights);
    const NurbsCurve<3> before(plain, curve.control_points(), curve.weights());
    const Eigen::Vector3d target = curve.control_points().col(i);
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(plain);
      const Eigen::Vector3d old_place = before.At(u), place = pulled.At(u);
      const double rounding = (40 * p + 40) * kEpsilon;
      if (plain.Function(i, u) == 0) {
        EXPECT_NEAR((place - old_place).norm(), 0, rounding);
        continue;
      }
      EXPECT_LE((place - target).norm(), (old_place - target).norm() + rounding);
      EXPECT_NEAR((place - old_place).cross(target - old_place).norm(), 0, 4 * rounding);
      EXPECT_GE((place - old_place).dot(target - old_place), -4 * rounding);
    }
  });
}

TEST(HullTest, AControlPointOfASurfaceReachesItsCellsOnly) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis u_basis(surface.basis_u().degree(), surface.basis_u().knots());
    const SplineBasis v_basis(surface.basis_v().degree(), surface.basis_v().knots());
    const int p = u_basis.degree(), q = v_basis.degree();
    const int i = random.Integer(0, u_basis.size() - 1), j = random.Integer(0, v_basis.size() - 1);
    Eigen::Matrix3Xd points = surface.control_points();
    const NurbsSurface before(u_basis, v_basis, points, surface.weights());
    points.col(i * v_basis.size() + j) += random.Vector(1);
    const NurbsSurface moved(u_basis, v_basis, points, surface.weights());
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(u_basis), v = random.Parameter(v_basis);
      const int su = u_basis.Span(u), sv = v_basis.Span(v);
      const bool reached = su - p <= i && i <= su && sv - q <= j && j <= sv;
      if (!reached) {
        EXPECT_EQ(moved.At(u, v), before.At(u, v));
        EXPECT_EQ(moved.JetAt(u, v).duv, before.JetAt(u, v).duv);
      } else if (u_basis.Function(i, u) * v_basis.Function(j, v) * surface.weights().minCoeff() >
                 1e-9 * surface.weights().maxCoeff()) {
        EXPECT_NE(moved.At(u, v), before.At(u, v));
      }
    }
  });
}

}  // namespace batten::internal::hull_test
