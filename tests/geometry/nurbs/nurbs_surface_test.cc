// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "batten/geometry/curvature.h"
#include "exact_shapes.h"
#include "extended_evaluation.h"
#include "law_cases.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::nurbs_surface_test {

// Whether a tangent may vanish: round a period of one row of control points nothing moves, and
// between two rows the surface goes to and fro and turns.
bool MayStandStill(const NurbsSurface& surface) {
  const auto few_rows = [](const SplineBasis& basis) {
    return basis.periodic() && basis.size() - basis.degree() <= 2;
  };
  return few_rows(surface.basis_u()) || few_rows(surface.basis_v());
}

struct UV {
  double u, v;
};

UV RandomParameters(const NurbsSurface& surface, RandomSplines& random) {
  const double u = random.Parameter(surface.basis_u());
  return {u, random.Parameter(surface.basis_v())};
}

TEST(NurbsSurfaceTest, MovesWithItsControlPointsUnderAffineMaps) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    Eigen::Matrix3d map;
    for (double& x : map.reshaped()) x = random.Real(-2, 2);
    const Eigen::Vector3d shift = random.Vector(5);
    const NurbsSurface image(surface.basis_u(),
                             surface.basis_v(),
                             (map * surface.control_points()).colwise() + shift,
                             surface.weights());
    const auto [u, v] = RandomParameters(surface, random);
    EXPECT_NEAR(
        (image.At(u, v) - (map * surface.At(u, v) + shift)).norm(), 0, kRounding * ExtentOf(image));
  });
}

TEST(NurbsSurfaceTest, HasTheCornersOfItsNetWhenClamped) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines&) {
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    if (u.knots().front() != u.lower() || u.knots().back() != u.upper()) return;
    if (v.knots().front() != v.lower() || v.knots().back() != v.upper()) return;
    const int i = u.size() - 1, j = v.size() - 1;
    const auto corner = [&](int a, int b) { return surface.control_point(a, b); };
    EXPECT_EQ(surface.At(u.lower(), v.lower()), corner(0, 0));
    EXPECT_EQ(surface.At(u.upper(), v.lower()), corner(i, 0));
    EXPECT_EQ(surface.At(u.lower(), v.upper()), corner(0, j));
    EXPECT_EQ(surface.At(u.upper(), v.upper()), corner(i, j));
  });
}

TEST(NurbsSurfaceTest, JetEqualsDerivativesAndAt) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const auto [u, v] = RandomParameters(surface, random);
    const SurfaceJet jet = surface.JetAt(u, v);
    const SurfaceDerivatives all = surface.Derivatives(u, v, 3);
    EXPECT_EQ(all.order(), 3);
    EXPECT_NEAR((jet.point - surface.At(u, v)).norm(), 0, kRounding);
    EXPECT_NEAR((jet.point - all(0, 0)).norm(), 0, kRounding);
    // Second derivatives of a rational surface are differences of much larger terms.
    const double size_u = all(1, 0).norm(), size_v = all(0, 1).norm();
    const double size = 1 + size_u * size_u + size_v * size_v + all(2, 0).norm() +
                        all(1, 1).norm() + all(0, 2).norm();
    EXPECT_NEAR((jet.du - all(1, 0)).norm(), 0, kRounding * size);
    EXPECT_NEAR((jet.dv - all(0, 1)).norm(), 0, kRounding * size);
    EXPECT_NEAR((jet.duu - all(2, 0)).norm(), 0, kRounding * size);
    EXPECT_NEAR((jet.duv - all(1, 1)).norm(), 0, kRounding * size);
    EXPECT_NEAR((jet.dvv - all(0, 2)).norm(), 0, kRounding * size);
  });
}

// The control points of the cell at (u,v), and the one that sums are taken about.
struct Cell {
  Cell(const NurbsSurface& surface, double u, double v)
      : p(surface.basis_u().degree()), q(surface.basis_v().degree()), points(3, (p + 1) * (q + 1)) {
    const int su = surface.basis_u().Span(u), sv = surface.basis_v().Span(v);
    for (int r = 0; r <= p; ++r) {
      for (int s = 0; s <= q; ++s) {
        points.col(r * (q + 1) + s) = surface.control_point(su - p + r, sv - q + s);
      }
    }
    const auto upper_half = [](const SplineBasis& basis, int span, double t) {
      return t - basis.knots()[span] > basis.knots()[span + 1] - t;
    };
    origin = points.col((upper_half(surface.basis_u(), su, u) ? p * (q + 1) : 0) +
                        (upper_half(surface.basis_v(), sv, v) ? q : 0));
    length_u = surface.basis_u().knots()[su + 1] - surface.basis_u().knots()[su];
    length_v = surface.basis_v().knots()[sv + 1] - surface.basis_v().knots()[sv];
  }
  Eigen::Vector3d Range() const {
    return points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  }

  int p, q;
  Eigen::Matrix3Xd points;
  Eigen::Vector3d origin;
  double length_u, length_v;
};

NurbsSurface Moved(const NurbsSurface& surface, double distance) {
  return surface.Translated(Eigen::Vector3d::Constant(distance));
}

// Header: (7p + 7q + 4)·ε·D + ε·|S|. Far from the origin D does not grow.
TEST(NurbsSurfaceTest, PointsAreRightToTheirBound) {
  ForRandomSurfaces([](const NurbsSurface& near, RandomSplines& random) {
    for (const double distance : {0.0, 1e3, 1e9}) {
      const NurbsSurface surface = Moved(near, distance);
      const auto [u, v] = RandomParameters(surface, random);
      const Cell cell(surface, u, v);
      const Sized exact = ExtendedSurface(surface, u, v, 0, cell.origin);
      const Eigen::Vector3d point = surface.At(u, v), range = cell.Range();
      for (int x = 0; x < 3; ++x) {
        const long double error = point[x] - (cell.origin[x] + exact.value(x, 0));
        EXPECT_LE(std::abs(static_cast<double>(error)),
                  kEpsilon * ((7 * cell.p + 7 * cell.q + 4) * range[x] + std::abs(point[x])));
      }
    }
  });
}

// Header: (4p + 4q + 2)·ε·D·p!/(p−k)!·(2/g)^k·q!/(q−l)!·(2/h)^l, and with weights
// (k+l+1)(7p + 7q + k + l + 6)·ε·B_kl. The same for the jet.
TEST(NurbsSurfaceTest, DerivativesAreRightToTheirBound) {
  ForRandomSurfaces([](const NurbsSurface& near, RandomSplines& random) {
    for (const double distance : {0.0, 1e9}) {
      constexpr int kOrder = 5;
      const NurbsSurface surface = Moved(near, distance);
      const auto [u, v] = RandomParameters(surface, random);
      const Cell cell(surface, u, v);
      const int p = cell.p, q = cell.q;
      const SurfaceDerivatives derivatives = surface.Derivatives(u, v, kOrder);
      const SurfaceJet jet = surface.JetAt(u, v);
      const Sized exact = ExtendedSurface(surface, u, v, kOrder, cell.origin);
      const auto check = [&](int k, int l, const Eigen::Vector3d& got) {
        const Eigen::Index column = k * (kOrder + 1) + l;
        const LongMatrix error = got.cast<long double>() - exact.value.col(column);
        LongMatrix bound =
            (k + l + 1) * (7 * p + 7 * q + k + l + 6) * kEpsilon * exact.size.col(column);
        if (!surface.rational()) {
          double most = (4 * p + 4 * q + 2) * kEpsilon;
          for (int i = 0; i < k; ++i) most *= std::max(0, p - i) * 2 / cell.length_u;
          for (int j = 0; j < l; ++j) most *= std::max(0, q - j) * 2 / cell.length_v;
          bound = (most * cell.Range()).cast<long double>();
        }
        EXPECT_LE(static_cast<double>((error.cwiseAbs() - bound).maxCoeff()), 0)
            << k << ", " << l << " at distance " << distance;
      };
      for (int k = 0; k <= kOrder; ++k) {
        for (int l = k == 0 ? 1 : 0; k + l <= kOrder; ++l) check(k, l, derivatives(k, l));
      }
      check(1, 0, jet.du);
      check(0, 1, jet.dv);
      check(2, 0, jet.duu);
      check(1, 1, jet.duv);
      check(0, 2, jet.dvv);
    }
  });
}

TEST(NurbsSurfaceTest, DerivativesAreTheLimitsOfDifferences) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const std::vector<int> spans_u = surface.basis_u().Spans(), spans_v = surface.basis_v().Spans();
    const int i = spans_u[random.Integer(0, static_cast<int>(spans_u.size()) - 1)];
    const int j = spans_v[random.Integer(0, static_cast<int>(spans_v.size()) - 1)];
    const double a = surface.basis_u().knots()[i], b = surface.basis_u().knots()[i + 1];
    const double c = surface.basis_v().knots()[j], d = surface.basis_v().knots()[j + 1];
    const double u = a + random.Real(0.2, 0.8) * (b - a), v = c + random.Real(0.2, 0.8) * (d - c);
    const double hu = 2e-3 * (b - a), hv = 2e-3 * (d - c);
    const SurfaceDerivatives exact = surface.Derivatives(u, v, 4);
    const auto scaled = [&](int k, int l, const Eigen::Vector3d& derivative) {
      return Eigen::Vector3d(derivative * std::pow(b - a, k) * std::pow(d - c, l));
    };
    double size = 0;
    for (int k = 0; k <= 4; ++k) {
      for (int l = 0; k + l <= 4; ++l) size = std::max(size, scaled(k, l, exact(k, l)).norm());
    }
    // Richardson's extrapolation of central differences of the derivative one order lower.
    const auto difference = [&](int k, int l, double du, double dv) {
      const auto central = [&](double t) {
        return Eigen::Vector3d((surface.Derivatives(u + t * du, v + t * dv, k + l)(k, l) -
                                surface.Derivatives(u - t * du, v - t * dv, k + l)(k, l)) /
                               (2 * t * (du + dv)));
      };
      return Eigen::Vector3d((4 * central(0.5) - central(1)) / 3);
    };
    for (int k = 0; k <= 3; ++k) {
      for (int l = 0; k + l <= 3; ++l) {
        EXPECT_NEAR(scaled(k + 1, l, exact(k + 1, l) - difference(k, l, hu, 0)).norm(),
                    0,
                    kHalfDigits * size)
            << k + 1 << ", " << l;
        EXPECT_NEAR(scaled(k, l + 1, exact(k, l + 1) - difference(k, l, 0, hv)).norm(),
                    0,
                    kHalfDigits * size)
            << k << ", " << l + 1;
      }
    }
  });
}

TEST(NurbsSurfaceTest, EqualWeightsAreNoWeights) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const Eigen::Matrix3Xd& points = surface.control_points();
    const NurbsSurface plain(surface.basis_u(), surface.basis_v(), points);
    const NurbsSurface equal(surface.basis_u(),
                             surface.basis_v(),
                             points,
                             Eigen::VectorXd::Constant(points.cols(), 0.37));
    EXPECT_FALSE(plain.rational());
    EXPECT_FALSE(equal.rational());
    const auto [u, v] = RandomParameters(surface, random);
    const SurfaceJet a = plain.JetAt(u, v), b = equal.JetAt(u, v);
    EXPECT_NEAR((a.point - b.point).norm(), 0, kRounding);
    EXPECT_NEAR((a.duu - b.duu).norm(), 0, kRounding * (1 + a.duu.norm() + a.du.norm()));
    EXPECT_NEAR((a.dvv - b.dvv).norm(), 0, kRounding * (1 + a.dvv.norm() + a.dv.norm()));
  });
}

TEST(NurbsSurfaceTest, WeightsTimesAConstantChangeNothing) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const double factor : {1e-9, 3.0, 1e9}) {
      const NurbsSurface scaled(surface.basis_u(),
                                surface.basis_v(),
                                surface.control_points(),
                                factor * surface.weights());
      const auto [u, v] = RandomParameters(surface, random);
      EXPECT_NEAR((scaled.At(u, v) - surface.At(u, v)).norm(), 0, kRounding);
    }
  });
}

TEST(NurbsSurfaceTest, ScalesWithItsControlPoints) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    if (MayStandStill(surface)) return;
    for (const double scale : {1e-9, 1e9}) {
      const NurbsSurface scaled(surface.basis_u(),
                                surface.basis_v(),
                                scale * surface.control_points(),
                                surface.weights());
      const auto [u, v] = RandomParameters(surface, random);
      EXPECT_NEAR((scaled.At(u, v) / scale - surface.At(u, v)).norm(), 0, kRounding);
      const auto expected = surface.NormalAt(u, v), actual = scaled.NormalAt(u, v);
      ASSERT_EQ(expected.has_value(), actual.has_value());
      if (expected) {
        EXPECT_NEAR((*expected - *actual).norm(), 0, kIterated);
      }
    }
  });
}

TEST(NurbsSurfaceTest, TakesParametersOutsideTheDomainAtItsNearestEdge) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    if (surface.basis_u().periodic() || surface.basis_v().periodic()) return;  // periodic_test.cc
    const auto [u, v] = RandomParameters(surface, random);
    const double low_u = surface.basis_u().lower(), high_v = surface.basis_v().upper();
    EXPECT_EQ(surface.At(low_u - 1, v), surface.At(low_u, v));
    EXPECT_EQ(surface.At(u, high_v + 1), surface.At(u, high_v));
    EXPECT_EQ(surface.JetAt(low_u - 1, high_v + 1).duv, surface.JetAt(low_u, high_v).duv);
    EXPECT_EQ(surface.Derivatives(u, high_v + 1, 2)(0, 2), surface.Derivatives(u, high_v, 2)(0, 2));
  });
}

TEST(NurbsSurfaceTest, SwappingTheDirectionsSwapsTheParameters) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    if (MayStandStill(surface)) return;
    Eigen::Matrix3Xd points(3, surface.control_points().cols());
    Eigen::VectorXd weights(points.cols());
    for (int i = 0; i < surface.size_u(); ++i) {
      for (int j = 0; j < surface.size_v(); ++j) {
        points.col(j * surface.size_u() + i) = surface.control_point(i, j);
        weights[j * surface.size_u() + i] = surface.weights()[i * surface.size_v() + j];
      }
    }
    const NurbsSurface swapped(surface.basis_v(), surface.basis_u(), points, weights);
    const auto [u, v] = RandomParameters(surface, random);
    EXPECT_NEAR((swapped.At(v, u) - surface.At(u, v)).norm(), 0, kRounding);
    const auto a = surface.NormalAt(u, v), b = swapped.NormalAt(v, u);
    if (a && b) {
      EXPECT_NEAR((*a + *b).norm(), 0, kIterated);
    }
  });
}

TEST(NurbsSurfaceTest, NormalsAreUnitAndPerpendicularToBothTangents) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    if (MayStandStill(surface)) return;
    const auto [u, v] = RandomParameters(surface, random);
    const SurfaceJet jet = surface.JetAt(u, v);
    const auto normal = surface.NormalAt(u, v);
    ASSERT_TRUE(normal);
    EXPECT_NEAR(normal->norm(), 1, kRounding);
    // The cross product of tangents at a small angle loses the digits of that angle.
    const double sine = jet.du.cross(jet.dv).norm() / (jet.du.norm() * jet.dv.norm());
    EXPECT_NEAR(normal->dot(jet.du.normalized()), 0, kRounding / sine);
    EXPECT_NEAR(normal->dot(jet.dv.normalized()), 0, kRounding / sine);
    EXPECT_GT(normal->dot(jet.du.cross(jet.dv)), 0);
  });
}

// With S_u = 0 along the edge, S_u × S_v = (v − lower)·S_uv × S_v to first order.
TEST(NurbsSurfaceTest, HasAtACollapsedEdgeTheNormalOfTheFirstTermThatDoesNotVanish) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree_u = random.Integer(1, 5), degree_v = random.Integer(1, 5);
    const NurbsSurface whole = random.Surface(degree_u, degree_v, random.Coin());
    Eigen::Matrix3Xd points = whole.control_points();
    for (int i = 0; i < whole.size_u(); ++i) points.col(i * whole.size_v()) = points.col(0);
    const NurbsSurface collapsed(whole.basis_u(), whole.basis_v(), points, whole.weights());
    for (int trial = 0; trial < 5; ++trial) {
      const double u = random.Parameter(collapsed.basis_u()), v = collapsed.basis_v().lower();
      const SurfaceJet jet = collapsed.JetAt(u, v);
      const auto normal = collapsed.NormalAt(u, v);
      ASSERT_TRUE(normal) << "u = " << u;
      const Eigen::Vector3d first = jet.duv.cross(jet.dv);
      // Tangents at a small angle lose the digits of that angle.
      const double sine = first.norm() / (jet.duv.norm() * jet.dv.norm());
      EXPECT_NEAR((*normal - first.normalized()).norm(), 0, kIterated / sine) << "u = " << u;
    }
  }
}

TEST(NurbsSurfaceTest, HasNoNormalWhereTheTangentsAreParallel) {
  const NurbsSurface folded(SplineBasis(1, {0, 0, 1, 1}),
                            SplineBasis(1, {0, 0, 1, 1}),
                            Eigen::Matrix<double, 3, 4>{{0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}});
  EXPECT_FALSE(folded.NormalAt(0.3, 0.4));
}

TEST(NurbsSurfaceTest, TranslatedMovesEveryPoint) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const Eigen::Vector3d shift = random.Vector(3);
    const NurbsSurface moved = surface.Translated(shift);
    const auto [u, v] = RandomParameters(surface, random);
    EXPECT_NEAR((moved.At(u, v) - surface.At(u, v) - shift).norm(), 0, kRounding * ExtentOf(moved));
    EXPECT_EQ(moved.weights(), surface.weights());
  });
}

TEST(NurbsSurfaceTest, OfDegreeOneWithFourPointsIsBilinear) {
  RandomSplines random(4);
  Eigen::Matrix<double, 3, 4> corners;
  for (double& x : corners.reshaped()) x = random.Real(-1, 1);
  const NurbsSurface patch(SplineBasis(1, {0, 0, 1, 1}), SplineBasis(1, {0, 0, 1, 1}), corners);
  for (const double u : {0.0, 0.3, 1.0}) {
    for (const double v : {0.0, 0.6, 1.0}) {
      const Eigen::Vector3d expected = (1 - u) * ((1 - v) * corners.col(0) + v * corners.col(1)) +
                                       u * ((1 - v) * corners.col(2) + v * corners.col(3));
      EXPECT_NEAR((patch.At(u, v) - expected).norm(), 0, kRounding);
    }
  }
}

TEST(NurbsSurfaceTest, RefusesWhatDoesNotFitTogetherAndSaysWhat) {
  const SplineBasis u(1, {0, 0, 1, 1}), v(2, {0, 0, 0, 1, 1, 1});
  const auto refusal = [&](const Eigen::Matrix3Xd& points,
                           const Eigen::VectorXd& weights) -> std::string {
    try {
      const NurbsSurface surface(u, v, points, weights);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const Eigen::Matrix3Xd good = Eigen::Matrix3Xd::Ones(3, 6);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(6);
  EXPECT_EQ(refusal(good, ones), "accepted");
  EXPECT_EQ(refusal(good, {}), "accepted");
  EXPECT_THAT(refusal(Eigen::Matrix3Xd::Ones(3, 5), ones),
              testing::HasSubstr("5 control points do not fill a net of 2 x 3"));
  EXPECT_THAT(refusal(good, Eigen::VectorXd::Ones(7)), testing::HasSubstr("7 weights"));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    Eigen::Matrix3Xd points = good;
    points(1, 4) = bad;
    EXPECT_THAT(refusal(points, ones), testing::HasSubstr("control point is not finite"));
  }
  for (const double bad : {0.0,
                           -1.0,
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    Eigen::VectorXd weights = ones;
    weights[3] = bad;
    EXPECT_THAT(refusal(good, weights), testing::HasSubstr("not positive and finite")) << bad;
  }
}

TEST(NurbsSurfaceTest, RefusesProductsThatADoubleCannotHold) {
  const SplineBasis basis(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 4);
  points(2, 1) = -1.7e308;
  points(2, 2) = 1.7e308;
  EXPECT_THROW(NurbsSurface(basis, basis, points), std::invalid_argument);
  points /= 1e10;
  EXPECT_NO_THROW(NurbsSurface(basis, basis, points, Eigen::Vector4d(1, 1, 1, 1e9)));
  EXPECT_THROW(NurbsSurface(basis, basis, points, Eigen::Vector4d(1, 1, 1, 1e11)),
               std::invalid_argument);
}

TEST(NurbsSurfaceTest, RefusesAParameterThatIsNotANumber) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines&) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double u = surface.basis_u().lower(), v = surface.basis_v().lower();
    EXPECT_THROW(surface.At(nan, v), std::invalid_argument);
    EXPECT_THROW(surface.JetAt(u, nan), std::invalid_argument);
    EXPECT_THROW(surface.Derivatives(nan, nan, 2), std::invalid_argument);
  });
}

TEST(NurbsSurfaceTest, RefusesANegativeOrder) {
  EXPECT_THROW(Sphere(1).Derivatives(0, 0, -1), std::invalid_argument);
}

TEST(ExactConicTest, SphereAndCylinderHaveTheirRadiusToRounding) {
  RandomSplines random(8);
  const NurbsSurface sphere = Sphere(2), cylinder = Cylinder(2, 5), torus = Torus(3, 1);
  for (int trial = 0; trial < 300; ++trial) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    EXPECT_NEAR(sphere.At(u, v).norm(), 2, kRounding);
    EXPECT_NEAR(cylinder.At(u, v).head<2>().norm(), 2, kRounding);
    EXPECT_NEAR(cylinder.At(u, v).z(), 5 * v, kRounding);
    const Eigen::Vector3d p = torus.At(u, v);
    EXPECT_NEAR(std::hypot(p.head<2>().norm() - 3, p.z()), 1, kRounding);
    const auto normal = sphere.NormalAt(u, v);
    ASSERT_TRUE(normal);
    EXPECT_NEAR((*normal - sphere.At(u, v) / 2).norm(), 0, kIterated);
  }
}

}  // namespace batten::internal::nurbs_surface_test
