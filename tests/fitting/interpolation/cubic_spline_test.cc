// SPDX-License-Identifier: MIT
#include "batten/fitting/cubic_spline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/interpolate_curve.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::cubic_spline_test {

NurbsCurve<3> SplineOf(const fixtures::Json& input) {
  const Eigen::Matrix3Xd points = fixtures::Columns(input.at("points"));
  const Eigen::VectorXd parameters = fixtures::Vector(input.at("parameters"));
  const std::string kind = input.at("end_condition");
  if (kind == "periodic") {  // the first point is there again at the end
    return ClosedCubicSplineCurve<3>(points.leftCols(points.cols() - 1), parameters);
  }
  CubicEndCondition<3> condition;
  if (kind == "natural") condition.kind = CubicEnd::kNatural;
  if (kind == "clamped") condition.kind = CubicEnd::kFirstDerivative;
  return CubicSplineCurve<3>(points, parameters, condition, condition);
}

TEST(CubicSplineTest, AgreesWithOtherImplementations) {
  int cases = 0;
  fixtures::CheckAll(
      "curve_interpolation.json",
      [&](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        if (!input.contains("end_condition")) return;
        ++cases;
        const NurbsCurve<3> curve = SplineOf(input);
        const Eigen::VectorXd at = fixtures::Vector(expected.at("samples_u"));
        Eigen::Matrix3Xd samples(3, at.size());
        for (Eigen::Index k = 0; k < at.size(); ++k) samples.col(k) = curve.At(at[k]);
        fixtures::ExpectClose(samples, fixtures::Columns(expected.at("samples")), tolerance);
        const CurveJet<3> start = curve.JetAt(at[0]), end = curve.JetAt(at[at.size() - 1]);
        Eigen::Matrix<double, 3, 2> first, second;
        first << start.first, end.first;
        second << start.second, end.second;
        fixtures::ExpectClose(
            first, fixtures::Columns(expected.at("first_derivative_ends")), tolerance);
        // The natural ends' zeros come out of a cancellation of terms of 1e3.
        const double scale = 1e3 * std::max(1.0, second.cwiseAbs().maxCoeff());
        EXPECT_LE((second - fixtures::Columns(expected.at("second_derivative_ends"))).norm(),
                  tolerance * scale);
      });
  EXPECT_EQ(cases, 8);
}

struct Data {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd parameters;
};

Data RandomData(RandomSplines& random, int count) {
  Data data{Eigen::Matrix3Xd(3, count), Eigen::VectorXd(count)};
  double u = random.Real(-1, 1);
  for (int k = 0; k < count; ++k) {
    data.points.col(k) = random.Vector(1);
    data.parameters[k] = u;
    u += random.Real(0.1, 1);
  }
  return data;
}

TEST(CubicSplineTest, EveryPairOfEndsIsMet) {
  for (unsigned seed = 1; seed <= 320; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Data data = RandomData(random, random.Integer(2, 12));
    const auto condition = [&](unsigned kind) {
      return CubicEndCondition<3>{static_cast<CubicEnd>(kind % 4), random.Vector(5)};
    };
    const CubicEndCondition<3> ends[2] = {condition(seed), condition(seed / 4)};
    const NurbsCurve<3> curve = CubicSplineCurve<3>(data.points, data.parameters, ends[0], ends[1]);
    const double allowed = 1e2 * kRounding * (1 + SizeOf(curve));
    for (Eigen::Index k = 0; k < data.points.cols(); ++k) {
      EXPECT_LE((curve.At(data.parameters[k]) - data.points.col(k)).norm(), allowed);
    }
    for (const int side : {0, 1}) {
      const CurveJet<3> jet =
          curve.JetAt(side == 0 ? curve.basis().lower() : curve.basis().upper());
      // Steps are not below 0.1: second derivatives are at most 1e3 times as large.
      const CubicEndCondition<3>& end = ends[side];
      if (end.kind == CubicEnd::kFirstDerivative) {
        EXPECT_LE((jet.first - end.value).norm(), 1e2 * allowed);
      } else if (end.kind == CubicEnd::kSecondDerivative) {
        EXPECT_LE((jet.second - end.value).norm(), 1e3 * allowed);
      } else if (end.kind == CubicEnd::kNatural) {
        EXPECT_LE(jet.second.norm(), 1e3 * allowed);
      }
    }
    // C² at every point by simple knots.
    for (Eigen::Index k = 1; k + 1 < data.points.cols(); ++k) {
      EXPECT_LE(curve.basis().Multiplicity(data.parameters[k]), 1);
    }
  }
}

// The greatest difference, of which a second derivative's has the size of the points by that of the
// shortest step squared.
void ExpectEqual(const SplineDerivatives<3>& a, const SplineDerivatives<3>& b, double step) {
  const double size = 1 + a.slopes.cwiseAbs().maxCoeff();
  EXPECT_LE((a.slopes - b.slopes).cwiseAbs().maxCoeff(), kRounding * size);
  EXPECT_LE((a.moments - b.moments).cwiseAbs().maxCoeff(), 1e2 * kRounding * size / step);
}

TEST(CubicSplineTest, SlopesAndMomentsAreThoseOfOneSplineWhateverItsEnds) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Data data = RandomData(random, random.Integer(2, 12));
    const auto condition = [&](unsigned kind) {
      return CubicEndCondition<3>{static_cast<CubicEnd>(kind % 4), random.Vector(5)};
    };
    const CubicEndCondition<3> start = condition(seed), end = condition(seed / 4);
    const auto slopes = SplineBySlopes<3>(data.points, data.parameters, start, end);
    ExpectEqual(slopes, SplineByMoments<3>(data.points, data.parameters, start, end), 0.1);
    // The curve has both.
    const NurbsCurve<3> curve = CubicSplineCurve<3>(data.points, data.parameters, start, end);
    SplineDerivatives<3> of_curve = slopes;
    for (Eigen::Index k = 0; k < data.parameters.size(); ++k) {
      const CurveJet<3> jet = curve.JetAt(data.parameters[k]);
      of_curve.slopes.col(k) = jet.first;
      of_curve.moments.col(k) = jet.second;
    }
    ExpectEqual(slopes, of_curve, 0.01);
  }
}

TEST(CubicSplineTest, ClosedSplinesBySlopesAndByMomentsAreTheInterpolatingPeriodicCubic) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Data data = RandomData(random, random.Integer(4, 13));
    const Eigen::Matrix3Xd points = data.points.leftCols(data.points.cols() - 1);
    ExpectEqual(ClosedSplineBySlopes<3>(points, data.parameters),
                ClosedSplineByMoments<3>(points, data.parameters),
                0.1);
    const NurbsCurve<3> spline = ClosedCubicSplineCurve<3>(points, data.parameters);
    EXPECT_TRUE(spline.basis().periodic());
    CurveInterpolationOptions options;
    options.parameterization = CurveParameterization::kGiven;
    options.parameters = data.parameters;
    options.closed = true;
    const NurbsCurve<3> collocated = InterpolateCurve<3>(points, options).curve;
    for (int k = 0; k <= 50; ++k) {
      const double u =
          data.parameters[0] + (data.parameters.tail(1)[0] - data.parameters[0]) * k / 50;
      EXPECT_LE((spline.At(u) - collocated.At(u)).norm(), 1e2 * kRounding * (1 + SizeOf(spline)));
    }
  }
}

// An independent way to the clamped spline: collocation of points and end derivatives.
TEST(CubicSplineTest, TheClampedSplineIsTheCollocatedOne) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Data data = RandomData(random, random.Integer(2, 12));
    const Eigen::Vector3d start = random.Vector(3), end = random.Vector(3);
    const NurbsCurve<3> spline = CubicSplineCurve<3>(data.points,
                                                     data.parameters,
                                                     {CubicEnd::kFirstDerivative, start},
                                                     {CubicEnd::kFirstDerivative, end});
    CurveInterpolationOptions options;
    options.parameterization = CurveParameterization::kGiven;
    options.parameters = data.parameters;
    options.basis = spline.basis();
    const std::vector<PointDerivative<3>> derivatives = {{0, 1, start},
                                                         {data.points.cols() - 1, 1, end}};
    const NurbsCurve<3> collocated = InterpolateCurve<3>(data.points, options, derivatives).curve;
    EXPECT_LE((spline.control_points() - collocated.control_points()).cwiseAbs().maxCoeff(),
              1e2 * kRounding * (1 + SizeOf(spline)));
  }
}

TEST(CubicSplineTest, StepsOfVeryDifferentLengthAndFarCoordinatesLoseNoDigits) {
  Eigen::Matrix2Xd points(2, 6);
  points << 5e6, 5e6 + 1, 5e6 + 1 + 1e-5, 5e6 + 2, 5e6 + 3, 5e6 + 4, 4e5, 4e5 + 1, 4e5 + 1, 4e5,
      4e5 + 1, 4e5;
  const Eigen::VectorXd t = points.row(0).array() - 5e6;
  const NurbsCurve<2> curve = CubicSplineCurve<2>(points, t);
  for (Eigen::Index k = 0; k < t.size(); ++k)
    EXPECT_LE((curve.At(t[k]) - points.col(k)).norm(), 8 * 0x1p-52 * 5e6);
}

TEST(CubicSplineTest, CurvaturesAreMetInThePlaneInSpaceAndByFunctions) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(3, 9);
    Eigen::Matrix2Xd plane(2, count);
    Eigen::VectorXd t(count);
    for (int k = 0; k < count; ++k) {
      plane.col(k) << k, random.Real(-0.4, 0.4);
      t[k] = k;
    }
    const double k0 = random.Real(-0.4, 0.4), k1 = random.Real(-0.4, 0.4);
    const auto curvature = [](const CurveJet<2>& jet) {
      const double cross = jet.first.x() * jet.second.y() - jet.first.y() * jet.second.x();
      return cross / std::pow(jet.first.norm(), 3);
    };
    for (const CubicEnd kind : {CubicEnd::kCurvature, CubicEnd::kFunctionCurvature}) {
      const NurbsCurve<2> curve = CubicSplineCurve<2>(plane, t, {kind, {k0, 0}}, {kind, {k1, 0}});
      EXPECT_NEAR(curvature(curve.JetAt(t[0])), k0, 10 * kIterated);
      EXPECT_NEAR(curvature(curve.JetAt(t[count - 1])), k1, 10 * kIterated);
      if (kind == CubicEnd::kFunctionCurvature) {
        for (double x = 0; x <= count - 1; x += 0.1)
          EXPECT_NEAR(curve.At(x).x(), x, kRounding * count);
      }
    }
    Eigen::Matrix3Xd space(3, count);
    space << plane, t.transpose().array().sin().matrix();
    const Eigen::Vector3d vector = 0.2 * random.Vector(1);
    const NurbsCurve<3> curve = CubicSplineCurve<3>(
        space, t, {CubicEnd::kCurvature, vector}, {CubicEnd::kCurvature, vector});
    const CurveJet<3> jet = curve.JetAt(t[0]);
    const Eigen::Vector3d tangent = jet.first.normalized();
    const Eigen::Vector3d bend =
        (jet.second - tangent * tangent.dot(jet.second)) / jet.first.squaredNorm();
    EXPECT_LE((bend - (vector - tangent * tangent.dot(vector))).norm(), 10 * kIterated);
  }
}

// y'' = κ (1 + y'²)^(3/2) against y'' = 4 (c − y'): none for κ this great.
TEST(CubicSplineTest, ACurvatureTooGreatForTheFirstStepIsRefused) {
  const Eigen::Matrix2Xd points{{0, 1, 2}, {0, 1, 0}};
  try {
    CubicSplineCurve<2>(points,
                        Eigen::Vector3d(0, 1, 2),
                        {CubicEnd::kFunctionCurvature, {1e3, 0}},
                        {CubicEnd::kFunctionCurvature, {1e3, 0}});
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("no spline with the curvatures given at its ends was found"));
  }
}

// Curvatures of splines that are there are found, however long the way from a spline without them.
TEST(CubicSplineTest, CurvaturesOfASplineAreMetAgain) {
  int found = 0, all = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(3, 7);
    Eigen::Matrix2Xd points(2, count);
    Eigen::VectorXd t(count);
    for (int k = 0; k < count; ++k) {
      points.col(k) << k + random.Real(-0.4, 0.4), random.Real(-2, 2);
      t[k] = points(0, k);
    }
    const auto function = [&](double start, double end) {
      return CubicSplineCurve<2>(points,
                                 t,
                                 {CubicEnd::kFunctionCurvature, {start, 0}},
                                 {CubicEnd::kFunctionCurvature, {end, 0}});
    };
    const NurbsCurve<2> given =
        CubicSplineCurve<2>(points,
                            t,
                            {CubicEnd::kFirstDerivative, {1, random.Real(-3, 3)}},
                            {CubicEnd::kFirstDerivative, {1, random.Real(-3, 3)}});
    const auto curvature = [](const NurbsCurve<2>& curve, double u) {
      const CurveJet<2> jet = curve.JetAt(u);
      return (jet.first.x() * jet.second.y() - jet.first.y() * jet.second.x()) /
             std::pow(jet.first.norm(), 3);
    };
    const double start = curvature(given, t[0]), end = curvature(given, t[count - 1]);
    ++all;
    try {
      const NurbsCurve<2> again = function(start, end);
      ++found;
      EXPECT_NEAR(curvature(again, t[0]), start, kIterated * (1 + std::abs(start)));
      EXPECT_NEAR(curvature(again, t[count - 1]), end, kIterated * (1 + std::abs(end)));
    } catch (const std::invalid_argument&) {
    }
  }
  EXPECT_EQ(found, all);
}

TEST(CubicSplineTest, TurnsThatStepsTowardsThemDoNotFindAreFound) {
  const Eigen::Matrix2Xd points{{0.4568, 0.8425, 1.9970, 3.4177, 4.0684},
                                {-2.1444, 0.9906, 1.4555, 1.2063, -1.8055}};
  const Eigen::VectorXd t = points.row(0);
  const NurbsCurve<2> curve = CubicSplineCurve<2>(points,
                                                  t,
                                                  {CubicEnd::kFunctionCurvature, {0.1206, 0}},
                                                  {CubicEnd::kFunctionCurvature, {0.2062, 0}});
  const CurveJet<2> start = curve.JetAt(t[0]), end = curve.JetAt(t[4]);
  EXPECT_NEAR(start.second.y() / std::pow(start.first.norm(), 3), 0.1206, kIterated);
  EXPECT_NEAR(end.second.y() / std::pow(end.first.norm(), 3), 0.2062, kIterated);
}

TEST(CubicSplineTest, APeriodicFunctionIsTheClosedSplineOverOnePeriod) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(4, 12);
    Eigen::Matrix2Xd points(2, count);
    for (int k = 0; k < count; ++k)
      points.col(k) << 5e6 + k + random.Real(-0.4, 0.4), random.Real(-2, 2);
    points(1, count - 1) = points(1, 0);
    const Eigen::VectorXd t = points.row(0);
    const NurbsCurve<2> curve = PeriodicFunctionCurve<2>(points, t);
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(curve.At(t[k]).y(), points(1, k), kRounding);
      EXPECT_NEAR(curve.At(t[k]).x(), t[k], 1e7 * kRounding);
    }
    const CurveJet<2> start = curve.JetAt(t[0]), end = curve.JetAt(t[count - 1]);
    EXPECT_NEAR(start.first.y(), end.first.y(), 1e3 * kIterated);  // steps at 5e6 keep nine digits
    EXPECT_NEAR(start.second.y(), end.second.y(), 1e3 * kIterated);
  }
  const Eigen::Matrix2Xd open{{0, 1, 2, 3}, {0, 1, 2, 0.5}};
  try {
    PeriodicFunctionCurve<2>(open, Eigen::VectorXd(open.row(0)));
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("0.5 off the first"));
  }
}

TEST(CubicSplineTest, ACubicIsRecoveredWithoutEndConditions) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(2, 9), degree = std::min(3, count - 1);
    Data data = RandomData(random, count);
    Eigen::Matrix<double, 3, 4> cubic;
    for (int j = 0; j < 4; ++j)
      cubic.col(j) = j <= degree ? random.Vector(1) : Eigen::Vector3d(0, 0, 0);
    const auto value = [&](double u) -> Eigen::Vector3d {
      return cubic * Eigen::Vector4d(1, u, u * u, u * u * u);
    };
    for (int k = 0; k < count; ++k) data.points.col(k) = value(data.parameters[k]);
    const NurbsCurve<3> curve = CubicSplineCurve<3>(data.points, data.parameters);
    for (int k = 0; k <= 20; ++k) {
      const double u =
          curve.basis().lower() + (curve.basis().upper() - curve.basis().lower()) * k / 20;
      EXPECT_LE((curve.At(u) - value(u)).norm(), 1e2 * kRounding * (1 + ExtentOf(curve)));
    }
  }
}

// The variational law: whatever is added that vanishes at the parameters makes ∫|C''|² larger.
TEST(CubicSplineTest, TheNaturalSplineBendsLeast) {
  RandomSplines random(7);
  const Data data = RandomData(random, 8);
  CubicEndCondition<3> natural{CubicEnd::kNatural};
  const NurbsCurve<3> least = CubicSplineCurve<3>(data.points, data.parameters, natural, natural);
  const auto bending = [&](const NurbsCurve<3>& curve) {
    double sum = 0;  // |C''|² is a parabola between knots: Simpson's rule is exact
    for (Eigen::Index k = 1; k < data.parameters.size(); ++k) {
      const double a = data.parameters[k - 1], b = data.parameters[k], h = b - a;
      const double inside = 1e-9 * h;  // the second derivative from this side of the knot
      sum +=
          h / 6 *
          (curve.JetAt(a).second.squaredNorm() + 4 * curve.JetAt(a + h / 2).second.squaredNorm() +
           curve.JetAt(b - inside).second.squaredNorm());
    }
    return sum;
  };
  for (int k = 0; k < 20; ++k) {
    const CubicEndCondition<3> start{CubicEnd::kFirstDerivative, random.Vector(3)},
        end{CubicEnd::kSecondDerivative, random.Vector(3)};
    EXPECT_GT(bending(CubicSplineCurve<3>(data.points, data.parameters, start, end)),
              bending(least) * (1 + kHalfDigits));
  }
}

TEST(CubicSplineTest, SaysWhatItCannotDo) {
  const auto error = [](const Eigen::Matrix2Xd& points, const Eigen::VectorXd& parameters) {
    try {
      CubicSplineCurve<2>(points, parameters);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const Eigen::Matrix2Xd points{{0, 1, 2}, {0, 1, 0}};
  EXPECT_THAT(error(points.leftCols(1), Eigen::VectorXd::Zero(1)),
              testing::HasSubstr("at least 2"));
  EXPECT_THAT(error(points, Eigen::Vector2d(0, 1)), testing::HasSubstr("do not agree"));
  EXPECT_THAT(error(points, Eigen::Vector3d(0, 1, 1)), testing::HasSubstr("not above"));
}

}  // namespace batten::internal::cubic_spline_test
