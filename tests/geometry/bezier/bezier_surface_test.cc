// SPDX-License-Identifier: MIT
#include "batten/geometry/bezier_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/editing/deviation_bound.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::bezier_surface_test {

BezierSurface RandomSurface(RandomSplines& random, int p, int q, bool rational) {
  Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  return BezierSurface(p, q, points, rational ? random.Weights(points.cols()) : Eigen::VectorXd());
}

BezierSurface WithPoints(const BezierSurface& surface, const Eigen::Matrix3Xd& points) {
  return BezierSurface(surface.degree_u(), surface.degree_v(), points, surface.weights());
}

template <typename Check>
void ForRandomSurfaces(int lowest, int highest, const Check& check) {
  for (int seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(lowest, highest), q = random.Integer(lowest, highest);
    check(RandomSurface(random, p, q, random.Coin()), random);
  }
}

double Parameter(RandomSplines& random) {
  switch (random.Integer(0, 5)) {
    case 0:
      return 0;
    case 1:
      return 1;
    default:
      return random.Real(0, 1);
  }
}

constexpr DeCasteljauOrder kOrders[] = {
    DeCasteljauOrder::kUFirst, DeCasteljauOrder::kVFirst, DeCasteljauOrder::kBilinear};

TEST(BezierSurfaceTest, ThreeOrdersOfDeCasteljauGiveThePointOfTheNurbsSurface) {
  ForRandomSurfaces(1, 11, [](const BezierSurface& surface, RandomSplines& random) {
    const NurbsSurface nurbs = ToNurbs(surface);
    for (int k = 0; k < 10; ++k) {
      const double u = Parameter(random), v = Parameter(random);
      for (const DeCasteljauOrder order : kOrders) {
        EXPECT_LE((surface.At(u, v, order) - nurbs.At(u, v)).norm(), kRounding);
      }
    }
  });
}

TEST(BezierSurfaceTest, DerivativesAreThoseOfTheNurbsSurface) {
  ForRandomSurfaces(1, 9, [](const BezierSurface& surface, RandomSplines& random) {
    const NurbsSurface nurbs = ToNurbs(surface);
    const double u = Parameter(random), v = Parameter(random);
    const SurfaceDerivatives got = surface.Derivatives(u, v, 3),
                             wanted = nurbs.Derivatives(u, v, 3);
    double scale = 1;
    for (int k = 0; k <= 3; ++k) {
      for (int l = 0; k + l <= 3; ++l) scale = std::max(scale, wanted(k, l).norm());
    }
    for (int k = 0; k <= 3; ++k) {
      for (int l = 0; k + l <= 3; ++l) {
        EXPECT_LE((got(k, l) - wanted(k, l)).norm(), kRounding * scale);
      }
    }
  });
}

TEST(BezierSurfaceTest, PartialDerivativesAreSurfacesOfDerivatives) {
  ForRandomSurfaces(0, 6, [](const BezierSurface& surface, RandomSplines& random) {
    const BezierSurface du = PartialDerivative(surface, Direction::kU);
    const BezierSurface dv = PartialDerivative(surface, Direction::kV);
    const BezierSurface duv = PartialDerivative(du, Direction::kV);
    const BezierSurface dvu = PartialDerivative(dv, Direction::kU);
    for (int k = 0; k < 10; ++k) {
      const double u = Parameter(random), v = Parameter(random);
      const SurfaceDerivatives wanted = surface.Derivatives(u, v, 2);
      const auto close = [&](const BezierSurface& got, const Eigen::Vector3d& value) {
        const double scale = std::max(1.0, got.control_points().cwiseAbs().maxCoeff());
        return (got.At(u, v) - value).norm() <= kRounding * scale;
      };
      EXPECT_TRUE(close(du, wanted(1, 0)));
      EXPECT_TRUE(close(dv, wanted(0, 1)));
      EXPECT_TRUE(close(duv, wanted(1, 1)));
      EXPECT_TRUE(close(dvu, wanted(1, 1)));
    }
  });
}

TEST(BezierSurfaceTest, TwistsAreMixedDerivatives) {
  ForRandomSurfaces(0, 9, [](const BezierSurface& surface, RandomSplines&) {
    for (const int u : {0, 1}) {
      for (const int v : {0, 1}) {
        const SurfaceDerivatives d = surface.Derivatives(u, v, 2);
        const double scale = std::max({1.0, d(1, 1).norm(), d(1, 0).norm() * d(0, 1).norm()});
        EXPECT_LE((TwistVector(surface, u, v) - d(1, 1)).norm(), kRounding * scale);
      }
    }
    if (surface.rational() || surface.degree_u() == 0 || surface.degree_v() == 0) return;
    const BezierSurface mixed =
        PartialDerivative(PartialDerivative(surface, Direction::kU), Direction::kV);
    EXPECT_LE((ControlTwists(surface) - mixed.control_points()).norm(), kRounding * 100);
  });
}

TEST(BezierSurfaceTest, SubdivisionIntoFourTracesTheSameSurface) {
  ForRandomSurfaces(0, 9, [](const BezierSurface& surface, RandomSplines& random) {
    const double cut_u = random.Real(0.01, 0.99), cut_v = random.Real(0.01, 0.99);
    const auto parts = Subdivided(surface, cut_u, cut_v);
    for (int k = 0; k < 10; ++k) {
      const double s = Parameter(random), t = Parameter(random);
      for (int part = 0; part < 4; ++part) {
        const double u = part < 2 ? cut_u * s : cut_u + (1 - cut_u) * s;
        const double v = part % 2 == 0 ? cut_v * t : cut_v + (1 - cut_v) * t;
        EXPECT_LE((parts[part].At(s, t) - surface.At(u, v)).norm(), kRounding);
      }
    }
  });
}

TEST(BezierSurfaceTest, ElevationInEitherAndBothDirectionsChangesNoPoint) {
  ForRandomSurfaces(0, 9, [](const BezierSurface& surface, RandomSplines& random) {
    const int a = random.Integer(1, 6), b = random.Integer(1, 6);
    const BezierSurface raised[] = {
        Elevated(surface, a, 0), Elevated(surface, 0, b), Elevated(surface, a, b)};
    EXPECT_EQ(raised[0].degree_v(), surface.degree_v());
    EXPECT_EQ(raised[1].degree_u(), surface.degree_u());
    EXPECT_EQ(raised[2].degree_u(), surface.degree_u() + a);
    EXPECT_EQ(raised[2].degree_v(), surface.degree_v() + b);
    for (const BezierSurface& other : raised) {
      for (int k = 0; k < 10; ++k) {
        const double u = Parameter(random), v = Parameter(random);
        EXPECT_LE((other.At(u, v) - surface.At(u, v)).norm(), kRounding);
      }
      EXPECT_LE(DeviationBound(other, surface), kRounding);
    }
  });
}

TEST(BezierSurfaceTest, BoundaryCurvesAreTheEdges) {
  ForRandomSurfaces(0, 9, [](const BezierSurface& surface, RandomSplines& random) {
    const auto edges = BoundaryCurves(surface);
    const double t = random.Real(0, 1);
    EXPECT_LE((edges[0].At(t) - surface.At(0, t)).norm(), kRounding);
    EXPECT_LE((edges[1].At(t) - surface.At(1, t)).norm(), kRounding);
    EXPECT_LE((edges[2].At(t) - surface.At(t, 0)).norm(), kRounding);
    EXPECT_LE((edges[3].At(t) - surface.At(t, 1)).norm(), kRounding);
  });
}

TEST(BezierSurfaceTest, CollapsedEdgesStayCollapsedBitByBit) {
  RandomSplines random(2);
  const BezierSurface whole = RandomSurface(random, 3, 4, true);
  Eigen::Matrix3Xd points = whole.control_points();
  for (int i = 0; i <= 3; ++i) points.col(whole.Column(i, 0)) = Eigen::Vector3d(0.1, 1e6, 0.7);
  const BezierSurface surface = WithPoints(whole, points);
  const auto expect_collapsed = [](const BezierSurface& other) {
    for (int i = 0; i <= other.degree_u(); ++i) {
      EXPECT_EQ(other.control_point(i, 0), Eigen::Vector3d(0.1, 1e6, 0.7));
    }
  };
  expect_collapsed(Elevated(surface, 3, 2));
  expect_collapsed(Subdivided(surface, 0.3, 0.6)[0]);
  expect_collapsed(Subdivided(surface, 0.3, 0.6)[2]);
  expect_collapsed(ToBezier(ToNurbs(surface)));
  for (const DeCasteljauOrder order : kOrders) {
    EXPECT_EQ(surface.At(0.37, 0, order), Eigen::Vector3d(0.1, 1e6, 0.7));
  }
}

TEST(BezierSurfaceTest, ConvertsFromAnUnclampedSpan) {
  for (int seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface nurbs = random.Surface(random.Integer(1, 6),
                                              random.Integer(1, 6),
                                              random.Coin(),
                                              {.clamped = false, .most_spans = 1});
    const BezierSurface surface = ToBezier(nurbs);
    const double s = Parameter(random), t = Parameter(random);
    const auto at = [](const SplineBasis& basis, double x) {
      return basis.lower() + x * (basis.upper() - basis.lower());
    };
    EXPECT_LE((surface.At(s, t) - nurbs.At(at(nurbs.basis_u(), s), at(nurbs.basis_v(), t))).norm(),
              kRounding);
  }
}

TEST(BezierSurfaceTest, RefusesWhatItCannotMean) {
  RandomSplines random(1);
  const BezierSurface surface = RandomSurface(random, 2, 3, false);
  const Eigen::Matrix3Xd points = surface.control_points();
  EXPECT_THROW(BezierSurface(3, 3, points), std::invalid_argument);
  EXPECT_THROW(BezierSurface(-1, 3, points), std::invalid_argument);
  EXPECT_THROW(BezierSurface(51, 0, Eigen::Matrix3Xd::Zero(3, 52)), std::invalid_argument);
  EXPECT_THROW(BezierSurface(2, 3, points / 0.0), std::invalid_argument);
  EXPECT_THROW(BezierSurface(2, 3, points, -Eigen::VectorXd::Ones(12)), std::invalid_argument);
  EXPECT_THROW(Subdivided(surface, 0.5, 1), std::invalid_argument);
  EXPECT_THROW(Subdivided(surface, std::nan(""), 0.5), std::invalid_argument);
  EXPECT_THROW(Elevated(surface, 0, -1), std::invalid_argument);
  EXPECT_THROW(Elevated(surface, std::numeric_limits<int>::max(), 0), std::invalid_argument);
  EXPECT_THROW(TwistVector(surface, 0, 2), std::invalid_argument);
  EXPECT_THROW(ToNurbs(Elevated(surface, 30, 0)), std::invalid_argument);
  EXPECT_THROW(ToBezier(Sphere(1)), std::invalid_argument);
}

// --- normals ---------------------------------------------------------------------------------

// The normal a little inside, towards (0.37, 0.61).
Eigen::Vector3d NormalNear(const BezierSurface& surface, double u, double v, double h) {
  const SurfaceDerivatives d = surface.Derivatives(u + h * (0.37 - u), v + h * (0.61 - v), 1);
  return d(1, 0).cross(d(0, 1)).normalized();
}

TEST(BezierNormalTest, IsThatOfTheDerivativesWhereTheyGiveIt) {
  ForRandomSurfaces(1, 9, [](const BezierSurface& surface, RandomSplines& random) {
    const double u = Parameter(random), v = Parameter(random);
    const SurfaceDerivatives d = surface.Derivatives(u, v, 1);
    const auto normal = NormalAt(surface, u, v);
    ASSERT_TRUE(normal);
    EXPECT_LE((*normal - d(1, 0).cross(d(0, 1)).normalized()).norm(), kIterated);
  });
}

// Each of the four edges collapsed to a point in turn: the derivative across takes the place of the
// one that vanishes, with its sign inside.
TEST(BezierNormalTest, OnACollapsedEdgeFollowsFromTheNextControlRow) {
  ForRandomSurfaces(2, 5, [](const BezierSurface& surface, RandomSplines& random) {
    const int p = surface.degree_u(), q = surface.degree_v(), edge = random.Integer(0, 3);
    Eigen::Matrix3Xd points = surface.control_points();
    for (int k = 0; k <= std::max(p, q); ++k) {
      if (edge < 2 && k <= q) points.col(surface.Column(edge * p, k)) = Eigen::Vector3d(3, 2, 1);
      if (edge >= 2 && k <= p) {
        points.col(surface.Column(k, (edge - 2) * q)) = Eigen::Vector3d(3, 2, 1);
      }
    }
    const BezierSurface collapsed = WithPoints(surface, points);
    for (const double t : {0.0, 0.3, 1.0}) {
      const double u = edge < 2 ? edge : t, v = edge < 2 ? t : edge - 2;
      const auto normal = NormalAt(collapsed, u, v);
      ASSERT_TRUE(normal);
      EXPECT_NEAR(normal->norm(), 1, kRounding);
      const SurfaceDerivatives d = collapsed.Derivatives(u, v, 2);
      const Eigen::Vector3d across =
          edge < 2 ? d(1, 0).cross(d(1, 1)) : Eigen::Vector3d(d(1, 1).cross(d(0, 1)));
      const double sign = edge % 2 == 0 ? 1 : -1;
      EXPECT_LE((*normal - sign * across.normalized()).norm(), kIterated);
      // The limit is reached linearly: a hundred times nearer, a hundred times better. (Weights up
      // to 1e4 may turn the normal faster than any step that rounding allows.)
      if (surface.rational()) continue;
      const double far = (*normal - NormalNear(collapsed, u, v, 1e-4)).norm();
      const double near = (*normal - NormalNear(collapsed, u, v, 1e-6)).norm();
      EXPECT_LE(near, std::max(0.02 * far, kHalfDigits));
    }
  });
}

TEST(BezierNormalTest, AtTheCornerOfAnOctantOfTheSphereIsTheRadius) {
  const Eigen::Matrix3Xd arc = ArcPointsAndWeights(4);
  Eigen::Matrix3Xd points(3, 9);
  Eigen::VectorXd weights(9);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {  // latitude j, longitude i
      points.col(i * 3 + j) << arc(0, j) * arc(0, i), arc(0, j) * arc(1, i), arc(1, j);
      weights[i * 3 + j] = arc(2, i) * arc(2, j);
    }
  }
  // cos 90° is not zero to rounding: the edge is collapsed to 1e-16 only, as it is in files.
  for (const double offset : {0.0, 1e3}) {
    const Eigen::Vector3d centre = Eigen::Vector3d::Constant(offset);
    const BezierSurface octant(2, 2, points.colwise() + centre, weights);
    for (const double u : {0.0, 0.2, 0.5, 1.0}) {
      for (const double v : {0.0, 0.5, 0.9, 1.0}) {
        const auto normal = NormalAt(octant, u, v);
        ASSERT_TRUE(normal) << u << " " << v;
        EXPECT_LE((*normal - (octant.At(u, v) - centre)).norm(), offset == 0 ? 1e-12 : 1e-8);
      }
    }
  }
}

// Both edges at a corner collapse, or run along one line: the mixed derivative rules.
TEST(BezierNormalTest, AtDegenerateCornersIsTheLimitFromInside) {
  ForRandomSurfaces(2, 5, [](const BezierSurface& surface, RandomSplines& random) {
    Eigen::Matrix3Xd points = surface.control_points();
    const Eigen::Vector3d corner = surface.control_point(0, 0);
    switch (random.Integer(0, 1)) {
      case 0:  // edges in opposite directions along one line
        points.col(surface.Column(1, 0)) = corner + Eigen::Vector3d(1, 0, 0);
        points.col(surface.Column(0, 1)) = corner + Eigen::Vector3d(-0.7, 0, 0);
        break;
      default:  // the next control point along v coincides with the corner
        points.col(surface.Column(0, 1)) = corner;
        break;
    }
    const BezierSurface degenerate = WithPoints(surface, points);
    const auto normal = NormalAt(degenerate, 0, 0);
    // Whether there is a limit: the directions from which one comes must not matter.
    std::vector<Eigen::Vector3d> around;
    constexpr double h = 1e-6;
    for (const double slope : {1.0, 1e-5, 1e-3, 1e-1, 1e1, 1e3, 1e5}) {
      const SurfaceDerivatives d =
          degenerate.Derivatives(h / std::max(1.0, slope), h * std::min(1.0, slope), 1);
      around.push_back(d(1, 0).cross(d(0, 1)).normalized());
    }
    double spread = 0;
    for (const Eigen::Vector3d& other : around) {
      spread = std::max(spread, (other - around[0]).norm());
    }
    if (normal) {
      EXPECT_LE((*normal - around[0]).norm(), 0.05);
      EXPECT_LE(spread, 0.1);
    } else {
      EXPECT_GE(spread, 1e-4);  // more than h makes
    }
  });
}

TEST(BezierNormalTest, ThereIsNoneOnALineOrAPoint) {
  RandomSplines random(5);
  const BezierSurface surface = RandomSurface(random, 3, 2, true);
  Eigen::Matrix3Xd line = surface.control_points();
  for (Eigen::Index k = 0; k < line.cols(); ++k) {
    line.col(k) = line(0, k) * Eigen::Vector3d(1, 2, 3) + Eigen::Vector3d(5, 5, 5);
  }
  const Eigen::Matrix3Xd point = Eigen::Vector3d(1, 2, 3).replicate(1, line.cols());
  for (const double u : {0.0, 0.3, 1.0}) {
    EXPECT_FALSE(NormalAt(WithPoints(surface, line), u, 0));
    EXPECT_FALSE(NormalAt(WithPoints(surface, point), u, 0.5));
  }
}

}  // namespace batten::internal::bezier_surface_test
